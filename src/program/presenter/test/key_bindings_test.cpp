// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/key_bindings.h"

#include <gtest/gtest.h>

#include <string>

namespace trocar::presenter {
namespace {

using device::Motion;

const SimulatorCommand& Find(const std::string& id) {
  for (const SimulatorCommand& command : SimulatorCommands()) {
    if (id == command.id) return command;
  }
  ADD_FAILURE() << id;
  return SimulatorCommands()[0];
}

TEST(KeyBindings, AreTheTablesAtFirst) {
  const KeyBindings bindings;
  for (std::uint32_t key = 0; key < 0x10000; ++key)
    EXPECT_EQ(bindings.Find(key, false), FindKeyMeaning(key, false)) << key;
  for (const SimulatorCommand& command : SimulatorCommands())
    EXPECT_EQ(bindings.ConflictOf(command), "") << command.id;
  EXPECT_EQ(bindings.GetOwn(), KeyBindings::Own());
}

TEST(KeyBindings, AnOwnKeyTakesThePlaceOfTheTables) {
  KeyBindings bindings;
  ASSERT_TRUE(bindings.SetKey("close-jaws", ';').ok());
  EXPECT_EQ(bindings.Find(';', false), (KeyMeaning{Action::kMove, Motion::kCloseJaw}));
  EXPECT_EQ(bindings.Find('g', false).action, Action::kNone) << "the former key is free";
  EXPECT_EQ(bindings.Fill("Hold {close-jaws}"), "Hold ;");
  EXPECT_EQ(bindings.Find('q', true).action, Action::kQuit) << "Ctrl stays as it is";
  bindings.Restore("close-jaws");
  EXPECT_EQ(bindings.Find('g', false), (KeyMeaning{Action::kMove, Motion::kCloseJaw}));
}

TEST(KeyBindings, AConflictIsSaidOnBothSides) {
  KeyBindings bindings;
  ASSERT_TRUE(bindings.SetKey("close-jaws", 'B').ok());  // which opens them
  EXPECT_EQ(bindings.Find('b', false), (KeyMeaning{Action::kMove, Motion::kCloseJaw}));
  EXPECT_NE(bindings.ConflictOf(Find("close-jaws")).find("The same key as: open the jaws"), std::string::npos)
      << bindings.ConflictOf(Find("close-jaws"));
  EXPECT_NE(bindings.ConflictOf(Find("open-jaws")).find("Without a key now, which does: close the jaws"),
            std::string::npos)
      << bindings.ConflictOf(Find("open-jaws"));
  ASSERT_TRUE(bindings.SetKey("open-jaws", 'g').ok());
  EXPECT_EQ(bindings.ConflictOf(Find("close-jaws")), "");
  EXPECT_EQ(bindings.ConflictOf(Find("open-jaws")), "");
}

TEST(KeyBindings, RefuseWhatWouldLockSomebodyOut) {
  KeyBindings bindings;
  EXPECT_FALSE(bindings.SetKey("release-pointer", 'm').ok()) << "Esc always takes the force away";
  EXPECT_FALSE(bindings.SetKey("close-jaws", gui::key::kEscape).ok());
  EXPECT_FALSE(bindings.SetKey("close-jaws", gui::key::kF1).ok()) << "always the help";
  EXPECT_FALSE(bindings.SetKey("close-jaws", 0xffe1).ok()) << "Shift";
  EXPECT_FALSE(bindings.SetKey("quit", 'm').ok());
  EXPECT_FALSE(bindings.SetKey("no-command", 'm').ok());
  EXPECT_EQ(bindings.GetOwn(), KeyBindings::Own());
}

TEST(KeyBindings, ButtonsChangePlaces) {
  KeyBindings bindings;
  bindings.SetButton(ButtonAct::kLook, MouseButton::kRight);
  EXPECT_EQ(bindings.ButtonOf(ButtonAct::kLook), MouseButton::kRight);
  EXPECT_EQ(bindings.ButtonOf(ButtonAct::kOpenJaws), MouseButton::kMiddle) << "which looked round";
  EXPECT_EQ(bindings.ActOf(MouseButton::kLeft), ButtonAct::kCloseJaws);
  EXPECT_EQ(bindings.Fill("{button:open} opens, {button:look} looks"), "middle opens, right looks");
}

TEST(KeyBindings, ComeBackAsTheyWereKept) {
  KeyBindings bindings, again;
  ASSERT_TRUE(bindings.SetKey("in", gui::key::kPageUp).ok());
  ASSERT_TRUE(bindings.SetKey("run", 0xffbf).ok());
  bindings.SetButton(ButtonAct::kCloseJaws, MouseButton::kRight);
  const KeyBindings::Own own = bindings.GetOwn();
  EXPECT_EQ(own.keys.at("in"), "Page Up");
  EXPECT_EQ(own.keys.at("run"), "F2");
  EXPECT_TRUE(again.Use(own).empty());
  EXPECT_EQ(again.GetOwn(), own);
  EXPECT_EQ(again.Find(0xffbf, false).action, Action::kTogglePause);
}

TEST(KeyBindings, WhatCannotBeUsedIsNamed) {
  KeyBindings bindings;
  KeyBindings::Own own;
  own.keys = {{"close-jaws", "Hyper"}, {"nonsense", "m"}, {"open-jaws", "m"}};
  own.buttons = {{"close", "fourth"}};
  EXPECT_EQ(bindings.Use(own).size(), 3u);
  EXPECT_EQ(bindings.Find('m', false), (KeyMeaning{Action::kMove, Motion::kOpenJaw})) << "the rest holds";
  own = {{}, {{"close", "right"}, {"open", "right"}}};
  EXPECT_EQ(bindings.Use(own).size(), 1u) << "one button with two acts";
  EXPECT_EQ(bindings.ButtonOf(ButtonAct::kCloseJaws), MouseButton::kLeft);
}

}  // namespace
}  // namespace trocar::presenter
