// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/force_check.h"

#include <algorithm>
#include <cmath>

#include "trocar/device/force_driver.h"

namespace trocar::device {

using math::Vec3;

double CalcRise(const Vec3& force, const Vec3& before) noexcept {
  const double along = math::Dot(force, before);
  if (along <= 0.0) return math::Norm(force);
  if (along >= math::SquaredNorm(before)) return math::Distance(force, before);
  return math::Norm(math::Cross(force, before)) / math::Norm(before);
}

Vec3 LimitRise(const Vec3& wanted, const Vec3& before, double rise) noexcept {
  const double length = math::SquaredNorm(before);
  const double along = length > 0.0 ? std::clamp(math::Dot(wanted, before) / length, 0.0, 1.0) : 0.0;
  const Vec3 foot = along * before;
  const Vec3 added = wanted - foot;
  const double size = math::Norm(added);
  return size <= rise ? wanted : foot + (rise / size) * added;
}

ForceCheck::ForceCheck(double max_force) noexcept
    : max_force_(max_force >= kSmallestForceLimit && max_force <= kLargestForceLimit ? max_force : 0.0) {}

Vec3 ForceCheck::Pass(const Vec3& force) noexcept {
  // false for what is no number
  if (!(math::Norm(force) <= max_force_ * (1.0 + kForceRounding))) has_refused_ = true;
  last_ = has_refused_ ? Vec3{} : LimitRise(force, last_, kMaxForceRise);
  return last_;
}

}  // namespace trocar::device
