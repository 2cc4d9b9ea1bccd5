// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/clip_hold.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::surgery {

ClipHold CalcClipHold(const ClipGrip& grip, const ClipHoldSettings& settings) noexcept {
  const double closure = std::clamp(grip.closure, 0.0, 1.0);
  double share = math::Pow(closure, settings.partial_power);
  if (grip.is_crossed) share *= settings.crossed_share;
  // more tissue between the legs springs them open
  const double thick = settings.thick_radius / std::max(grip.vessel_radius, settings.thick_radius);
  share *= thick * thick;
  return {share * settings.pressure, share * settings.pull};
}

double CalcClipLoad(const ClipHold& hold, double pressure, double pull) noexcept {
  constexpr double kLeastPressure = 1.0, kLeastPull = 1e-4;
  return std::max(0.0, pressure) / std::max(hold.pressure, kLeastPressure) +
         std::max(0.0, pull) / std::max(hold.pull, kLeastPull);
}

double CalcSlipSpeed(double load, const ClipHoldSettings& settings) noexcept {
  return std::clamp(settings.slip_speed * (load - 1.0), 0.0, settings.fastest_slip);
}

}  // namespace trocar::surgery
