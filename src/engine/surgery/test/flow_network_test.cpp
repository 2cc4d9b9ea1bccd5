// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/flow_network.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "trocar/math/random.h"

namespace trocar::surgery {
namespace {

constexpr double kStiff = 1e-4;  // conductance of a supply that holds its pressure [m^3/(Pa s)]

double Pipe(double radius, double length, double viscosity) {
  return std::numbers::pi * std::pow(radius, 4) / (8 * viscosity * length);
}

FlowNetwork MakeLine(Fluid fluid, double p0, double g0, double p1, double g1, double length, double radius) {
  return FlowNetwork::Make({{fluid, 0, 1, length, radius}}, {{p0, g0}, {p1, g1}}).value();
}

TEST(FlowNetwork, CarriesWhatHagenAndPoiseuilleSay) {
  FlowNetwork network = MakeLine(Fluid::kBile, 2000, kStiff, 500, kStiff, 0.04, 0.001);
  const FlowReport report = network.Solve({});
  EXPECT_EQ(report.leak_count, 0u);
  const double expected = 1500 * Pipe(0.001, 0.04, 1e-3);
  EXPECT_NEAR(network.SupplyAt(0), expected, 1e-3 * expected);
  EXPECT_NEAR(network.SupplyAt(1), -expected, 1e-3 * expected);
}

TEST(FlowNetwork, ObeysTheOrificeLawWithAndWithoutAResistanceBehindIt) {
  // q = c sqrt(p), p = P - R q: a quadratic in q
  for (const double supply : {kStiff, 1.25e-10}) {
    FlowNetwork network = MakeLine(Fluid::kBlood, 12e3, supply, 0, 0, 0.02, 0.00095);
    VesselActs acts;
    acts.openings.push_back({0, 0.01, false, 1e-7, {}});
    const FlowReport report = network.Solve(acts);
    ASSERT_EQ(report.leak_count, 1u);
    const double resistance = 1 / supply + 1 / Pipe(0.00095, 0.01, 3.5e-3);
    const double c = 0.62 * 1e-7 * std::sqrt(2 / 1060.0);
    const double q = 0.5 * c * (-c * resistance + std::sqrt(c * c * resistance * resistance + 4 * 12e3));
    EXPECT_NEAR(report.Leaks()[0].rate / q, 1, 2e-3) << supply;  // the orifice's smooth foot is 1 Pa wide
    EXPECT_EQ(report.Leaks()[0].fluid, Fluid::kBlood);
  }
}

TEST(FlowNetwork, ACutArteryBleedsFromTheEndThatIsSupplied) {
  // domain facts 1.4: a cystic artery bleeds 1 to 2 mL/s at first
  FlowNetwork network = MakeLine(Fluid::kBlood, 12e3, 1.25e-10, 0, 0, 0.0208, 0.00095);
  VesselActs acts;
  acts.openings.push_back({0, 0.01, true, 0, {}});
  const FlowReport report = network.Solve(acts);
  ASSERT_EQ(report.leak_count, 1u);
  EXPECT_EQ(report.Leaks()[0].end, 0);
  EXPECT_GT(report.rate[1], 1.0e-6);
  EXPECT_LT(report.rate[1], 2.0e-6);
  EXPECT_NEAR(network.SupplyAt(0), report.rate[1], 1e-9 * report.rate[1]);
}

TEST(FlowNetwork, AClipTightensByTheFourthPower) {
  FlowNetwork network = MakeLine(Fluid::kBlood, 12e3, kStiff, 0, 0, 0.0208, 0.00095);
  VesselActs acts;
  acts.openings.push_back({0, 0.015, true, 0, {}});
  double last = network.Solve(acts).rate[1];
  for (const double closure : {0.25, 0.5, 0.75, 0.9, 0.99}) {
    acts.clips.assign(1, {0, 0.005, closure});
    const double rate = network.Solve(acts).rate[1];
    EXPECT_LT(rate, last) << closure;
    last = rate;
  }
  // nearly shut: the clip alone limits
  EXPECT_NEAR(last / (12e3 * Pipe(0.01 * 0.00095, 0.003, 3.5e-3)), 1, 1e-3);
  acts.clips.assign(1, {0, 0.005, 1.0});
  EXPECT_EQ(network.Solve(acts).rate[1], 0);
  acts.clips.assign(1, {0, 0.018, 1.0});  // beyond the cut
  EXPECT_GT(network.Solve(acts).rate[1], 1e-6);
}

TEST(FlowNetwork, CoagulationAndPressureSealAnEnd) {
  FlowNetwork network = MakeLine(Fluid::kBlood, 12e3, 1.25e-10, 0, 0, 0.0208, 0.00095);
  VesselActs acts;
  acts.openings.push_back({0, 0.01, true, 0, {1.0, 0.0}});
  EXPECT_EQ(network.Solve(acts).leak_count, 0u);
  acts.openings[0].sealed[0] = 0.0;
  EXPECT_EQ(network.Solve(acts).leak_count, 1u);
}

/// hepatic duct - junction - bile duct, the cystic duct at the junction, the gallbladder at its end
FlowNetwork MakeBiliaryTree() {
  return FlowNetwork::Make({{Fluid::kBile, 0, 1, 0.030, 0.0020},
                            {Fluid::kBile, 1, 2, 0.075, 0.0020},
                            {Fluid::kBile, 3, 1, 0.035, 0.0010}},
                           {{3000, 5e-12}, {0, 0}, {1300, 1e-10}, {1500, 1e-8}})
      .value();
}

TEST(FlowNetwork, LosesNothingAtItsJunctions) {
  math::Random random(5);
  FlowNetwork network = MakeBiliaryTree();
  for (int trial = 0; trial < 300; ++trial) {
    VesselActs acts;
    for (int k = static_cast<int>(random.Uniform(0, 4)); k > 0; --k)
      acts.clips.push_back({static_cast<std::uint32_t>(random.Uniform(0, 3)), random.Uniform(0, 0.08),
                            random.Uniform(0, 1.2)});
    for (int k = static_cast<int>(random.Uniform(0, 5)); k > 0; --k)
      acts.openings.push_back({static_cast<std::uint32_t>(random.Uniform(0, 3)),
                               random.Uniform(0, 0.08),
                               random.Uniform(0, 1) < 0.5,
                               random.Uniform(0, 1e-6),
                               {random.Uniform(-0.2, 1.2), random.Uniform(-0.2, 1.2)}});
    const FlowReport report = network.Solve(acts);
    double supplied = 0, taken = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double supply = network.SupplyAt(j);
      (supply > 0 ? supplied : taken) += std::fabs(supply);
    }
    double leaked = 0;
    for (const Leak& leak : report.Leaks()) {
      EXPECT_GT(leak.rate, 0);
      leaked += leak.rate;
    }
    EXPECT_NEAR(supplied, taken + leaked, 1e-8 * supplied + 1e-18) << trial;
    EXPECT_NEAR(leaked, report.rate[0], 1e-12 * leaked);
    EXPECT_EQ(report.rate[1], 0);
  }
}

TEST(FlowNetwork, KnowsWhatStillHangsTogether) {
  const FlowNetwork network = MakeBiliaryTree();
  VesselActs acts;
  EXPECT_TRUE(network.AreConnected(acts, 0, 2));
  EXPECT_TRUE(network.AreConnected(acts, 3, 2));
  acts.clips.push_back({2, 0.020, 1.0});
  EXPECT_FALSE(network.AreConnected(acts, 3, 2));
  EXPECT_TRUE(network.AreConnected(acts, 0, 2)) << "a clip on the cystic duct shuts the bile duct";
  acts.clips[0].closure = 0.8;
  EXPECT_TRUE(network.AreConnected(acts, 3, 2)) << "a partial clip lets bile through";
  acts.openings.push_back({1, 0.01, true, 0, {1, 1}});
  EXPECT_FALSE(network.AreConnected(acts, 0, 2)) << "a cut is a cut, sealed or not";
}

TEST(FlowNetwork, IgnoresActsThatLieNowhereAndKeepsQuietWithoutSupply) {
  FlowNetwork network = MakeLine(Fluid::kBile, 0, 0, 0, 0, 0.03, 0.001);
  VesselActs acts;
  acts.openings.push_back({0, 0.01, true, 0, {}});
  acts.openings.push_back({7, 0.01, true, 0, {}});
  acts.openings.push_back({0, -1, true, 0, {}});
  acts.openings.push_back({0, NAN, true, 0, {}});
  acts.clips.push_back({0, NAN, 1});
  const FlowReport report = network.Solve(acts);
  EXPECT_EQ(report.leak_count, 0u);
  EXPECT_TRUE(network.AreConnected({}, 0, 1));
}

TEST(FlowNetwork, RefusesWhatIsNoNetwork) {
  const FlowJunction open;
  const FlowVessel good{Fluid::kBile, 0, 1, 0.03, 0.001};
  EXPECT_TRUE(FlowNetwork::Make({good}, {open, open}).ok());
  auto bad = good;
  bad.to = 2;
  EXPECT_EQ(FlowNetwork::Make({bad}, {open, open}).error().code, base::ErrorCode::kPatientInvalid);
  bad = good, bad.length = 0;
  EXPECT_FALSE(FlowNetwork::Make({bad}, {open, open}).ok());
  bad = good, bad.radius = NAN;
  EXPECT_FALSE(FlowNetwork::Make({bad}, {open, open}).ok());
  EXPECT_FALSE(FlowNetwork::Make({good}, {open, {NAN, 0}}).ok());
  EXPECT_FALSE(FlowNetwork::Make({good, {Fluid::kBlood, 1, 2, 0.03, 0.001}}, {open, open, open}).ok());
  EXPECT_FALSE(FlowNetwork::Make(std::vector<FlowVessel>(100, good), {open, open}).ok());
}

TEST(FluidLedger, BalancesThroughLeaksRinsingAndSuction) {
  math::Random random(11);
  FluidLedger ledger;
  for (int tick = 0; tick < 20000; ++tick) {
    ledger.Leak(Fluid::kBlood, random.Uniform(0, 1e-8));
    ledger.Leak(Fluid::kBile, random.Uniform(0, 1e-9));
    if (tick % 3 == 0) ledger.Rinse(random.Uniform(0, 1e-7));
    if (tick % 5 == 0) {
      const double before = ledger.Pooled(), asked = random.Uniform(0, 3e-7);
      const double taken = ledger.Aspirate(asked);
      EXPECT_LE(taken, asked * (1 + 1e-12));
      EXPECT_NEAR(before - ledger.Pooled(), taken, 1e-12 * before);
    }
    for (const auto& account : ledger.fluids) ASSERT_GE(account.pooled, 0);
  }
  for (const auto& account : ledger.fluids)
    EXPECT_NEAR(account.left, account.pooled + account.aspirated, 1e-9 * account.left);
  EXPECT_GT(ledger.fluids[1].aspirated, 0);
  ledger.Aspirate(1.0);
  EXPECT_NEAR(ledger.Pooled(), 0, 1e-18);
  EXPECT_EQ(ledger.Aspirate(1.0), 0);
}

}  // namespace
}  // namespace trocar::surgery
