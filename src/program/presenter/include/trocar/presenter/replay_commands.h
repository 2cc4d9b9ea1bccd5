// SPDX-License-Identifier: Apache-2.0
/// \file replay_commands.h  The replay window's commands: keys, header bar and help page come from one table.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/gui/command.h"

namespace trocar::presenter {

enum class ReplayAction {
  kNone,
  kTogglePlay,
  kSlower,
  kFaster,
  kBack,  ///< a second
  kOn,
  kBackFar,  ///< ten seconds
  kOnFar,
  kToBegin,
  kToEnd,
  kPreviousMark,  ///< a little before the error, phase or remark before this moment
  kNextMark,
  kToggleCamera,  ///< as recorded, or free
  kToggleForces,
  kToggleGhosts,
  kToggleList,  ///< of recordings to put beside this one
  kCloseBeside,
  kTakeOver,
  kWhatIf,
  kToggleHelp,
  kCloseCards,
  kSavePicture,
  kSaveClip,   ///< a video of the minute before this moment
  kSaveVideo,  ///< of the whole recording
  kToggleFullscreen,
  kClose,
};

enum class ReplayNeeds {
  kNothing,
  kReplay,  ///< a recording is open, and nothing has failed
  kExpert,  ///< as kReplay, and there is a scripted expert for it
  kBeside,  ///< as kReplay, and another one is beside it
};

using ReplayCommand = gui::Command<ReplayAction, ReplayNeeds>;

/// All of them; those with a button in the order of the header bar, from the left.
std::span<const ReplayCommand> ReplayCommands() noexcept;
/// The help page.
std::vector<gui::KeyHelp> ReplayHelp();
/// Precondition of an action; kNothing for one without a row.
ReplayNeeds FindNeeds(ReplayAction action) noexcept;

}  // namespace trocar::presenter
