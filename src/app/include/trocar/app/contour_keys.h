// SPDX-License-Identifier: Apache-2.0
/// \file contour_keys.h  What each key does in the contour window, and the help that says so. One table feeds
/// both.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/app/key_bindings.h"

namespace trocar::app {

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

/// Meaning of a key over the picture.
/// \param keyval  X11 key symbol, as GDK gives it; letters in either case
ContourAction FindContourAction(std::uint32_t keyval, bool control, bool shift) noexcept;

/// True if the key has its meaning while another part of the window has the keyboard.
bool WorksEverywhere(ContourAction action) noexcept;

std::span<const KeyHelp> ContourKeyHelpRows() noexcept;

}  // namespace trocar::app
