// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/vital_signs.h"

#include <gtest/gtest.h>

namespace trocar::sound {
namespace {

TEST(VitalSigns, HeartRatesAreThoseOfTheClassesOfHaemorrhage) {
  EXPECT_NEAR(CalcVitalSigns(0).heart_rate, 72, 1e-12);
  EXPECT_NEAR(CalcVitalSigns(750e-6).heart_rate, 100, 1e-9);
  EXPECT_NEAR(CalcVitalSigns(1500e-6).heart_rate, 120, 1e-9);
  EXPECT_NEAR(CalcVitalSigns(2000e-6).heart_rate, 140, 1e-9);
  EXPECT_NEAR(CalcVitalSigns(375e-6).heart_rate, 86, 1e-9);
}

TEST(VitalSigns, MoreLostBloodIsNeverBetter) {
  VitalSigns before = CalcVitalSigns(-1);
  for (double lost = 0; lost < 6e-3; lost += 1e-5) {
    const VitalSigns now = CalcVitalSigns(lost);
    EXPECT_GE(now.heart_rate, before.heart_rate);
    EXPECT_LE(now.saturation, before.saturation);
    EXPECT_GE(now.saturation, 0.8 - 1e-12);
    before = now;
  }
}

TEST(VitalSigns, PitchIsHalfASemitoneLowerForEachPercent) {
  EXPECT_NEAR(CalcPulsePitch(1), 880, 1e-9);
  EXPECT_NEAR(CalcPulsePitch(0.88), 880 / 1.41421356237, 1e-6);
  EXPECT_NEAR(CalcPulsePitch(0.76), 440, 1e-9);
  EXPECT_EQ(CalcPulsePitch(0.1), CalcPulsePitch(0.5));
}

}  // namespace
}  // namespace trocar::sound
