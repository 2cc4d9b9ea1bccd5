// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/key_bindings.h"

namespace trocar::app {
namespace {

using device::Motion;

// X11 key symbols (X11/keysymdef.h); letters are their ASCII code
enum KeySymbol : std::uint32_t {
  kTab = 0xff09,
  kEscape = 0xff1b,
  kIsoLeftTab = 0xfe20,
  kLeft = 0xff51,
  kUp = 0xff52,
  kRight = 0xff53,
  kDown = 0xff54,
  kPageUp = 0xff55,
  kPageDown = 0xff56,
  kPad1 = 0xffb1,
  kPad2 = 0xffb2,
  kF1 = 0xffbe,
  kF6 = 0xffc3,
  kF11 = 0xffc8,
};

constexpr KeyMeaning Move(Motion motion) {
  return {Action::kMove, motion};
}
constexpr KeyMeaning Do(Action action) {
  return {action, Motion::kCount};
}

constexpr KeyHelp kHelp[] = {
    {"Instruments", "Click", "take the instruments with the mouse"},
    {"Instruments", "Esc", "give the mouse back"},
    {"Instruments", "1   2   Tab", "left hand, right hand, the other hand"},
    {"Instruments", "Mouse", "move the tip in the picture"},
    {"Instruments", "Wheel   I O", "tip into the picture, back out"},
    {"Instruments", "Arrows   W A S D", "move the tip with the keyboard"},
    {"Instruments", "Left button   G", "close the jaws (hold)"},
    {"Instruments", "Right button   B", "open the jaws (hold)"},
    {"Instruments", "Q   E", "spin the instrument (hold)"},
    {"Instruments", "T", "real trocar: the mouse is the handle, the tip goes the other way"},
    {"Operation", "X   Z", "next tool, previous tool of this hand"},
    {"Operation", "V   N", "yellow pedal: cut, blue pedal: coagulate (hold)"},
    {"Operation", "J   K", "rinse, suck (hold)"},
    {"Operation", "Comma   Y", "clutch (hold), freeze: the tool stands still although its device moves"},
    {"Operation", "U", "assistant: take and lift the fundus, relax, let go, wait"},
    {"Laparoscope", "C or middle button", "hold, then move the mouse to look around, wheel to go in and out"},
    {"Laparoscope", "L", "automatic holder: keeps both tips in the picture; C takes over"},
    {"Simulation", "Space", "start or pause"},
    {"Simulation", "R", "reset"},
    {"Simulation", "P", "play the demonstration, or take over from it"},
    {"View", "F", "force arrows"},
    {"View", "M", "round mask of the laparoscope"},
    {"View", "F11", "full screen"},
    {"View", "F6", "between picture and panel"},
    {"View", "H   F1", "this help"},
    {"View", "Ctrl+Q", "quit"},
};

}  // namespace

KeyMeaning FindKeyMeaning(std::uint32_t keyval, bool control) noexcept {
  if (keyval >= 'A' && keyval <= 'Z') keyval += 'a' - 'A';
  if (control) return keyval == 'q' ? Do(Action::kQuit) : KeyMeaning{};
  switch (keyval) {
    case kLeft:
    case 'a':
      return Move(Motion::kLeft);
    case kRight:
    case 'd':
      return Move(Motion::kRight);
    case kUp:
    case 'w':
      return Move(Motion::kUp);
    case kDown:
    case 's':
      return Move(Motion::kDown);
    case kPageUp:
    case 'i':
      return Move(Motion::kIn);
    case kPageDown:
    case 'o':
      return Move(Motion::kOut);
    case 'q':
      return Move(Motion::kSpinLeft);
    case 'e':
      return Move(Motion::kSpinRight);
    case 'g':
      return Move(Motion::kCloseJaw);
    case 'b':
      return Move(Motion::kOpenJaw);
    case '1':
    case kPad1:
      return Do(Action::kChooseLeft);
    case '2':
    case kPad2:
      return Do(Action::kChooseRight);
    case kTab:
    case kIsoLeftTab:
      return Do(Action::kSwitchHand);
    case 'x':
      return Do(Action::kNextTool);
    case 'z':
      return Do(Action::kPreviousTool);
    case 'v':
      return Do(Action::kHoldCut);
    case 'n':
      return Do(Action::kHoldCoagulate);
    case 'j':
      return Do(Action::kHoldRinse);
    case 'k':
      return Do(Action::kHoldAspirate);
    case ',':
      return Do(Action::kHoldClutch);
    case 'y':
      return Do(Action::kFreeze);
    case 'u':
      return Do(Action::kAssistant);
    case 'l':
      return Do(Action::kToggleCameraHolder);
    case 'c':
      return Do(Action::kHoldLaparoscope);
    case ' ':
      return Do(Action::kTogglePause);
    case 'r':
      return Do(Action::kReset);
    case 'p':
      return Do(Action::kToggleDemonstration);
    case 'f':
      return Do(Action::kToggleForces);
    case 'm':
      return Do(Action::kToggleMask);
    case 't':
      return Do(Action::kToggleFulcrum);
    case kF11:
      return Do(Action::kToggleFullscreen);
    case 'h':
    case kF1:
      return Do(Action::kToggleHelp);
    case kEscape:
      return Do(Action::kReleasePointer);
    case kF6:
      return Do(Action::kSwitchPane);
    default:
      return {};
  }
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
  return action == Action::kQuit || action == Action::kToggleFullscreen ||
         action == Action::kReleasePointer || action == Action::kSwitchPane || action == Action::kToggleHelp;
}

std::span<const KeyHelp> KeyHelpRows() noexcept {
  return kHelp;
}

const char* ShortHelp() noexcept {
  return "1 2 Tab hand  ·  mouse, wheel move  ·  left / right button close / open jaws  ·  Q E spin  ·  "
         "X Z tool  ·  V N current  ·  J K rinse, suck  ·  U assistant  ·  "
         "C laparoscope  ·  Space pause  ·  H help";
}

}  // namespace trocar::app
