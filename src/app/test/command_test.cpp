// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/command.h"

#include <gtest/gtest.h>

#include <set>

#include "trocar/app/contour_commands.h"
#include "trocar/app/simulator_commands.h"

namespace trocar::app {
namespace {

enum class Toy { kNone, kSave, kOpen, kQuit };
enum class ToyNeeds { kNothing };
using ToyCommand = Command<Toy, ToyNeeds>;

constexpr ToyCommand kToys[] = {
    {.id = "save",
     .action = Toy::kSave,
     .keys = {{Ctrl('s')}},
     .also = {{{key::kF1}}},
     .help = {"File", "", "save"}},
    {.id = "open", .action = Toy::kOpen, .keys = {{CtrlShift('o')}}, .help = {"", "Click", "open"}},
    {.id = "quit", .action = Toy::kQuit, .keys = {{{key::kEscape}}}, .help = {"End", "", "quit"}}};

const ToyCommand* Find(std::uint32_t key, bool control, bool shift) {
  return FindCommand(std::span<const ToyCommand>(kToys), key, control, shift);
}

TEST(FindCommand, NeedsTheModifiersOfItsRow) {
  ASSERT_NE(Find('S', true, false), nullptr);
  EXPECT_EQ(Find('s', true, false)->action, Toy::kSave);
  EXPECT_EQ(Find(key::kF1, false, false)->action, Toy::kSave);
  EXPECT_EQ(Find('s', false, false), nullptr);
  EXPECT_EQ(Find('s', true, true), nullptr);
  EXPECT_EQ(Find(0, false, false), nullptr) << "rows without a key";
}

TEST(MakeKeyHelp, JoinsRowsAndSortsGroups) {
  constexpr const char* kGroups[] = {"End", "File"};
  const auto rows = MakeKeyHelp(std::span<const ToyCommand>(kToys), kGroups);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].keys, "Esc");
  EXPECT_EQ(rows[1].keys, "Ctrl+S   Click   Ctrl+Shift+O");
  EXPECT_EQ(rows[1].meaning, "save, open");
}

TEST(TipText, NamesTheKeys) {
  EXPECT_EQ(TipText("Save", kToys[0].keys), "Save (Ctrl+S)");
  EXPECT_EQ(TipText("Save", {}), "Save");
}

// One table a window: what the keys do, the header bar offers and the help page says cannot differ.
template <typename Action, typename Needs>
void ExpectSound(std::span<const Command<Action, Needs>> commands, const std::vector<KeyHelp>& help) {
  std::set<std::string> ids;
  std::string all;
  for (const KeyHelp& row : help) {
    EXPECT_FALSE(row.keys.empty()) << row.meaning;
    EXPECT_FALSE(row.meaning.empty()) << row.keys;
    all += "   " + row.keys + "   ";
  }
  for (const auto& command : commands) {
    const std::string id = command.id;
    if (!id.empty()) EXPECT_TRUE(ids.insert(id).second) << id << " twice";
    EXPECT_EQ(id.empty(), command.action == Action{}) << id << command.help.meaning;
    for (const auto* strokes : {&command.keys, &command.also}) {
      for (const KeyStroke& stroke : *strokes) {
        if (stroke.key == 0) continue;
        EXPECT_EQ(FindCommand(commands, stroke.key, stroke.control, stroke.shift), &command)
            << id << ": " << KeyText(stroke) << " has two meanings";
      }
    }
    for (const KeyStroke& stroke : command.keys) {
      if (stroke.key == 0) continue;
      EXPECT_NE(all.find("   " + KeyText(stroke) + "   "), std::string::npos)
          << id << ": the help does not name " << KeyText(stroke);
    }
    if (command.button.side == ButtonSide::kNone) continue;
    EXPECT_STRNE(command.button.label, "") << id;
    EXPECT_STRNE(command.button.tip, "") << id;
  }
}

TEST(Commands, OfTheSimulatorAreSound) {
  ExpectSound(SimulatorCommands(), SimulatorHelp());
}
TEST(Commands, OfTheContourWindowAreSound) {
  ExpectSound(ContourCommands(), ContourHelp());
}

}  // namespace
}  // namespace trocar::app
