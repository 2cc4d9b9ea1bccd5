// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/vital_signs.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace trocar::sound {
namespace {

struct Row {
  double lost;  // [m^3]
  VitalSigns signs;
};
constexpr Row kRows[] = {{0, {72, 0.98}},
                         {750e-6, {100, 0.98}},
                         {1500e-6, {120, 0.95}},
                         {2000e-6, {140, 0.90}},
                         {3000e-6, {160, 0.80}}};
constexpr double kFullPitch = 880;            // [Hz]
constexpr double kPercentPerOctave = 2 * 12;  // half a semitone a percent
constexpr double kLeastSaturation = 0.5;

}  // namespace

VitalSigns CalcVitalSigns(double lost) noexcept {
  const Row* after = std::upper_bound(std::begin(kRows), std::end(kRows), lost,
                                      [](double value, const Row& row) { return value < row.lost; });
  if (after == std::begin(kRows)) return kRows[0].signs;
  if (after == std::end(kRows)) return std::prev(std::end(kRows))->signs;
  const Row& before = *std::prev(after);
  const double share = (lost - before.lost) / (after->lost - before.lost);
  return {std::lerp(before.signs.heart_rate, after->signs.heart_rate, share),
          std::lerp(before.signs.saturation, after->signs.saturation, share)};
}

double CalcPulsePitch(double saturation) noexcept {
  const double percent_missing = 100 * (1 - std::clamp(saturation, kLeastSaturation, 1.0));
  return kFullPitch * std::exp2(-percent_missing / kPercentPerOctave);
}

}  // namespace trocar::sound
