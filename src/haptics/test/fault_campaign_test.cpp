// SPDX-License-Identifier: Apache-2.0
// Each row of the fault catalogue that concerns force. The negative controls, haptics_without_*, leave one guard out of
// the build and want the row to fail.
#include "fault_campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(FaultTable, NamesEveryFaultInOrderWithARemedy) {
  for (std::size_t i = 0; i < FaultTable().size(); ++i) {
    const FaultEntry& entry = FaultTable()[i];
    EXPECT_EQ(static_cast<std::size_t>(entry.fault), i);
    if (entry.fault == Fault::kNone) continue;
    EXPECT_NE(entry.code, core::ErrorCode::kNone) << entry.name;
    EXPECT_FALSE(entry.what.empty()) << entry.name;
    EXPECT_FALSE(entry.remedy.empty()) << entry.name;
  }
}

}  // namespace
}  // namespace trocar::haptics
