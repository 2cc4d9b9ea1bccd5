// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/damage.h"

#include <gtest/gtest.h>

#include <array>

namespace trocar::tissue {
namespace {

class TearStrandsTest : public testing::Test {
 protected:
  TearStrandsTest() {
    TissueDefinition definition;
    for (int i = 0; i < 4; ++i) {
      definition.rest.push_back({0.01 * i, 0, 0});
      definition.rest.push_back({0.01 * i, 0, 0.001});
      definition.strands.push_back(
          {static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1), 50.0});
    }
    definition.mass.assign(8, 0.0);
    definition.shape_stiffness.assign(8, 1.0);
    model_ = MakeTissueModel(definition);
    state_ = MakeRestState(model_);
  }
  TissueModel model_;
  TissueState state_;
};

TEST_F(TearStrandsTest, TearsWhatIsLongerThanItsLimitAndNothingElse) {
  const std::array<double, 4> limits{0.002, 0.002, kNeverTears, 0.002};
  state_.position[1].z = 0.001 + 0.0019;  // just holds
  state_.position[3].z = 0.001 + 0.0021;  // tears
  state_.position[5].z = 5.0;             // never
  state_.position[7] = {0.031, 0, 0};     // turned, not stretched
  std::array<std::uint32_t, 2> torn{};
  EXPECT_EQ(TearStrands(model_, limits, state_, torn), 1u);
  EXPECT_EQ(torn[0], 1u);
  EXPECT_EQ(state_.strand_is_intact, (std::vector<std::uint8_t>{1, 0, 1, 1}));
  EXPECT_EQ(TearStrands(model_, limits, state_, torn), 0u) << "what is torn does not tear again";
}

TEST_F(TearStrandsTest, CountsMoreThanItsCapacity) {
  const std::array<double, 4> limits{1e-4, 1e-4, 1e-4, 1e-4};
  for (int i = 0; i < 4; ++i) state_.position[2 * i + 1].z += 0.01;
  std::array<std::uint32_t, 2> torn{};
  EXPECT_EQ(TearStrands(model_, limits, state_, torn), 4u);
  EXPECT_EQ(torn, (std::array<std::uint32_t, 2>{0, 1}));
}

}  // namespace
}  // namespace trocar::tissue
