// SPDX-License-Identifier: Apache-2.0
/// \file contour_commands.h  The contour window's commands: keys, header bar and help page come from one table.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/gui/command.h"

namespace trocar::editor {

enum class ContourAction {
  kNone,
  kNextSlice,
  kPreviousSlice,
  kStepForward,  ///< as many slices as the step
  kStepBack,
  kNextContoured,
  kPreviousContoured,
  kFirstContoured,
  kLastContoured,
  kCloseContour,
  kCancel,  ///< give up the drag, the selection or the open contour, in this order
  kDelete,  ///< the chosen point; of an open contour the last one
  kDeleteContour,
  kClearSlice,
  kToggleHole,
  kNextOrgan,
  kPropagateForward,
  kPropagateBack,
  kToggleScissors,
  kPointsMode,
  kScissorsMode,
  kGrowMode,  ///< the next click says where the organ is that grows from it
  kUndo,
  kRedo,
  kFitView,
  kFitOrgan,
  kZoomIn,
  kZoomOut,
  kMirror,
  kToggleReference,
  kToggleGhosts,
  kToggleStages,
  kToggleFill,
  kOpen,
  kSave,
  kSaveAs,
  kBuild,
  kToggleHelp,
  kToggleFullscreen,
  kQuit,
};

/// Precondition of a command.
enum class ContourNeeds {
  kNothing,
  kDocument,  ///< contours are open
  kUndo,      ///< as kDocument, and there is something to take back
  kRedo,
  kReference,  ///< as kDocument, with a label map to compare with
  kNoBuild,    ///< as kDocument, and no patient is being built, no organ grows
};

using ContourCommand = gui::Command<ContourAction, ContourNeeds>;

/// All of them; those with a button in the order of the header bar, from the left.
std::span<const ContourCommand> ContourCommands() noexcept;
/// The help page.
std::vector<gui::KeyHelp> ContourHelp();

ContourNeeds FindNeeds(ContourAction action) noexcept;

/// Meaning of a key over the picture.
/// \param keyval  X11 key symbol, as GDK gives it; letters in either case
ContourAction FindContourAction(std::uint32_t keyval, bool control, bool shift) noexcept;

/// True if the key has its meaning while another part of the window has the keyboard.
bool WorksEverywhere(ContourAction action) noexcept;

}  // namespace trocar::editor
