// SPDX-License-Identifier: Apache-2.0
/// \file pressure_stiffness.h  Follower stiffness that closed surfaces under pressure add to the stiffness.
///
/// A pressure pushes along normals, and normals turn with the nodes: node a feels P dV/dx_a, so the stiffness has
/// -P d^2V / dx_a dx_b. For an edge between a and b it takes x_b - x_a to (P / 6) (c - d) x (x_b - x_a), with c and d the
/// corners across the edge, c that of the triangle that goes from a to b. Without it Newton's method converges by a
/// constant factor a step instead of quadratically: 0.55 in the built-in patient. Source: Hibbitt, "Some follower forces
/// and load stiffness", Int. J. Numer. Methods Eng. 14, 1979; the derivative of the divergence theorem's volume.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "linearisation.h"
#include "trocar/tissue/equilibrium.h"
#include "workers.h"

namespace trocar::tissue {

/// A closed surface under pressure.
struct PressedSurface {
  std::uint32_t first_node = 0;                   ///< from which its nodes are counted, in the caller's order
  std::span<const geometry::Triangle> triangles;  ///< facing outwards
};

/// The follower stiffness of a LinkMatrix over a model's links.
class PressureStiffness {
 public:
  /// \param model  must outlive this
  explicit PressureStiffness(const OrderedModel& model) { SetModel(model); }
  /// Takes another model, without surfaces.
  void SetModel(const OrderedModel& model) noexcept;
  /// Capacity for models of so many nodes and entries.
  void Reserve(std::size_t nodes, std::size_t entries);

  /// Takes the surfaces, at most kMaxConstraints.
  /// \note Allocates nothing where Reserve() was enough.
  void SetSurfaces(std::span<const PressedSurface> surfaces);
  /// Computes the follower stiffness.
  /// \param pressure  (surfaces) [Pa]
  /// \param position  (padded nodes) [m], in the solvers' order
  /// \note Real-time safe.
  void Update(const Kernels& kernels, Workers& workers, std::span<const double> pressure,
              std::span<const Double4> position) noexcept;
  /// (steps, 3, kSliceNodes) as of the last Update(), or null where there is no pressure.
  const float* FollowerStiffness() const noexcept {
    return has_pressure_ ? follower_stiffness_.data() : nullptr;
  }

 private:
  static constexpr std::uint8_t kNoSurface = 255;

  void FindCorners() noexcept;
  /// Place of the link from a to b, or kNoEntry.
  std::size_t FindEntry(std::uint32_t a, std::uint32_t b) const noexcept;

  const OrderedModel* model_ = nullptr;
  struct KnownSurface {
    std::uint32_t first_node;
    std::size_t triangle_count;
  };
  std::vector<KnownSurface> surfaces_;
  std::vector<geometry::Triangle> triangles_;      // of all surfaces, one after the other
  std::vector<std::uint8_t> surface_of_;           // (padded nodes) which, or kNoSurface
  std::vector<std::uint32_t> left_, right_;        // (entries) as in FollowerPass
  math::AlignedVector<double> factor_;             // (padded nodes) P / 6 [Pa]
  math::AlignedVector<float> follower_stiffness_;  // (steps, 3, kSliceNodes) [N/m]
  bool has_pressure_ = false;
};

}  // namespace trocar::tissue
