// SPDX-License-Identifier: Apache-2.0
/// \file simulator_commands.h  The simulator window's commands: keys, header bar and help page come from one table.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/device/hand_buttons.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/gui/command.h"

namespace trocar::presenter {

enum class Action {
  kNone,
  kMove,  ///< a device::Motion while the key is held
  kChooseLeft,
  kChooseRight,
  kSwitchHand,
  kToggleCameraHolder,
  kHoldLaparoscope,  ///< while the key is held the pointer and the wheel move the laparoscope
  kNextTool,         ///< of the tray of the chosen hand
  kPreviousTool,
  kHoldCut,  ///< pedals work while their key is held, for the chosen hand
  kHoldCoagulate,
  kHoldRinse,
  kHoldAspirate,
  kHoldClutch,  ///< the tool stands still although its device moves
  kFreeze,      ///< the same from one press to the next
  kAssistant,   ///< the next command to the assistant
  kTogglePause,
  kReset,
  kFinish,  ///< the attempt is over: its result
  kToggleDemonstration,
  kToggleForces,
  kToggleMask,
  kToggleGuides,  ///< marks that help to see depth, and what comes next
  kToggleFulcrum,
  kToggleDepthSnap,  ///< the wheel ends where the tip meets something
  kToggleSlowMotion,
  kToggleLeftHanded,
  kToggleForceFeedback,
  kCheckPose,
  kOpenHome,
  kToggleTutorial,
  kTogglePanel,  ///< numbers and settings beside the picture
  kToggleTaskList,
  kToggleRecordingList,
  kTogglePatientList,
  kToggleKeyList,
  kOpenDevices,
  kOpenCentre,  ///< history, courses, groups, exams
  kSavePicture,
  kSaveClip,     ///< a video of the last minute
  kToggleSound,  ///< mute, or what was heard before
  kToggleSpeech,
  kLouder,
  kQuieter,
  kToggleFullscreen,
  kToggleHelp,
  kReleasePointer,
  kSwitchPane,
  kQuit,
};

struct KeyMeaning {
  Action action = Action::kNone;
  device::Motion motion = device::Motion::kCount;  ///< kMove only

  friend bool operator==(const KeyMeaning&, const KeyMeaning&) = default;
};

/// Precondition of a command.
enum class SimulatorNeeds {
  kNothing,
  kNoFailure,
  kScene,     ///< a simulation runs, and nothing has failed
  kScript,    ///< as kScene, with a script or an expert, and it is no exam
  kGuidance,  ///< as kScene, and it is no exam
  kHelp,      ///< as kScene, and the operation's level has guides and slow motion
  kHaptics,   ///< as kScene, and a haptic device holds a hand
};

using SimulatorCommand = gui::Command<KeyMeaning, SimulatorNeeds>;

/// Which side of the keyboard lies under the hand that holds no mouse.
enum class KeyLayout : std::uint8_t { kRightHanded, kLeftHanded };
/// Where a key's meaning lies in a layout: left-handed, letters change places with their mirror image on the keyboard.
std::uint32_t MirrorKey(std::uint32_t keyval, KeyLayout layout) noexcept;

/// All of them; those with a button in the order of the header bar, from the left.
std::span<const SimulatorCommand> SimulatorCommands() noexcept;
/// Meaning of a key in the picture.
///
/// \param keyval   X11 key symbol, as GDK gives it; letters in either case
/// \param control  the Ctrl key is held
KeyMeaning FindKeyMeaning(std::uint32_t keyval, bool control) noexcept;

/// Meaning of a key that a person's settings give an act to: foot pedals that are keyboards.
Action FindAction(device::HandAct act) noexcept;

/// Precondition of an action; kNothing for one without a row.
SimulatorNeeds FindNeeds(Action action) noexcept;

/// True if the key has its meaning even while a slider of the panel has the keyboard.
bool WorksInPanel(Action action) noexcept;

}  // namespace trocar::presenter
