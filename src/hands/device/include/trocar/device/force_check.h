// SPDX-License-Identifier: Apache-2.0
/// \file force_check.h  The last look at a force, in the process that hands it to a maker's library or service: whatever
/// happened on the way, what goes out is finite, within the clamp, and rises slowly.
#pragma once

#include "trocar/math/vector.h"

namespace trocar::device {

/// Largest rise of a force in one tick of a millisecond; a fall is free [N].
inline constexpr double kMaxForceRise = 0.5;
/// Rounding that is no violation, as a share of a force and in newtons.
inline constexpr double kForceRounding = 1e-9;

/// Distance of a force from the way between zero and the force before it [N]; NaN for what is not finite.
/// \note Real-time safe.
double CalcRise(const math::Vec3& force, const math::Vec3& before) noexcept;

/// The point nearest to `wanted` that lies within `rise` of the way between zero and `before`.
/// \note Real-time safe.
math::Vec3 LimitRise(const math::Vec3& wanted, const math::Vec3& before, double rise) noexcept;

/// Of one device. A force that is not finite or above the clamp is zero, and so is every one after it. A rise is limited:
/// where the newest force wins, two ticks' worth may come at once.
class ForceCheck {
 public:
  ForceCheck() noexcept = default;
  /// \param max_force  the device's nominal maximum [N]; with one that is implausible nothing passes
  explicit ForceCheck(double max_force) noexcept;

  /// The force that may go out in place of `force`, about once a millisecond [N].
  /// \note Real-time safe: no allocation, lock or throw.
  math::Vec3 Pass(const math::Vec3& force) noexcept;
  /// Something else came than a gate lets out; only a new check passes forces again.
  bool HasRefused() const noexcept { return has_refused_; }

 private:
  double max_force_ = 0;  // [N]
  math::Vec3 last_;       // [N]
  bool has_refused_ = false;
};

}  // namespace trocar::device
