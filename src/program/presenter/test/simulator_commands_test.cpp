// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/simulator_commands.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "trocar/presenter/key_bindings.h"
#include "trocar_test/sound_commands.h"

namespace trocar::presenter {
namespace {

using device::Motion;

TEST(SimulatorCommands, AreSound) {
  test::ExpectSoundCommands(SimulatorCommands());
  test::ExpectWholeHelp(SimulatorCommands(), KeyBindings().Help());
}

TEST(SimulatorCommands, EveryMotionHasAKey) {
  std::set<Motion> reached;
  for (std::uint32_t key = 0; key < 0x10000; ++key) {
    const KeyMeaning meaning = FindKeyMeaning(key, false);
    EXPECT_EQ(meaning.action == Action::kMove, meaning.motion != Motion::kCount);
    if (meaning.action == Action::kMove) reached.insert(meaning.motion);
  }
  EXPECT_EQ(reached.size(), static_cast<std::size_t>(Motion::kCount));
}

TEST(SimulatorCommands, EveryActionHasAKeyOrAButton) {
  std::set<Action> reached{Action::kNone};
  for (const SimulatorCommand& command : SimulatorCommands()) {
    if (command.keys[0].key != 0 || command.button.side != gui::ButtonSide::kNone)
      reached.insert(command.action.action);
  }
  EXPECT_EQ(reached.size(), static_cast<std::size_t>(Action::kQuit) + 1);
}

TEST(SimulatorCommands, LettersWorkInEitherCase) {
  for (std::uint32_t letter = 'a'; letter <= 'z'; ++letter)
    EXPECT_EQ(FindKeyMeaning(letter, false), FindKeyMeaning(letter - 'a' + 'A', false));
}

TEST(SimulatorCommands, NamedKeysDoWhatTheHelpSays) {
  EXPECT_EQ(FindKeyMeaning(' ', false).action, Action::kTogglePause);
  EXPECT_EQ(FindKeyMeaning('r', false).action, Action::kReset);
  EXPECT_EQ(FindKeyMeaning(0xff09, false).action, Action::kSwitchHand);
  EXPECT_EQ(FindKeyMeaning('1', false).action, Action::kChooseLeft);
  EXPECT_EQ(FindKeyMeaning('2', false).action, Action::kChooseRight);
  EXPECT_EQ(FindKeyMeaning(0xffbe, false).action, Action::kToggleHelp);
  EXPECT_EQ(FindKeyMeaning(0xffc8, false).action, Action::kToggleFullscreen);
  EXPECT_EQ(FindKeyMeaning(0xff1b, false).action, Action::kReleasePointer);
  EXPECT_EQ(FindKeyMeaning('q', true).action, Action::kQuit);
  EXPECT_EQ(FindKeyMeaning('x', false).action, Action::kNextTool);
  EXPECT_EQ(FindKeyMeaning('v', false).action, Action::kHoldCut);
  EXPECT_EQ(FindKeyMeaning('n', false).action, Action::kHoldCoagulate);
  EXPECT_EQ(FindKeyMeaning('q', false), (KeyMeaning{Action::kMove, Motion::kSpinLeft}));
  EXPECT_EQ(FindKeyMeaning('r', true).action, Action::kNone) << "Ctrl+R is no reset";
}

TEST(SimulatorCommands, LeftHandedLettersChangePlaces) {
  std::set<std::uint32_t> reached;
  for (std::uint32_t key = 0; key < 0x10000; ++key) {
    const std::uint32_t mirrored = MirrorKey(key, KeyLayout::kLeftHanded);
    EXPECT_EQ(MirrorKey(key, KeyLayout::kRightHanded), key);
    if (key >= 'A' && key <= 'Z') continue;  // as the small letter
    EXPECT_EQ(MirrorKey(mirrored, KeyLayout::kLeftHanded), key);
    EXPECT_TRUE(reached.insert(mirrored).second) << key;
  }
  EXPECT_EQ(MirrorKey('q', KeyLayout::kLeftHanded), static_cast<std::uint32_t>('p'));
  EXPECT_EQ(MirrorKey('G', KeyLayout::kLeftHanded), static_cast<std::uint32_t>('h'));
  bool is_closing_right = false, has_spin = false;
  KeyBindings left_handed;
  left_handed.SetLayout(KeyLayout::kLeftHanded);
  for (const gui::KeyHelp& row : left_handed.Help()) {
    is_closing_right = is_closing_right || (row.keys.find("Right button") != std::string::npos &&
                                            row.meaning.find("close the jaws") != std::string::npos);
    has_spin = has_spin || (row.keys == "P   I" && row.meaning.find("spin") != std::string::npos);
  }
  EXPECT_TRUE(is_closing_right);
  EXPECT_TRUE(has_spin);
}

TEST(SimulatorCommands, EveryActOfAButtonIsAnActionOfItsOwn) {
  std::set<Action> actions;
  for (std::size_t i = 1; i < device::kActCount; ++i) {
    const Action action = FindAction(static_cast<device::HandAct>(i));
    EXPECT_NE(action, Action::kNone) << i;
    EXPECT_TRUE(actions.insert(action).second) << i;
  }
  EXPECT_EQ(FindAction(device::HandAct::kNone), Action::kNone);
  EXPECT_EQ(FindAction(device::HandAct::kCut), FindKeyMeaning('v', false).action);
  EXPECT_EQ(FindAction(device::HandAct::kClutch), FindKeyMeaning(',', false).action);
}

TEST(SimulatorCommands, PanelKeepsTheKeysThatSlidersNeed) {
  EXPECT_FALSE(WorksInPanel(Action::kMove));
  EXPECT_FALSE(WorksInPanel(Action::kSwitchHand));
  EXPECT_FALSE(WorksInPanel(Action::kTogglePause)) << "Space presses the focused button there";
  EXPECT_TRUE(WorksInPanel(Action::kQuit));
  EXPECT_TRUE(WorksInPanel(Action::kReleasePointer));
}

TEST(SimulatorCommands, HelpNamesEveryKeyThatActs) {
  std::string all;
  for (const gui::KeyHelp& row : KeyBindings().Help()) all += " " + row.keys + " ";
  for (std::uint32_t key = 'a'; key <= 'z'; ++key) {
    const std::string name(1, static_cast<char>(key - 'a' + 'A'));
    const bool is_named = all.find(" " + name + " ") != std::string::npos;
    EXPECT_EQ(is_named, FindKeyMeaning(key, false).action != Action::kNone) << name;
  }
  for (const char* name : {"Space", "Tab", "Comma", "Esc", "F1", "F6", "F11", "Ctrl+Q", "Arrows", "Wheel"})
    EXPECT_NE(all.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace trocar::presenter
