// SPDX-License-Identifier: Apache-2.0
/// \file trust_region.h  How far a Newton step may go, and when it has gone well.
#pragma once

#include <cmath>

namespace trocar::tissue {

/// The range of Newton's steps.
class TrustRegion {
 public:
  /// Halvings of a step that does not lower the energy.
  static constexpr int kMaxHalvings = 6;

  /// \param edge_length  mean length of a spring [m]; without any there is no limit
  explicit TrustRegion(double edge_length) noexcept
      : radius_(edge_length > 0.0 ? kFirstRadius * edge_length : INFINITY) {}

  /// Longest move of a node in the next step [m].
  double Radius() const noexcept { return radius_; }

  /// True where a step has lowered the energy as it should (Armijo).
  ///
  /// \param slope  of the energy along the whole step [J], < 0
  /// \param share  of the step that was taken [-]
  static bool IsLower(double before, double after, double slope, double share) noexcept {
    return after <= before + kLeastDecrease * share * slope + kEnergyRounding * std::fabs(before);
  }

  /// Follows a step: it grows where the step used all of it and went well, and shrinks to about what was left of one
  /// that did not.
  ///
  /// \param share           of the step that was taken [-]
  /// \param length          of the whole step [m]
  /// \param reached_radius  whether the range ended the step
  void Update(double share, double length, bool reached_radius) noexcept {
    if (share < 1.0) {
      radius_ = kGrowth * share * length;
    } else if (reached_radius) {
      radius_ *= kGrowth;
    }
  }

 private:
  /// Longest move of a node in the first step, in mean spring lengths [-]: the stiffness is that of springs that have
  /// not turned far. Conjugate gradients stop where they leave this range (Steihaug, "The conjugate gradient method
  /// and trust regions in large scale optimization", SIAM J. Numer. Anal. 20, 1983): by then the stiff part of the
  /// step is solved, and the soft one goes on in the next step.
  static constexpr double kFirstRadius = 0.1;
  static constexpr double kGrowth = 2.0;  // [-]
  /// Part of the predicted loss of energy that a step must bring [-].
  static constexpr double kLeastDecrease = 1e-4;
  /// Rounding of the energy, as a part of it [-].
  static constexpr double kEnergyRounding = 1e-12;

  double radius_;  // [m]
};

}  // namespace trocar::tissue
