// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/command.h"

#include <gtest/gtest.h>

namespace trocar::gui {
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

}  // namespace
}  // namespace trocar::gui
