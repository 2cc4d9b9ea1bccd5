// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/slider_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace trocar::presenter {
namespace {

constexpr SliderScale kLinear{ScaleKind::kLinear, -10, 30};
constexpr SliderScale kLog{ScaleKind::kLogarithmic, 0.05, 20};
constexpr SliderScale kLogOrZero{ScaleKind::kLogarithmicOrZero, 0, 20, 0.01};
constexpr SliderScale kWhole{ScaleKind::kLogarithmic, 1, 2000, 0, true};

TEST(SliderScale, LinearIsLinear) {
  EXPECT_DOUBLE_EQ(ValueAt(kLinear, 0.25), 0.0);
  EXPECT_DOUBLE_EQ(PositionOf(kLinear, 20.0), 0.75);
}

TEST(SliderScale, LogarithmicPutsTheGeometricMeanInTheMiddle) {
  EXPECT_NEAR(ValueAt(kLog, 0.5), std::sqrt(0.05 * 20), 1e-12);
  EXPECT_NEAR(PositionOf(kLog, 1.0), std::log(20.0) / std::log(400.0), 1e-12);
}

TEST(SliderScale, EndsAreExact) {
  for (const SliderScale& scale : {kLinear, kLog, kLogOrZero, kWhole}) {
    EXPECT_DOUBLE_EQ(ValueAt(scale, 0.0), scale.min);
    EXPECT_DOUBLE_EQ(ValueAt(scale, 1.0), scale.max);
    EXPECT_DOUBLE_EQ(PositionOf(scale, scale.min), 0.0);
    EXPECT_DOUBLE_EQ(PositionOf(scale, scale.max), 1.0);
  }
}

TEST(SliderScale, GoesThereAndBack) {
  for (const SliderScale& scale : {kLinear, kLog, kLogOrZero}) {
    for (double position = kZeroPart; position <= 1.0; position += 0.01)
      EXPECT_NEAR(PositionOf(scale, ValueAt(scale, position)), position, 1e-12);
  }
}

TEST(SliderScale, LeftEndOfLogarithmicOrZeroIsOff) {
  EXPECT_EQ(ValueAt(kLogOrZero, 0.5 * kZeroPart), 0.0);
  EXPECT_NEAR(ValueAt(kLogOrZero, kZeroPart), 0.01, 1e-12);
  EXPECT_GT(PositionOf(kLogOrZero, 1e-9), 0.0) << "a small value is not off";
}

TEST(SliderScale, WholeValuesAreWholeAndRise) {
  double last = 0.0;
  for (double position = 0.0; position <= 1.0; position += 0.005) {
    const double value = ValueAt(kWhole, position);
    EXPECT_EQ(value, std::round(value));
    EXPECT_GE(value, last);
    last = value;
  }
}

TEST(SliderScale, BadNumbersAreHeldInRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SliderScale& scale : {kLinear, kLog, kLogOrZero, kWhole}) {
    EXPECT_EQ(ValueAt(scale, nan), scale.min);
    EXPECT_DOUBLE_EQ(ValueAt(scale, 7.0), scale.max);
    EXPECT_DOUBLE_EQ(PositionOf(scale, nan), 0.0);
    EXPECT_DOUBLE_EQ(PositionOf(scale, -1e9), 0.0);
    EXPECT_DOUBLE_EQ(PositionOf(scale, 1e9), 1.0);
  }
}

}  // namespace
}  // namespace trocar::presenter
