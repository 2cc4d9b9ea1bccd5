// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/replay_commands.h"

namespace trocar::presenter {
namespace {

using gui::ButtonSide;
using gui::Ctrl;
namespace key = gui::key;

using enum ReplayNeeds;
using Do = ReplayAction;

// One row a command. A row without a group goes on with the help's line before it.
constexpr ReplayCommand kCommands[] = {
    {.help = {"Time", "Drag on the bar", "go to any moment"}},
    {.id = "play",
     .action = Do::kTogglePlay,
     .needs = kReplay,
     .keys = {{{' '}}},
     .help = {"Time", "", "play or pause"},
     .button = {ButtonSide::kStart, "Play", "Play or pause", false, true, 84}},
    {.id = "slower",
     .action = Do::kSlower,
     .needs = kReplay,
     .keys = {{{'-'}}},
     .also = {{{key::kPadMinus}}},
     .help = {"Time", "", "slower"},
     .button = {ButtonSide::kStart, "−", "Slower, down to a quarter"}},
    {.id = "faster",
     .action = Do::kFaster,
     .needs = kReplay,
     .keys = {{{'+'}}},
     .also = {{{key::kPadPlus}, {'='}}},
     .help = {"", "", "faster"},
     .button = {ButtonSide::kStart, "+", "Faster, up to eight times"}},
    {.id = "back",
     .action = Do::kBack,
     .needs = kReplay,
     .keys = {{{key::kLeft}}},
     .help = {"Time", "", "a second back"}},
    {.id = "on", .action = Do::kOn, .needs = kReplay, .keys = {{{key::kRight}}}, .help = {"", "", "on"}},
    {.id = "back-far",
     .action = Do::kBackFar,
     .needs = kReplay,
     .keys = {{{key::kPageUp}}},
     .help = {"Time", "", "ten seconds back"}},
    {.id = "on-far",
     .action = Do::kOnFar,
     .needs = kReplay,
     .keys = {{{key::kPageDown}}},
     .help = {"", "", "on"}},
    {.id = "to-begin",
     .action = Do::kToBegin,
     .needs = kReplay,
     .keys = {{{key::kHome}}},
     .help = {"Time", "", "to the beginning"}},
    {.id = "to-end",
     .action = Do::kToEnd,
     .needs = kReplay,
     .keys = {{{key::kEnd}}},
     .help = {"", "", "to the end"}},
    {.id = "previous-mark",
     .action = Do::kPreviousMark,
     .needs = kReplay,
     .keys = {{{'p'}}},
     .help = {"Time", "", "to the error, phase or remark before"},
     .button = {ButtonSide::kStart, "◂ Mark", "To the error, phase or remark before this moment", false,
                false, true}},
    {.id = "next-mark",
     .action = Do::kNextMark,
     .needs = kReplay,
     .keys = {{{'n'}}},
     .help = {"", "", "to the next one"},
     .button = {ButtonSide::kStart, "Mark ▸", "To the next error, phase or remark"}},
    {.id = "take-over",
     .action = Do::kTakeOver,
     .needs = kReplay,
     .keys = {{{'t'}}},
     .help = {"Other hands", "", "take over here: operate on from this moment"},
     .button = {ButtonSide::kStart, "Take over here",
                "Operate on from this moment, in a recording of your own"}},
    {.id = "what-if",
     .action = Do::kWhatIf,
     .needs = kExpert,
     .keys = {{{'e'}}},
     .help = {"Other hands", "", "what if: the expert goes on from this moment"},
     .button = {ButtonSide::kStart, "What if", "The scripted expert goes on from this moment"}},
    {.id = "beside",
     .action = Do::kToggleList,
     .needs = kReplay,
     .keys = {{{'b'}}},
     .help = {"View", "", "another recording beside this one"},
     .button = {ButtonSide::kStart, "Beside", "Show another recording beside this one"}},
    {.id = "close-beside",
     .action = Do::kCloseBeside,
     .needs = kBeside,
     .keys = {{{'x'}}},
     .help = {"", "", "away with it"}},
    {.help = {"View", "Drag the picture",
              "turn the free camera; with the right button move it; the wheel goes nearer"}},
    {.id = "camera",
     .action = Do::kToggleCamera,
     .needs = kReplay,
     .keys = {{{'c'}}},
     .help = {"View", "", "free camera, or as recorded"},
     .button = {ButtonSide::kEnd, "Free camera", "Look from where you like; off: as recorded", true}},
    {.id = "ghosts",
     .action = Do::kToggleGhosts,
     .keys = {{{'g'}}},
     .help = {"View", "", "ways of the tips, and ghosts of the other attempt's tools"},
     .button = {ButtonSide::kEnd, "Ghosts",
                "Ways of both tips in the last seconds; beside another recording, its tools, too", true}},
    {.id = "forces",
     .action = Do::kToggleForces,
     .keys = {{{'f'}}},
     .help = {"View", "", "force arrows"},
     .button = {ButtonSide::kEnd, "Forces", "Arrows for the forces on the instruments", true}},
    {.id = "picture",
     .action = Do::kSavePicture,
     .needs = kReplay,
     .keys = {{Ctrl('s')}},
     .help = {"View", "", "save the picture"}},
    {.id = "clip",
     .action = Do::kSaveClip,
     .needs = kReplay,
     .keys = {{Ctrl('m')}},
     .help = {"View", "", "save a video of the minute before this moment"}},
    {.id = "video",
     .action = Do::kSaveVideo,
     .needs = kReplay,
     .keys = {{'v'}},
     .help = {"View", "", "save a video of the whole recording"},
     .button = {ButtonSide::kEnd, "Video", "Save a video (WebM) of the whole recording"}},
    {.id = "fullscreen",
     .action = Do::kToggleFullscreen,
     .keys = {{{key::kF11}}},
     .help = {"View", "", "full screen"}},
    {.id = "help",
     .action = Do::kToggleHelp,
     .keys = {{{'h'}, {key::kF1}}},
     .help = {"View", "", "this help"},
     .button = {ButtonSide::kEnd, "Help", "All keys", true}},
    {.id = "close-cards",
     .action = Do::kCloseCards,
     .keys = {{{key::kEscape}}},
     .help = {"View", "", "close what lies over the picture"}},
    {.id = "close",
     .action = Do::kClose,
     .keys = {{Ctrl('q'), Ctrl('w')}},
     .help = {"View", "", "close the window"}},
};

}  // namespace

std::span<const ReplayCommand> ReplayCommands() noexcept {
  return kCommands;
}

std::vector<gui::KeyHelp> ReplayHelp() {
  constexpr const char* kGroups[] = {"Time", "Other hands", "View"};
  return MakeKeyHelp(ReplayCommands(), kGroups);
}

ReplayNeeds FindNeeds(ReplayAction action) noexcept {
  const ReplayCommand* command = FindCommand(ReplayCommands(), action);
  return command == nullptr ? kNothing : command->needs;
}

}  // namespace trocar::presenter
