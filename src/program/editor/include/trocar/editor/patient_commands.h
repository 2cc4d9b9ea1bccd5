// SPDX-License-Identifier: Apache-2.0
/// \file patient_commands.h  The patient editor's commands: keys and header bar come from one table.
#pragma once

#include <cstdint>
#include <span>

#include "trocar/gui/command.h"

namespace trocar::editor {

enum class PatientAction {
  kNone,
  kUndo,
  kRedo,
  kSave,
  kSaveAs,
  kLook,
  kPaint,
  kTubes,
  kLandmarks,
  kDeletePoint,
  kInsertPoint,
  kToggleErase,
  kQuit,
};

/// Precondition of a command.
enum class PatientNeeds {
  kNothing,
  kPatient,  ///< a patient is open
  kUndo,     ///< as kPatient, and there is something to take back
  kRedo,
  kUnsaved,  ///< as kPatient, with changes that are not saved
};

using PatientCommand = gui::Command<PatientAction, PatientNeeds>;

/// All of them; those with a button in the order of the header bar, from the left.
std::span<const PatientCommand> PatientCommands() noexcept;

PatientNeeds FindNeeds(PatientAction action) noexcept;

/// Meaning of a key.
/// \param keyval  X11 key symbol, as GDK gives it; letters in either case
PatientAction FindPatientAction(std::uint32_t keyval, bool control, bool shift) noexcept;

}  // namespace trocar::editor
