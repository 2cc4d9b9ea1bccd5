// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/settings_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace trocar::presenter {
namespace {

const SettingRow& Row(const std::string& label) {
  for (const SettingRow& row : SettingRows())
    if (label == row.label) return row;
  ADD_FAILURE() << "no row " << label;
  return SettingRows()[0];
}

// Each slider moves one setting and no other, over a range that the session accepts unchanged.
TEST(SettingsForm, EverySliderReachesItsOwnSettingWithinTheSessionsRange) {
  for (const SettingRow& row : SettingRows()) {
    for (const double position : {0.0, 0.3, 1.0}) {
      scene::LiveSettings settings;
      SetFromForm(row, position, settings);
      EXPECT_EQ(scene::ClampSettings(settings), settings) << row.label << " at " << position;
      EXPECT_NEAR(PositionInForm(row, settings),
                  row.scale.is_whole ? PositionInForm(row, settings) : position, 1e-9);
      for (const SettingRow& other : SettingRows()) {
        if (&other == &row) continue;
        EXPECT_EQ(other.get(settings), other.get(scene::LiveSettings{}))
            << row.label << " moved " << other.label;
      }
    }
    scene::LiveSettings low, high;
    SetFromForm(row, 0.0, low);
    SetFromForm(row, 1.0, high);
    EXPECT_LT(row.get(low), row.get(high)) << row.label;
  }
}

TEST(SettingsForm, OffersEverySetting) {
  std::set<std::string> labels;
  for (const SettingRow& row : SettingRows()) {
    EXPECT_TRUE(labels.insert(row.label).second);
    EXPECT_GT(std::string(row.tooltip).size(), 20u);
  }
  EXPECT_EQ(labels, (std::set<std::string>{"Stiffness", "Virtual springs", "Gravity", "Head up",
                                           "Right side up", "Iterations", "Tolerance"}));
  EXPECT_EQ(SolverChoices().size(), 3u);
}

TEST(SettingsForm, WritesValuesWithUnits) {
  scene::LiveSettings settings;
  EXPECT_EQ(FormatSetting(Row("Stiffness"), settings), "1.00 ×");
  EXPECT_EQ(FormatSetting(Row("Gravity"), settings), "9.81 m/s²");
  EXPECT_EQ(FormatSetting(Row("Iterations"), settings), "40");
  EXPECT_EQ(FormatSetting(Row("Tolerance"), settings), "1.0e-04");
  settings.head_up = 15 * 3.14159265358979 / 180;
  EXPECT_EQ(FormatSetting(Row("Head up"), settings), "15°");
  settings.head_up = -1e-9;
  EXPECT_EQ(FormatSetting(Row("Head up"), settings), "0°") << "no minus zero";
}

}  // namespace
}  // namespace trocar::presenter
