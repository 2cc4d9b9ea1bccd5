// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/simulator_commands.h"

#include <string_view>

namespace trocar::presenter {
namespace {

using device::Motion;
using gui::ButtonSide;
using gui::Ctrl;
namespace key = gui::key;

using enum SimulatorNeeds;

constexpr KeyMeaning Move(Motion motion) {
  return {Action::kMove, motion};
}
constexpr KeyMeaning Do(Action action) {
  return {action, Motion::kCount};
}

// One row a command. A row without a group goes on with the help's line before it.
constexpr SimulatorCommand kCommands[] = {
    {.help = {"Instruments", "Click", "take the instruments with the mouse"}},
    {.id = "release-pointer",
     .action = Do(Action::kReleasePointer),
     .keys = {{{key::kEscape}}},
     .help = {"Instruments", "", "give the mouse back"},
     .works_everywhere = true},
    {.id = "left-hand",
     .action = Do(Action::kChooseLeft),
     .needs = kScene,
     .keys = {{{'1'}}},
     .also = {{{key::kPad1}}},
     .help = {"Instruments", "", "left hand"}},
    {.id = "right-hand",
     .action = Do(Action::kChooseRight),
     .needs = kScene,
     .keys = {{{'2'}}},
     .also = {{{key::kPad2}}},
     .help = {"", "", "right hand"}},
    {.id = "other-hand",
     .action = Do(Action::kSwitchHand),
     .needs = kScene,
     .keys = {{{key::kTab}}},
     .also = {{{key::kIsoLeftTab}}},
     .help = {"", "", "the other hand"}},
    {.help = {"Instruments", "Mouse", "move the tip in the picture"}},
    {.id = "in",
     .action = Move(Motion::kIn),
     .keys = {{{'i'}}},
     .also = {{{key::kPageUp}}},
     .help = {"Instruments", "Wheel", "tip into the picture"}},
    {.id = "out",
     .action = Move(Motion::kOut),
     .keys = {{{'o'}}},
     .also = {{{key::kPageDown}}},
     .help = {"", "", "back out"}},
    {.id = "up",
     .action = Move(Motion::kUp),
     .keys = {{{'w'}}},
     .also = {{{key::kUp}}},
     .help = {"Instruments", "Arrows", "move the tip with the keyboard"}},
    {.id = "left", .action = Move(Motion::kLeft), .keys = {{{'a'}}}, .also = {{{key::kLeft}}}},
    {.id = "down", .action = Move(Motion::kDown), .keys = {{{'s'}}}, .also = {{{key::kDown}}}},
    {.id = "right", .action = Move(Motion::kRight), .keys = {{{'d'}}}, .also = {{{key::kRight}}}},
    {.id = "close-jaws",
     .action = Move(Motion::kCloseJaw),
     .keys = {{{'g'}}},
     .help = {"Instruments", "Left button", "close the jaws (hold)"}},
    {.id = "open-jaws",
     .action = Move(Motion::kOpenJaw),
     .keys = {{{'b'}}},
     .help = {"Instruments", "Right button", "open the jaws (hold)"}},
    {.id = "spin-left",
     .action = Move(Motion::kSpinLeft),
     .keys = {{{'q'}}},
     .help = {"Instruments", "", "spin the instrument (hold)"}},
    {.id = "spin-right", .action = Move(Motion::kSpinRight), .keys = {{{'e'}}}},
    {.id = "home",
     .action = Do(Action::kOpenHome),
     .needs = kNoFailure,
     .keys = {{{key::kHome}}},
     .help = {"View", "", "home page: what you can train"},
     .button = {ButtonSide::kStart, "Home", "What you can train, your results, and who you are"}},
    {.id = "tasks",
     .action = Do(Action::kToggleTaskList),
     .needs = kNoFailure,
     .keys = {{Ctrl('o')}},
     .help = {"View", "", "training tasks and operations"},
     .button = {ButtonSide::kStart, "Tasks", "Choose a training task or an operation"}},
    {.id = "recordings",
     .action = Do(Action::kToggleRecordingList),
     .needs = kNoFailure,
     .keys = {{Ctrl('l')}},
     .help = {"View", "", "recordings: watch an attempt again, take over where you like"}},
    {.id = "patients",
     .action = Do(Action::kTogglePatientList),
     .needs = kNoFailure,
     .keys = {{Ctrl('p')}},
     .help = {"View", "", "patients: who is operated on, new ones"}},
    {.id = "keys",
     .action = Do(Action::kToggleKeyList),
     .needs = kNoFailure,
     .keys = {{Ctrl('k')}},
     .help = {"View", "", "keys and buttons: what they do, and how to change it"}},
    {.id = "run",
     .action = Do(Action::kTogglePause),
     .needs = kScene,
     .keys = {{{' '}}},
     .help = {"Simulation", "", "start or pause"},
     .button = {ButtonSide::kStart, "Start", "Start or pause the simulation", false, true, 84}},
    {.id = "finish",
     .action = Do(Action::kFinish),
     .needs = kScene,
     .keys = {{Ctrl('e')}},
     .help = {"Simulation", "", "finish the attempt and see its result"},
     .button = {ButtonSide::kStart, "Finish", "The attempt is over: see its result"}},
    {.id = "reset",
     .action = Do(Action::kReset),
     .needs = kGuidance,
     .keys = {{{'r'}}},
     .help = {"Simulation", "", "reset"},
     .button = {ButtonSide::kStart, "Reset", "Back to the beginning"}},
    {.id = "demonstration",
     .action = Do(Action::kToggleDemonstration),
     .needs = kScript,
     .keys = {{{'p'}}},
     .help = {"Simulation", "", "play the demonstration, or take over from it"},
     .button = {ButtonSide::kStart, "Demonstration",
                "The script of the scene moves both hands; press again to take over", true}},
    {.id = "real-trocar",
     .action = Do(Action::kToggleFulcrum),
     .keys = {{{'t'}}},
     .help = {"Instruments", "", "real trocar: the mouse is the handle, the tip goes the other way"}},
    {.id = "depth-snap",
     .action = Do(Action::kToggleDepthSnap),
     .keys = {{{'8'}}},
     .help = {"Instruments", "", "the wheel stops where the tip meets something, or goes on"}},
    {.id = "slow-motion",
     .action = Do(Action::kToggleSlowMotion),
     .needs = kHelp,
     .keys = {{{'4'}}},
     .help = {"Simulation", "", "slow motion, for practice: such an attempt is not kept"}},
    {.id = "left-handed",
     .action = Do(Action::kToggleLeftHanded),
     .keys = {{{'5'}}},
     .help = {"Instruments", "", "left-handed: mouse buttons and letters change sides"}},
    {.id = "check-pose",
     .action = Do(Action::kCheckPose),
     .needs = kHaptics,
     .button = {ButtonSide::kStart, "Check pose", "Confirm which haptic device is which hand"}},
    {.id = "force-feedback",
     .action = Do(Action::kToggleForceFeedback),
     .needs = kHaptics,
     .button = {ButtonSide::kStart, "Force",
                "Force feedback of the haptic device: asks for it, or takes it away (Esc takes it away, too)",
                true}},
    {.id = "next-tool",
     .action = Do(Action::kNextTool),
     .needs = kScene,
     .keys = {{{'x'}}},
     .help = {"Operation", "", "next tool"}},
    {.id = "previous-tool",
     .action = Do(Action::kPreviousTool),
     .needs = kScene,
     .keys = {{{'z'}}},
     .help = {"", "", "previous tool of this hand"}},
    {.id = "cut",
     .action = Do(Action::kHoldCut),
     .needs = kScene,
     .keys = {{{'v'}}},
     .help = {"Operation", "", "yellow pedal: cut"}},
    {.id = "coagulate",
     .action = Do(Action::kHoldCoagulate),
     .needs = kScene,
     .keys = {{{'n'}}},
     .help = {"", "", "blue pedal: coagulate (hold)"}},
    {.id = "rinse",
     .action = Do(Action::kHoldRinse),
     .needs = kScene,
     .keys = {{{'j'}}},
     .help = {"Operation", "", "rinse"}},
    {.id = "aspirate",
     .action = Do(Action::kHoldAspirate),
     .needs = kScene,
     .keys = {{{'k'}}},
     .help = {"", "", "suck (hold)"}},
    {.id = "clutch",
     .action = Do(Action::kHoldClutch),
     .needs = kScene,
     .keys = {{{','}}},
     .help = {"Operation", "", "clutch (hold)"}},
    {.id = "freeze",
     .action = Do(Action::kFreeze),
     .needs = kScene,
     .keys = {{{'y'}}},
     .help = {"", "", "freeze: the tool stands still although its device moves"}},
    {.id = "assistant",
     .action = Do(Action::kAssistant),
     .needs = kScene,
     .keys = {{{'u'}}},
     .help = {"Operation", "", "assistant: take and lift the fundus, relax, let go, wait"}},
    {.id = "hold-laparoscope",
     .action = Do(Action::kHoldLaparoscope),
     .needs = kScene,
     .keys = {{{'c'}}},
     .help = {"Laparoscope", "Middle button",
              "hold, then move the mouse to look around, wheel to go in and out"}},
    {.id = "camera-holder",
     .action = Do(Action::kToggleCameraHolder),
     .needs = kGuidance,
     .keys = {{{'l'}}},
     .help = {"Laparoscope", "", "automatic holder: keeps both tips in the picture; C takes over"}},
    {.id = "centre",
     .action = Do(Action::kOpenCentre),
     .keys = {{Ctrl('t')}},
     .help = {"View", "", "training centre: history, courses, group, exams"},
     .button = {ButtonSide::kEnd, "Training", "History, courses, groups, exams"}},
    {.id = "tutorial",
     .action = Do(Action::kToggleTutorial),
     .needs = kGuidance,
     .keys = {{{'7'}}},
     .help = {"View", "", "tutorial: each control by doing it; again leaves it"},
     .button = {ButtonSide::kEnd, "Tutorial", "Learn each control by doing it", true}},
    {.id = "guides",
     .action = Do(Action::kToggleGuides),
     .needs = kHelp,
     .keys = {{{'3'}}},
     .help = {"View", "", "guides: lines that show depth, rings round what is next"},
     .button = {ButtonSide::kEnd, "Guides",
                "Lines from the tips to what lies below, and rings round what comes next", true}},
    {.id = "panel",
     .action = Do(Action::kTogglePanel),
     .needs = kGuidance,
     .keys = {{{'6'}}},
     .help = {"View", "", "numbers and settings beside the picture"},
     .button = {ButtonSide::kEnd, "Numbers", "Forces, measures and the settings of the simulation", true}},
    {.id = "devices",
     .action = Do(Action::kOpenDevices),
     .needs = kScene,
     .keys = {{Ctrl('d')}},
     .help = {"View", "", "devices: find, try and calibrate what holds the instruments"}},
    {.id = "forces",
     .action = Do(Action::kToggleForces),
     .needs = kGuidance,
     .keys = {{{'f'}}},
     .help = {"View", "", "force arrows"}},
    {.id = "mask",
     .action = Do(Action::kToggleMask),
     .keys = {{{'m'}}},
     .help = {"View", "", "round mask of the laparoscope"}},
    {.id = "picture",
     .action = Do(Action::kSavePicture),
     .needs = kScene,
     .keys = {{Ctrl('s')}},
     .help = {"View", "", "save the picture"}},
    {.id = "clip",
     .action = Do(Action::kSaveClip),
     .needs = kScene,
     .keys = {{Ctrl('m')}},
     .help = {"View", "", "save a video of the last minute"}},
    {.id = "sound",
     .action = Do(Action::kToggleSound),
     .keys = {{{'0'}}},
     .help = {"View", "", "sound: on, off"}},
    {.id = "quieter", .action = Do(Action::kQuieter), .keys = {{{'-'}}}, .help = {"", "", "quieter"}},
    {.id = "louder",
     .action = Do(Action::kLouder),
     .keys = {{{'='}}},
     .also = {{{'+'}}},
     .help = {"", "", "louder"}},
    {.id = "speech",
     .action = Do(Action::kToggleSpeech),
     .keys = {{{'9'}}},
     .help = {"View", "", "speech: what to do is said aloud, or not"}},
    {.id = "fullscreen",
     .action = Do(Action::kToggleFullscreen),
     .keys = {{{key::kF11}}},
     .help = {"View", "", "full screen"},
     .works_everywhere = true},
    {.id = "switch-pane",
     .action = Do(Action::kSwitchPane),
     .keys = {{{key::kF6}}},
     .help = {"View", "", "between picture and panel"},
     .works_everywhere = true},
    {.id = "help",
     .action = Do(Action::kToggleHelp),
     .keys = {{{'h'}, {key::kF1}}},
     .help = {"View", "", "this help"},
     .button = {ButtonSide::kEnd, "Help", "All keys", true},
     .works_everywhere = true},
    {.id = "quit",
     .action = Do(Action::kQuit),
     .keys = {{Ctrl('q')}},
     .help = {"View", "", "quit"},
     .button = {ButtonSide::kEnd, "Quit", "Leave the program"},
     .works_everywhere = true},
};

}  // namespace

std::span<const SimulatorCommand> SimulatorCommands() noexcept {
  return kCommands;
}

std::uint32_t MirrorKey(std::uint32_t keyval, KeyLayout layout) noexcept {
  if (layout == KeyLayout::kRightHanded) return keyval;
  // rows of the keyboard; each key changes places with the one as far from the other end
  constexpr std::string_view kRows[] = {"qwertyuiop", "asdfghjkl;", "zxcvbnm,./"};
  const bool is_capital = keyval >= 'A' && keyval <= 'Z';
  const std::uint32_t letter = is_capital ? keyval - 'A' + 'a' : keyval;
  for (const std::string_view row : kRows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (static_cast<std::uint32_t>(row[i]) == letter)
        return static_cast<std::uint32_t>(row[row.size() - 1 - i]);
    }
  }
  return keyval;
}

