// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_commands.h"

#include <gtest/gtest.h>

#include "trocar/editor/patient_commands.h"
#include "trocar_test/sound_commands.h"

namespace trocar::editor {
namespace {

TEST(ContourCommands, AreSound) {
  test::ExpectSoundCommands(ContourCommands());
  test::ExpectWholeHelp(ContourCommands(), ContourHelp());
}

TEST(PatientCommands, AreSound) {
  test::ExpectSoundCommands(PatientCommands());
}

TEST(PatientCommands, AreFoundByTheirKeys) {
  EXPECT_EQ(FindPatientAction('Z', true, true), PatientAction::kRedo);
  EXPECT_EQ(FindPatientAction('y', true, false), PatientAction::kRedo);
  EXPECT_EQ(FindPatientAction('2', false, false), PatientAction::kPaint);
  EXPECT_EQ(FindPatientAction('E', false, false), PatientAction::kToggleErase);
  EXPECT_EQ(FindPatientAction(gui::key::kBackSpace, false, false), PatientAction::kDeletePoint);
  EXPECT_EQ(FindPatientAction('x', false, false), PatientAction::kNone);
  EXPECT_EQ(FindNeeds(PatientAction::kSave), PatientNeeds::kUnsaved);
}

TEST(ContourKeys, TheHelpNamesWhatTheKeysDo) {
  EXPECT_EQ(FindContourAction('z', true, false), ContourAction::kUndo);
  EXPECT_EQ(FindContourAction('Z', true, true), ContourAction::kRedo);
  EXPECT_EQ(FindContourAction('P', false, true), ContourAction::kPropagateBack);
  EXPECT_EQ(FindContourAction('s', false, false), ContourAction::kToggleScissors);
  EXPECT_EQ(FindContourAction('s', true, false), ContourAction::kSave);
  EXPECT_EQ(FindContourAction(0xffff, false, false), ContourAction::kDelete);
  EXPECT_EQ(FindContourAction('x', false, false), ContourAction::kNone);
  EXPECT_FALSE(WorksEverywhere(ContourAction::kUndo)) << "a text field has its own";
  EXPECT_TRUE(WorksEverywhere(ContourAction::kSave));
  EXPECT_GT(ContourHelp().size(), 15u);
}

}  // namespace
}  // namespace trocar::editor
