// SPDX-License-Identifier: Apache-2.0
/// \file spring_slices.h  Any model in single-precision displacements, its nodes in slices.
#pragma once

#include <vector>

#include "linearisation.h"

namespace trocar::tissue {

/// The iteration on an irregular mesh. Displacements are stored, as in SpringGrid.
class SpringSlices {
 public:
  /// Takes a model over, without displacements.
  /// \note Allocates nothing where Reserve() was enough.
  void SetModel(const OrderedModel& model);
  void Reserve(double share);

  /// \param load  in the solvers' order, without contacts
  void SetLoad(const OrderedModel& model, const OrderedLoad& load,
               std::span<const std::uint8_t> strand_is_intact) noexcept;
  void SetDisplacement(std::uint32_t node, const Vec3& u) noexcept;
  Vec3 GetDisplacement(std::uint32_t node) const noexcept {
    return {static_cast<double>(u_[node].x), static_cast<double>(u_[node].y),
            static_cast<double>(u_[node].z)};
  }
  /// Adds to the load on a node, until the next SetLoad [N].
  void AddForce(std::uint32_t node, const Vec3& force) noexcept;
  /// One iteration.
  /// \return largest residual before it [N], NaN where one is; 0 unless measured
  double Step(const Kernels& kernels, Workers& workers, float omega, float damping, bool is_first,
              bool is_measured) noexcept;
  double LowestEigenvalue() const { return lowest_; }
  double SmallestShape() const { return smallest_shape_; }
  double LargestDisplacement() const noexcept;

 private:
  SliceLayout layout_;
  AlignedVector<float> springs_, nodes_;
  AlignedVector<Float4> u_, previous_;
  double lowest_ = 0, smallest_shape_ = 0;
};

}  // namespace trocar::tissue