KeyMeaning FindKeyMeaning(std::uint32_t keyval, bool control) noexcept {
  const SimulatorCommand* command = FindCommand(SimulatorCommands(), keyval, control, false);
  return command == nullptr ? KeyMeaning{} : command->action;
}

SimulatorNeeds FindNeeds(Action action) noexcept {
  const SimulatorCommand* command = FindCommand(SimulatorCommands(), Do(action));
  return command == nullptr ? kNothing : command->needs;
}

Action FindAction(device::HandAct act) noexcept {
  switch (act) {
    case device::HandAct::kCut:
      return Action::kHoldCut;
    case device::HandAct::kCoagulate:
      return Action::kHoldCoagulate;
    case device::HandAct::kRinse:
      return Action::kHoldRinse;
    case device::HandAct::kAspirate:
      return Action::kHoldAspirate;
    case device::HandAct::kNextTool:
      return Action::kNextTool;
    case device::HandAct::kPreviousTool:
      return Action::kPreviousTool;
    case device::HandAct::kAssistant:
      return Action::kAssistant;
    case device::HandAct::kClutch:
      return Action::kHoldClutch;
    case device::HandAct::kFreeze:
      return Action::kFreeze;
    case device::HandAct::kNone:
    case device::HandAct::kCount:
      break;
  }
  return Action::kNone;
}

bool WorksInPanel(Action action) noexcept {
  const SimulatorCommand* command = FindCommand(SimulatorCommands(), Do(action));
  return command != nullptr && command->works_everywhere;
}

}  // namespace trocar::presenter
