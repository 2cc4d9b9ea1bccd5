// SPDX-License-Identifier: Apache-2.0
/// \file sound_commands.h  What must hold for each window's table of commands.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <span>
#include <string>
#include <vector>

#include "trocar/gui/command.h"

namespace trocar::test {

/// Each command has its own id and keys, and buttons say what they do.
template <typename Action, typename Needs>
void ExpectSoundCommands(std::span<const gui::Command<Action, Needs>> commands) {
  std::set<std::string> ids;
  for (const auto& command : commands) {
    const std::string id = command.id;
    EXPECT_TRUE(id.empty() || ids.insert(id).second) << id << " twice";
    EXPECT_EQ(id.empty(), command.action == Action{}) << id << command.help.meaning;
    for (const auto* strokes : {&command.keys, &command.also}) {
      for (const gui::KeyStroke& stroke : *strokes) {
        if (stroke.key == 0) continue;
        EXPECT_EQ(FindCommand(commands, stroke.key, stroke.control, stroke.shift), &command)
            << id << ": " << KeyText(stroke) << " has two meanings";
      }
    }
    if (command.button.side == gui::ButtonSide::kNone) continue;
    EXPECT_STRNE(command.button.label, "") << id;
    EXPECT_STRNE(command.button.tip, "") << id;
  }
}

/// The help page names every key.
template <typename Action, typename Needs>
void ExpectWholeHelp(std::span<const gui::Command<Action, Needs>> commands,
                     const std::vector<gui::KeyHelp>& help) {
  std::string all;
  for (const gui::KeyHelp& row : help) {
    EXPECT_FALSE(row.keys.empty()) << row.meaning;
    EXPECT_FALSE(row.meaning.empty()) << row.keys;
    all += "   " + row.keys + "   ";
  }
  for (const auto& command : commands) {
    for (const gui::KeyStroke& stroke : command.keys) {
      if (stroke.key == 0) continue;
      EXPECT_NE(all.find("   " + KeyText(stroke) + "   "), std::string::npos)
          << command.id << ": the help does not name " << KeyText(stroke);
    }
  }
}

}  // namespace trocar::test
