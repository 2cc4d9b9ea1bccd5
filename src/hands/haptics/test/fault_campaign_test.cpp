// SPDX-License-Identifier: Apache-2.0
// Each row of the fault catalogue that concerns force. The negative controls, haptics_without_*, leave one guard out of
// the build and want the row to fail.
#include "fault_campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <type_traits>

#include "trocar/haptics/fault.h"
#include "trocar/haptics/force_gate.h"

namespace trocar::haptics {

void PrintTo(const CampaignRow& row, std::ostream* out) {
  *out << row.name;
}

namespace {

class FaultCampaign : public testing::TestWithParam<CampaignRow> {};

TEST_P(FaultCampaign, HoldsItsRow) {
  const std::string wrong = GetParam().check();
  EXPECT_TRUE(wrong.empty()) << wrong;
}

INSTANTIATE_TEST_SUITE_P(Rows, FaultCampaign, testing::ValuesIn(CampaignRows().begin(), CampaignRows().end()),
                         [](const auto& row) {
                           std::string name = row.param.name;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

// No way around the gate compiles.
static_assert(std::is_constructible_v<device::GatedForce>);
static_assert(!std::is_constructible_v<device::GatedForce, math::Vec3>);
static_assert(!std::is_convertible_v<math::Vec3, device::GatedForce>);
static_assert(!std::is_convertible_v<math::Vec3, DeviceForce>);

TEST(GatedForce, IsZeroUnlessTheGateMadeIt) {
  EXPECT_EQ(device::GatedForce().Get(), math::Vec3());
}

// The gate in production passes every one of these; a force that another path left in a driver's mailbox does not.
TEST(ForceCheck, LetsOutWhatAGateLetsOutAndNothingElse) {
  using device::ForceCheck;
  ForceCheck check(3.3);
  EXPECT_EQ(check.Pass({0.5, 0, 0}), (math::Vec3{0.5, 0, 0}));
  EXPECT_EQ(check.Pass({0, 0.5, 0}), (math::Vec3{0, 0.5, 0})) << "round by zero";
  EXPECT_NEAR(math::Norm(check.Pass({0, 3.3, 0})), 1.0, 1e-12) << "a rise of 0.5 N at once";
  for (int i = 0; i < 10; ++i) check.Pass({0, 3.3, 0});
  EXPECT_EQ(check.Pass({0, 3.3, 0}), (math::Vec3{0, 3.3, 0}));
  EXPECT_FALSE(check.HasRefused());
  EXPECT_EQ(check.Pass({}), math::Vec3{}) << "a fall is free";
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const math::Vec3& bad :
       {math::Vec3{nan, 0, 0}, math::Vec3{0, 0, -inf}, math::Vec3{0, 3.31, 0}, math::Vec3{1e200, 1e200, 0}}) {
    ForceCheck strict(3.3);
    strict.Pass({0.2, 0, 0});
    EXPECT_EQ(strict.Pass(bad), math::Vec3{});
    EXPECT_TRUE(strict.HasRefused());
    EXPECT_EQ(strict.Pass({0.2, 0, 0}), math::Vec3{}) << "latched";
  }
  EXPECT_EQ(ForceCheck(inf).Pass({0.2, 0, 0}), math::Vec3{}) << "and nothing to one that no hand holds";
  EXPECT_EQ(ForceCheck(50.1).Pass({0.2, 0, 0}), math::Vec3{});
  EXPECT_EQ(ForceCheck(0.09).Pass({0.05, 0, 0}), math::Vec3{});
  for (const double limit : {device::kSmallestForceLimit, device::kLargestForceLimit})
    EXPECT_EQ(ForceCheck(limit).Pass({0.1, 0, 0}), (math::Vec3{0.1, 0, 0})) << limit;
  EXPECT_EQ(ForceCheck().Pass({1e-6, 0, 0}), math::Vec3{}) << "a check that knows no device passes nothing";
}

TEST(CalcRise, IsTheDistanceToTheWayFromZero) {
  EXPECT_DOUBLE_EQ(device::CalcRise({3, 0, 0}, {}), 3.0);
  EXPECT_DOUBLE_EQ(device::CalcRise({3, 0, 0}, {2, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(device::CalcRise({1, 0, 0}, {2, 0, 0}), 0.0) << "a fall";
  EXPECT_DOUBLE_EQ(device::CalcRise({1, 1, 0}, {2, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(device::CalcRise({-1, 0, 0}, {2, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(device::CalcRise({0.3, 0, 0}, {0.1, 0, 0}), 0.2) << "small ones, too";
  EXPECT_DOUBLE_EQ(device::CalcRise({0.3, 0.4, 0}, {4, 0, 0}), 0.4);
  EXPECT_FALSE(device::CalcRise({std::nan(""), 0, 0}, {2, 0, 0}) <= 1e9);
}

TEST(LimitRise, StaysNearTheWayFromZero) {
  const auto limited = [](const math::Vec3& wanted, const math::Vec3& before, const math::Vec3& expected) {
    EXPECT_NEAR(math::Distance(device::LimitRise(wanted, before, 0.5), expected), 0.0, 1e-12);
  };
  limited({0.4, 0, 0}, {}, {0.4, 0, 0});
  limited({0.5, 0, 0}, {}, {0.5, 0, 0});
  limited({2, 0, 0}, {}, {0.5, 0, 0});
  limited({0.8, 0, 0}, {0.4, 0, 0}, {0.8, 0, 0});
  limited({3, 0, 0}, {1, 0, 0}, {1.5, 0, 0});
  limited({0.2, 0, 0}, {3, 0, 0}, {0.2, 0, 0});
  limited({-2, 0, 0}, {1, 0, 0}, {-0.5, 0, 0});
  limited({0.5, 2, 0}, {1, 0, 0}, {0.5, 0.5, 0});
  EXPECT_FALSE(math::IsFinite(device::LimitRise({std::nan(""), 0, 0}, {1, 0, 0}, 0.5)))
      << "and hides nothing";
}

TEST(FaultTable, NamesEveryFaultInOrderWithARemedy) {
  for (std::size_t i = 0; i < FaultTable().size(); ++i) {
    const FaultEntry& entry = FaultTable()[i];
    EXPECT_EQ(static_cast<std::size_t>(entry.fault), i);
    if (entry.fault == Fault::kNone) continue;
    EXPECT_NE(entry.code, base::ErrorCode::kNone) << entry.name;
    EXPECT_FALSE(entry.what.empty()) << entry.name;
    EXPECT_FALSE(entry.remedy.empty()) << entry.name;
  }
}

}  // namespace
}  // namespace trocar::haptics
