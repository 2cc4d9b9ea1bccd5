// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/kinematics_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "trocar/training/attempt_metrics.h"
#include "trocar/training/metric_definition.h"

namespace trocar::training {
namespace {

using math::Vec3;
using Place = std::function<Vec3(double seconds)>;

constexpr int kRows = 301;  // 10 s

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// Rows as that data set writes them, of two instruments; every other column holds its own number.
std::string Write(KinematicsFormat format, const Place& left, const Place& right) {
  const bool is_compass = format == KinematicsFormat::kCompass;
  std::string text = is_compass ? "MTML_position_x,PSMR_position_x,PSMR_position_y,PSMR_position_z,PSML_"
                                  "gripper_angle,PSML_position_x,"
                                  "PSML_position_y,PSML_position_z\n"
                                : "";
  for (int row = 0; row < kRows; ++row) {
    const double t = row / kKinematicsRate;
    const Vec3 l = left(t), r = right(t);
    if (is_compass) {
      text += "0.1," + Number(r.x) + "," + Number(r.y) + "," + Number(r.z) + ",-0.8," + Number(l.x) + "," +
              Number(l.y) + "," + Number(l.z) + "\n";
      continue;
    }
    for (int column = 1; column <= 76; ++column) {
      const bool is_left = column >= 39 && column <= 41, is_right = column >= 58 && column <= 60;
      const double value = is_left ? l[column - 39] : is_right ? r[column - 58] : column;
      text += "   " + Number(value);
    }
    text += "\n";
  }
  return text;
}

/// A circle of 30 mm in 4 s, and a line of 20 mm/s.
Vec3 OnCircle(double t) {
  const double angle = t * std::acos(-1.0) / 2;
  return {0.03 * std::cos(angle), 0.03 * std::sin(angle), -0.1};
}
Vec3 OnLine(double t) {
  return {0.0, 0.02 * t, 0.0};
}

class KinematicsFileTest : public testing::TestWithParam<KinematicsFormat> {};

TEST_P(KinematicsFileTest, GivesTheSameNumbersAsATraceOfOurs) {
  const auto trace = ParseKinematics(Write(GetParam(), OnCircle, OnLine), GetParam(), "a.txt");
  ASSERT_TRUE(trace.ok()) << trace.error().Text();
  EXPECT_EQ(trace->Ticks(), static_cast<std::size_t>(kRows));
  const auto all = CalcAttemptMetrics(*trace);
  ASSERT_TRUE(all.ok());
  const AttemptMetrics metrics = KeepMetricsOfTips(*all);
  ASSERT_NE(metrics.Find("path_sum", "left"), nullptr);
  EXPECT_NEAR(*metrics.Find("path_sum", "left"), 2.5 * 2 * std::acos(-1.0) * 0.03, 1e-3);
  EXPECT_NEAR(*metrics.Find("path_sum", "right"), 0.2, 1e-6);
  EXPECT_NEAR(*metrics.Find("path_length", "right"), 0.2, 1e-3);
  EXPECT_NEAR(*metrics.Find("time"), 10.0, 1e-9);
  // the same motion as a trace of ours
  AttemptTrace own;
  own.dt = trace->dt;
  own.tool_names = {"instrument"};
  for (int row = 0; row < kRows; ++row) {
    own.hands[0].emplace_back().tip = OnCircle(row * own.dt);
    own.hands[1].emplace_back().tip = OnLine(row * own.dt);
  }
  const AttemptMetrics ours = KeepMetricsOfTips(*CalcAttemptMetrics(own));
  ASSERT_EQ(ours.values.size(), metrics.values.size());
  for (std::size_t i = 0; i < ours.values.size(); ++i)
    EXPECT_NEAR(metrics.values[i].value, ours.values[i].value,
                1e-5 * std::max(1.0, std::fabs(ours.values[i].value)))
        << ours.values[i].metric;
}

// forces, views and grasps were not measured: they are absent, not 0
TEST_P(KinematicsFileTest, SaysNothingOfWhatWasNotMeasured) {
  const auto trace = ParseKinematics(Write(GetParam(), OnCircle, OnLine), GetParam(), "a.txt");
  ASSERT_TRUE(trace.ok());
  const AttemptMetrics metrics = KeepMetricsOfTips(*CalcAttemptMetrics(*trace));
  EXPECT_GT(metrics.values.size(), 20U);
  for (const char* absent :
       {"max_force", "depth_path", "angular_path", "out_of_view_time", "grasp_attempts", "errors"})
    for (const char* hand : {"left", "right", ""}) EXPECT_EQ(metrics.Find(absent, hand), nullptr) << absent;
}

TEST_P(KinematicsFileTest, RefusesWhatIsNoSuchFileWithItsLine) {
  const std::string good = Write(GetParam(), OnCircle, OnLine);
  const auto why = [](const std::string& text) {
    const auto trace = ParseKinematics(text, GetParam(), "a.txt");
    if (trace.ok()) return std::string("it is read");
    EXPECT_EQ(trace.error().code, base::ErrorCode::kDatasetInvalid);
    return trace.error().message;
  };
  EXPECT_NE(why("").find("line"), std::string::npos);
  const std::size_t third = good.find('\n', good.find('\n') + 1) + 1;
  EXPECT_NE(why(good.substr(0, third) + "1 2 3\n").find("line 3"), std::string::npos);
  std::string broken = good;
  // the last number of the second line: the right instrument's z, or the left one's
  const std::size_t end = broken.find('\n', broken.find('\n') + 1);
  broken.insert(end, GetParam() == KinematicsFormat::kCompass ? "x" : " 7");
  EXPECT_NE(why(broken).find("line 2"), std::string::npos) << why(broken);
  // a file that ends in the middle of a row
  EXPECT_NE(why(good.substr(0, good.size() - 30)).find("columns"), std::string::npos);
  std::string endless = good;
  const std::string number = Number(OnLine(0.1).y);
  endless.replace(endless.find(number), number.size(),
                  std::string("inf") + std::string(number.size() - 3, ' '));
  EXPECT_NE(why(endless), "it is read");
}

INSTANTIATE_TEST_SUITE_P(Formats, KinematicsFileTest, testing::ValuesIn(kKinematicsFormats),
                         [](const auto& format) { return std::string(NameOf(format.param)); });

TEST(MetricsOfTips, AreDefinedAndOfHandsOrBoth) {
  for (const std::string_view id : MetricsOfTips()) {
    const MetricDefinition* d = FindMetric(id);
    ASSERT_NE(d, nullptr) << id;
    EXPECT_TRUE(d->sampling == "resampled" || d->sampling == "ticks") << id;
  }
  EXPECT_EQ(FindKinematicsFormat("jigsaws"), KinematicsFormat::kJigsaws);
  EXPECT_FALSE(FindKinematicsFormat("JIGSAWS"));
}

}  // namespace
}  // namespace trocar::training
