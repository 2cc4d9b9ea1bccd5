// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/clip_hold.h"

#include <algorithm>
#include <cmath>

namespace trocar::surgery {
namespace {

constexpr double kPressure = 40e3;       // 300 mmHg: Deans 1995 [Pa]
constexpr double kPull = 4.4;            // between 4.08 and 4.78 N: Nelson 1992 [N]
constexpr double kCrossedShare = 0.1;    // legs that do not lie flat hold by a corner
constexpr double kThickRadius = 0.0025;  // of a vessel that the clip is meant for, outside [m]
constexpr double kPartialPower = 6.0;    // of the closure: what lies beyond the tips keeps them apart
constexpr double kSpeed = 0.001;         // of a clip under twice what it withstands [m/s]
constexpr double kFastest = 0.005;       // [m/s]

}  // namespace

ClipHold CalcClipHold(const ClipGrip& grip) noexcept {
  const double closure = std::clamp(grip.closure, 0.0, 1.0);
  double share = std::pow(closure, kPartialPower);
  if (grip.is_crossed) share *= kCrossedShare;
  // more tissue between the legs springs them open
  const double thick = kThickRadius / std::max(grip.vessel_radius, kThickRadius);
  share *= thick * thick;
  return {share * kPressure, share * kPull};
}

double CalcClipLoad(const ClipHold& hold, double pressure, double pull) noexcept {
  constexpr double kLeastPressure = 1.0, kLeastPull = 1e-4;
  return std::max(0.0, pressure) / std::max(hold.pressure, kLeastPressure) +
         std::max(0.0, pull) / std::max(hold.pull, kLeastPull);
}

double CalcSlipSpeed(double load) noexcept {
  return std::clamp(kSpeed * (load - 1.0), 0.0, kFastest);
}

}  // namespace trocar::surgery
