// SPDX-License-Identifier: Apache-2.0
/// \file rod_stiffness.h  The stiffness of a rod: a band, and a few pulls between places far apart on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "band_matrix.h"
#include "trocar/math/vector.h"

namespace trocar::rod {

/// Places of an unknown: a node's position is followed by the angle of the segment behind it.
inline std::size_t PositionAt(std::size_t node) {
  return kNodeUnknowns * node;
}
inline std::size_t AngleAt(std::size_t segment) {
  return kNodeUnknowns * segment + 3;
}

/// A place on a segment.
struct RodPoint {
  std::size_t segment = 0;
  double at = 0;  // 0 to 1
};

/// Symmetric systems B + sum k u u^T: B is banded, each u pulls two points of the rod apart along a direction.
class RodStiffness {
 public:
  explicit RodStiffness(std::size_t nodes);

  void Clear() noexcept;
  /// \pre column <= row < column + kBandWidth
  double& At(std::size_t row, std::size_t column) noexcept { return band_[BandAt(row, column)]; }
  /// Adds stiffness [N/m] against pulling `a` from `b` along a unit vector. Beyond kMaxPulls nothing is added: steps are longer
  /// then than they should be, and are halved.
  void AddPull(const RodPoint& a, const RodPoint& b, const math::Vec3& along, double stiffness) noexcept;

  /// Factors, with as much added to the band's diagonal as makes it positive definite. Unknowns that are fixed are left out.
  ///
  /// \param unit_length  an angle's share of what is added is that of a move by this [m]
  /// \return whether nothing had to be added
  bool Factor(std::span<const std::uint8_t> is_fixed, double unit_length) noexcept;
  /// \param[in,out] x  the right side, 0 where an unknown is fixed; then the solution
  void Solve(std::span<double> x) noexcept;

  static constexpr std::size_t kMaxPulls = 192;

 private:
  struct Pull {
    RodPoint a, b;
    math::Vec3 along;
    double stiffness = 0;
  };
  void HoldFixed(std::span<const std::uint8_t> is_fixed) noexcept;
  void FactorPulls(std::span<const std::uint8_t> is_fixed) noexcept;
  /// u . x
  static double Project(const Pull& pull, std::span<const double> x) noexcept;
  std::span<double> Response(std::size_t pull) noexcept {
    return std::span(responses_).subspan(pull * unknowns_, unknowns_);
  }

  std::size_t unknowns_;
  std::vector<double> band_, factor_;
  std::vector<Pull> pulls_;
  std::vector<double> responses_;  // (pulls, unknowns) B^-1 u
  std::vector<double> small_;      // (kMaxPulls, kMaxPulls) Cholesky factor of 1 / k + u^T B^-1 u
  std::vector<double> shares_;     // (kMaxPulls)
};

}  // namespace trocar::rod
