// SPDX-License-Identifier: Apache-2.0
/// \file centre_commands.h  Commands of the training centre's pages, one row a command.
#pragma once

#include <span>
#include <vector>

#include "trocar/gui/command.h"

namespace trocar::centre {

enum class CentreAction {
  kShowResult,
  kShowHistory,
  kShowCourses,
  kShowGroup,
  kShowExam,
  kReload,
  kWho,  ///< who works here
  kToggleHelp,
  kCloseCards,
  kClose,
};

enum class CentreNeeds {
  kNothing,
  kResult,      ///< an attempt has been judged, or is
  kInstructor,  ///< nobody has said who they are, or an instructor has
};

using CentreCommand = gui::Command<CentreAction, CentreNeeds>;

/// All of them; those with a button in the order of the header bar, from the left.
std::span<const CentreCommand> CentreCommands() noexcept;
/// The help page.
std::vector<gui::KeyHelp> CentreHelp();

}  // namespace trocar::centre
