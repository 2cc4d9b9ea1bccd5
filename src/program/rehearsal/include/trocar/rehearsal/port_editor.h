// SPDX-License-Identifier: Apache-2.0
/// \file port_editor.h  Ports and table of a patient as a person moves them: within the rules of their placing, with undo.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"
#include "trocar/rehearsal/rehearsal_state.h"

namespace trocar::rehearsal {

class PortEditor {
 public:
  /// Takes a patient's ports and table as the proposal from now on; nothing can be undone.
  void Begin(const patient::Patient& patient);
  void Forget() { undo_.clear(), redo_.clear(), grabbed_.reset(); }

  /// \param port  index, of the patient
  /// \param x, y  of the wall, to the left and cranial from the navel [m]
  /// \return as anatomy::MovePort; the patient then stays as it is
  base::Status Move(patient::Patient& patient, std::size_t port, double x, double y);
  /// A drag begins: whatever it moves is one step for undo, which ends with Release.
  void Grab(const patient::Patient& patient);
  bool IsGrabbed() const { return grabbed_.has_value(); }
  void Release(const patient::Patient& patient);
  /// As far as tables tilt. \return whether that is another tilt
  bool Tilt(patient::Patient& patient, double head_up_deg, double right_up_deg);
  /// \return whether there was something
  bool Undo(patient::Patient& patient) { return Exchange(undo_, redo_, patient); }
  bool Redo(patient::Patient& patient) { return Exchange(redo_, undo_, patient); }
  void Reset(patient::Patient& patient);
  /// Puts a plan that was kept in the place of the proposal; that stays what it is.
  static void Use(const PortPlan& plan, patient::Patient& patient);

  /// The plan where it is not the proposal.
  std::optional<PortPlan> FindChange(const patient::Patient& patient) const;
  bool CanUndo() const { return !undo_.empty(); }
  bool CanRedo() const { return !redo_.empty(); }

 private:
  void Remember(PortPlan before, const patient::Patient& patient);
  static bool Exchange(std::vector<PortPlan>& from, std::vector<PortPlan>& to, patient::Patient& patient);

  PortPlan proposal_;
  std::vector<PortPlan> undo_, redo_;
  std::optional<PortPlan> grabbed_;  // before the drag
};

}  // namespace trocar::rehearsal
