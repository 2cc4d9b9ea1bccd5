// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_commands.h"

namespace trocar::editor {
namespace {

using gui::ButtonSide;
using gui::Ctrl;
using gui::CtrlShift;
namespace key = gui::key;

using enum PatientNeeds;

constexpr PatientCommand kCommands[] = {
    {.id = "undo",
     .action = PatientAction::kUndo,
     .needs = kUndo,
     .keys = {{Ctrl('z')}},
     .button = {ButtonSide::kStart, "Undo", "Undo"}},
    {.id = "redo",
     .action = PatientAction::kRedo,
     .needs = kRedo,
     .keys = {{CtrlShift('z')}},
     .also = {{Ctrl('y')}},
     .button = {ButtonSide::kStart, "Redo", "Redo"}},
    {.id = "save-as",
     .action = PatientAction::kSaveAs,
     .needs = kPatient,
     .keys = {{CtrlShift('s')}},
     .button = {ButtonSide::kEnd, "Save as…", "Write another folder"}},
    {.id = "save",
     .action = PatientAction::kSave,
     .needs = kUnsaved,
     .keys = {{Ctrl('s')}},
     .button = {ButtonSide::kEnd, "Save", "Write the patient's folder", false, true}},
    {.id = "look", .action = PatientAction::kLook, .needs = kPatient, .keys = {{{'1'}}}},
    {.id = "paint", .action = PatientAction::kPaint, .needs = kPatient, .keys = {{{'2'}}}},
    {.id = "tubes", .action = PatientAction::kTubes, .needs = kPatient, .keys = {{{'3'}}}},
    {.id = "landmarks", .action = PatientAction::kLandmarks, .needs = kPatient, .keys = {{{'4'}}}},
    {.id = "delete-point",
     .action = PatientAction::kDeletePoint,
     .needs = kPatient,
     .keys = {{{key::kDelete}}},
     .also = {{{key::kBackSpace}}}},
    {.id = "insert-point",
     .action = PatientAction::kInsertPoint,
     .needs = kPatient,
     .keys = {{{key::kInsert}}}},
    {.id = "erase", .action = PatientAction::kToggleErase, .needs = kPatient, .keys = {{{'e'}}}},
    {.id = "quit", .action = PatientAction::kQuit, .keys = {{Ctrl('q')}}, .also = {{Ctrl('w')}}},
};

}  // namespace

std::span<const PatientCommand> PatientCommands() noexcept {
  return kCommands;
}

PatientNeeds FindNeeds(PatientAction action) noexcept {
  const PatientCommand* command = FindCommand(PatientCommands(), action);
  return command == nullptr ? kNothing : command->needs;
}

PatientAction FindPatientAction(std::uint32_t keyval, bool control, bool shift) noexcept {
  const PatientCommand* command = FindCommand(PatientCommands(), keyval, control, shift);
  return command == nullptr ? PatientAction::kNone : command->action;
}

}  // namespace trocar::editor
