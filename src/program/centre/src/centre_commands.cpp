// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/centre_commands.h"

namespace trocar::centre {
namespace {

using gui::ButtonSide;
using gui::Ctrl;
namespace key = gui::key;

using enum CentreNeeds;
using Do = CentreAction;

// One row a command. A row without a group goes on with the help's line before it.
constexpr CentreCommand kCommands[] = {
    {.id = "result",
     .action = Do::kShowResult,
     .needs = kResult,
     .keys = {{Ctrl('1')}},
     .help = {"Pages", "", "result of the attempt"},
     .button = {ButtonSide::kStart, "Result", "What the attempt came to", true}},
    {.id = "history",
     .action = Do::kShowHistory,
     .keys = {{Ctrl('2')}},
     .help = {"Pages", "", "history: attempts, and how somebody learns"},
     .button = {ButtonSide::kStart, "History", "Attempts, and how somebody learns", true}},
    {.id = "courses",
     .action = Do::kShowCourses,
     .keys = {{Ctrl('3')}},
     .help = {"Pages", "", "courses: steps that are done, open and locked"},
     .button = {ButtonSide::kStart, "Courses", "Steps that are done, open and locked", true}},
    {.id = "group",
     .action = Do::kShowGroup,
     .needs = kInstructor,
     .keys = {{Ctrl('4')}},
     .help = {"Pages", "", "group: members and tasks, for instructors"},
     .button = {ButtonSide::kStart, "Group", "Members and tasks, for instructors", true}},
    {.id = "exam",
     .action = Do::kShowExam,
     .keys = {{Ctrl('5')}},
     .help = {"Pages", "", "exam: sealed settings, a signed certificate"},
     .button = {ButtonSide::kStart, "Exam", "Sealed settings, a signed certificate", true}},
    {.id = "who",
     .action = Do::kWho,
     .keys = {{Ctrl('n')}},
     .help = {"People", "", "who are you: a name, or nothing"},
     .button = {ButtonSide::kEnd, "Who are you?", "A name, or nothing: attempts from now on are yours",
                true}},
    {.id = "reload",
     .action = Do::kReload,
     .keys = {{Ctrl('r')}},
     .help = {"Window", "", "read the page anew"},
     .button = {ButtonSide::kEnd, "Reload", "Read the page anew"}},
    {.id = "help",
     .action = Do::kToggleHelp,
     .keys = {{{key::kF1}}},
     .help = {"Window", "", "this help"},
     .button = {ButtonSide::kEnd, "Help", "All keys", true}},
    {.id = "close-cards",
     .action = Do::kCloseCards,
     .keys = {{{key::kEscape}}},
     .help = {"Window", "", "close what lies over the page"}},
    {.id = "close",
     .action = Do::kClose,
     .keys = {{Ctrl('w')}},
     .help = {"Window", "", "close the window"},
     .button = {ButtonSide::kEnd, "Close", "Close the window"}},
};

}  // namespace

std::span<const CentreCommand> CentreCommands() noexcept {
  return kCommands;
}

std::vector<gui::KeyHelp> CentreHelp() {
  constexpr const char* kGroups[] = {"Pages", "People", "Window"};
  return MakeKeyHelp(CentreCommands(), kGroups);
}

}  // namespace trocar::centre
