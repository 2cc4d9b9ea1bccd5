// SPDX-License-Identifier: Apache-2.0
/// \file linear_response.h  Displacement by a small force: K u = f with the stiffness of the present state.
#pragma once

#include <span>
#include <vector>

#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// How a linear solve ended.
struct LinearReport {
  int iterations = 0;
  double residual = 0;  ///< |f - K u| / |f| [-]
};

/// Stiffness of a state, applied without being assembled, and a conjugate gradient solver for it. Springs
/// that are shorter than at rest count along their direction only, so that the matrix stays positive
/// definite.
class LinearResponse {
 public:
  /// \param model  must outlive this
  explicit LinearResponse(const TissueModel& model) { SetModel(model); }
  /// Goes on with another model. Allocates where it has more nodes or links than any before.
  void SetModel(const TissueModel& model);

  /// Takes the stiffness K of the tissue as it lies; contacts are not counted.
  /// \note Real-time safe.
  void SetStiffness(const TissueState& state, const TissueLoad& load) noexcept;
  /// Updates the stiffness where only strands have parted since: a small part of the work.
  /// \pre SetStiffness() with these positions, conditions, spring factors and scales
  /// \note Real-time safe.
  void FollowStrands(const TissueState& state, const TissueLoad& load) noexcept;

  /// Solves K u = f over the nodes that are not prescribed; u is zero on the others. Conjugate gradients,
  /// preconditioned by each node's own 3 x 3 stiffness.
  ///
  /// \pre SetStiffness() since the model was set
  /// \param force      (n) [N]
  /// \param tolerance  on |f - K u| / |f| [-]
  /// \param[in,out] response  (n) in: a first guess; out: u [m]
  /// \note Real-time safe: no allocation; serial, so that results do not depend on threads.
  LinearReport Solve(std::span<const math::Vec3> force, int max_iterations, double tolerance,
                     std::span<math::Vec3> response) noexcept;

 private:
  void Apply(std::span<const math::Vec3> u, std::span<math::Vec3> product) const noexcept;
  void SetOwnBlock(std::uint32_t node, const TissueState& state, const TissueLoad& load) noexcept;

  struct Link {
    math::Vec3 along;      // sqrt(k (1 - across)) times the direction
    double isotropic = 0;  // k times the share that acts across
  };
  const TissueModel* model_ = nullptr;
  std::vector<Link> springs_;    // (half-springs)
  std::vector<double> strands_;  // (half-strands)
  std::vector<double> own_;      // (n) isotropic stiffness of the node's own virtual spring
  std::vector<std::uint8_t> is_free_;
  // (n) what springs alone hold a node with, and the inverse of all that holds it: xx, xy, xz, yy, yz, zz
  std::vector<std::array<double, 6>> spring_block_, inverse_;
  std::vector<math::Vec3> residual_, preconditioned_, direction_, product_;
};

}  // namespace trocar::tissue
