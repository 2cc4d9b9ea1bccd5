// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/tissue_heat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "trocar/math/random.h"

namespace trocar::surgery {
namespace {

constexpr double kTick = 1.0 / 120;

HeatConstants Bloodless() {
  HeatConstants constants;
  constants.perfusion = 0;
  return constants;
}

/// A rod of `count` parts, `spacing` long each, of 1 mm x 1 mm.
TissueHeat MakeRod(std::size_t count, double spacing, const HeatConstants& constants) {
  std::vector<HeatNode> nodes(count, {1060 * 1e-6 * spacing, 1});
  std::vector<HeatLink> links;
  for (std::uint32_t i = 0; i + 1 < count; ++i)
    links.push_back({i, i + 1, CalcHeatConductance(constants, 1e-3, 1e-3, spacing)});
  return {nodes, links, constants};
}

TEST(TissueHeat, SpreadsAlongARodAsTheHeatEquationSays) {
  // a warm part in a long rod: a Gauss curve of variance 2 D t (+ that of the part itself)
  const double spacing = 2e-4;
  TissueHeat heat = MakeRod(201, spacing, Bloodless());
  HeatState state = heat.MakeState();
  state.temperature[100] += 40;  // stays below what harms
  const double amount = heat.CalcHeat(state);
  const double seconds = 5;
  for (int tick = 0; tick < static_cast<int>(seconds / kTick); ++tick) heat.Step({}, kTick, state);
  EXPECT_NEAR(heat.CalcHeat(state), amount, 1e-9 * amount);
  const HeatConstants c;
  const double variance = 2 * c.conductivity / (1060 * c.specific_heat) * seconds;
  for (int i = 60; i <= 140; ++i) {
    const double x = (i - 100) * spacing;
    const double expected =
        40 * spacing / std::sqrt(2 * std::numbers::pi * variance) * std::exp(-x * x / (2 * variance));
    EXPECT_NEAR(state.temperature[i] - kBodyTemperature, expected, 0.02 * 40 * spacing / std::sqrt(variance))
        << i;
  }
}

TEST(TissueHeat, BloodCoolsExponentially) {
  HeatConstants constants;
  constants.perfusion = 0.05;
  TissueHeat heat(std::vector<HeatNode>{{1e-5, 1}, {1e-5, 0}}, {}, constants);
  HeatState state = heat.MakeState();
  state.temperature = {41, 41};
  double lost = 0;
  const double before = heat.CalcHeat(state);
  for (int tick = 0; tick < 2400; ++tick) lost += heat.Step({}, kTick, state);
  EXPECT_NEAR(state.temperature[0], 37 + 4 * std::exp(-0.05 * 20), 1e-2);
  EXPECT_EQ(state.temperature[1], 41) << "a piece without blood keeps its heat";
  EXPECT_NEAR(before - heat.CalcHeat(state), lost, 1e-9);
}

TEST(TissueHeat, DamageFollowsArrhenius) {
  const HeatConstants c = Bloodless();
  TissueHeat heat(std::vector<HeatNode>{{1e-5, 1}}, {}, c);
  for (const double degrees : {50.0, 60.0, 70.0}) {
    HeatState state = heat.MakeState();
    state.temperature[0] = degrees;
    const double rate = c.damage_rate * std::exp(-c.damage_energy / (8.314462618 * (degrees + 273.15)));
    int ticks = 0;
    while (TissueHeat::InjuryOf(state, 0) == HeatInjury::kNone && ticks < 100000)
      heat.Step({}, kTick, state), ++ticks;
    EXPECT_NEAR(ticks * kTick, 1 / rate, kTick + 1e-9 / rate) << degrees;
    EXPECT_EQ(TissueHeat::InjuryOf(state, 0), HeatInjury::kBlanched);
  }
  // a minute or so at 50 degrees, seconds at 60, at once at 70: what textbooks of electrosurgery say
  HeatState state = heat.MakeState();
  state.temperature[0] = 45;
  for (int tick = 0; tick < 120 * 60; ++tick) heat.Step({}, kTick, state);
  EXPECT_EQ(TissueHeat::InjuryOf(state, 0), HeatInjury::kNone);
}

TEST(TissueHeat, BoilsBeforeItChars) {
  const HeatConstants c = Bloodless();
  const double mass = 5e-7;
  TissueHeat heat(std::vector<HeatNode>{{mass, 1}}, {}, c);
  HeatState state = heat.MakeState();
  const TissueHeat::Source source{0, 30.0};
  bool was_boiling = false;
  HeatInjury worst = HeatInjury::kNone;
  double given = 0, lost = 0, parted_at = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    lost += heat.Step({&source, 1}, kTick / 20, state);
    given += 30.0 * kTick / 20;
    EXPECT_TRUE(state.water[0] == 0 || state.temperature[0] <= kBoilingTemperature);
    was_boiling = was_boiling || (state.temperature[0] == kBoilingTemperature && state.water[0] > 0.1);
    const HeatInjury injury = TissueHeat::InjuryOf(state, 0);
    EXPECT_GE(injury, worst) << "an injury heals";
    worst = injury;
    if (parted_at == 0 && injury >= HeatInjury::kParted) parted_at = given;
    EXPECT_NEAR(given - lost, heat.CalcHeat(state), 1e-9 * given) << tick;
  }
  EXPECT_TRUE(was_boiling);
  EXPECT_EQ(worst, HeatInjury::kCharred);
  // to 100 degrees, and two thirds of the water boiled off
  const double expected = mass * c.specific_heat * 63 + 2.0 / 3 * mass * c.water_share * c.latent_heat;
  EXPECT_NEAR(parted_at, expected, 0.1 * expected);
}

TEST(TissueHeat, DoesNothingWithoutTouchAndKeepsItsBalanceWithIt) {
  math::Random random(3);
  TissueHeat heat = MakeRod(40, 1e-3, {});
  HeatState state = heat.MakeState();
  EXPECT_EQ(heat.Step({}, kTick, state), 0);
  EXPECT_EQ(state.temperature, heat.MakeState().temperature);
  double given = 0, lost = 0;
  for (int tick = 0; tick < 1200; ++tick) {
    const TissueHeat::Source sources[] = {
        {static_cast<std::uint32_t>(random.Uniform(0, 45)), random.Uniform(0, 1)},
        {5, -3.0}};  // nowhere, or negative: no heat
    if (sources[0].node < 40) given += sources[0].power * kTick;
    lost += heat.Step(sources, kTick, state);
    for (std::size_t i = 0; i < heat.Size(); ++i) {
      ASSERT_TRUE(std::isfinite(state.temperature[i]));
      ASSERT_GE(state.temperature[i], kBodyTemperature - 1e-9);
      ASSERT_GE(state.water[i], 0);
    }
  }
  EXPECT_NEAR(given - lost, heat.CalcHeat(state), 1e-8 * given);
}

TEST(TissueHeat, IsStableWhereLinksAreStrong) {
  HeatConstants constants = Bloodless();
  std::vector<HeatLink> links{{0, 1, 50.0}};  // exchanges all heat within microseconds
  TissueHeat heat(std::vector<HeatNode>{{1e-6, 1}, {1e-6, 1}}, links, constants);
  HeatState state = heat.MakeState();
  state.temperature[0] = 41;
  heat.Step({}, kTick, state);
  EXPECT_NEAR(state.temperature[0], 39, 1e-6);
  EXPECT_NEAR(state.temperature[1], 39, 1e-6);
}

}  // namespace
}  // namespace trocar::surgery
