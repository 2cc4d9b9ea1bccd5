// SPDX-License-Identifier: Apache-2.0
// Of the simulator's presenter: who is operated on, and which keys and buttons do what.
#include <utility>

#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/patient_list.h"
#include "trocar/presenter/simulator_presenter.h"

namespace trocar::presenter {

// patients

void SimulatorPresenter::OpenPatientList() {
  if (page_.failure) return;
  if (control_ != nullptr) control_->SetPaused(true);
  screen_->FillPatientList(options_.operation.patient);
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_patient_list_open = true;
  Refresh();
}

void SimulatorPresenter::ClosePatientList() {
  page_.is_patient_list_open = false;
  OpenHome();
}

void SimulatorPresenter::OpenRehearsal() {
  if (page_.failure || loading_.IsRunning()) return;
  if (control_ != nullptr) control_->SetPaused(true);
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_rehearsal_open = true;
  Refresh();
}

void SimulatorPresenter::CloseRehearsal() {
  if (!page_.is_rehearsal_open) return;
  page_.is_rehearsal_open = false;
  OpenPatientList();
}

void SimulatorPresenter::OperateOn(const std::filesystem::path& patient) {
  ChoosePatient(patient);
  TaskRequest request;
  request.task = kOperationTask;
  request.choice.patient_folder = patient;
  Open(request);
}

void SimulatorPresenter::ChoosePatient(const std::filesystem::path& folder) {
  options_.operation.patient = folder;
  settings_.patient = folder.string();
  page_.home.problem.reset();
  KeepSettings();
  Announce(host::TranslateWith("Operations are on {1} from now on.", {ShortPatientName(folder)}));
}

// keys

void SimulatorPresenter::SayPointerIsFree() {
  Announce(host::Translate(
      "This display lets no program hold the pointer: where it leaves the picture, the hand stands still."));
}

/// Those of the settings; what cannot be used is said and left out.
void SimulatorPresenter::UseBindings() {
  bindings_.SetLayout(settings_.is_left_handed ? KeyLayout::kLeftHanded : KeyLayout::kRightHanded);
  for (const std::string& refused : bindings_.Use({settings_.keys, settings_.buttons})) {
    const std::string text =
        host::TranslateWith("The window's settings name {1}, which cannot be; it is left out", {refused});
    host::Log(host::LogLevel::kWarning, text);
    page_.event = text;
    page_.is_event_warning = true;
  }
}

void SimulatorPresenter::KeepBindings(KeyBindings::Own former) {
  if (former == bindings_.GetOwn()) return Refresh();
  former_bindings_.push_back(std::move(former));
  KeyBindings::Own own = bindings_.GetOwn();
  settings_.keys = std::move(own.keys);
  settings_.buttons = std::move(own.buttons);
  if (control_ != nullptr) control_->Device().ReleaseAll();
  KeepSettings();
  Refresh();
}

void SimulatorPresenter::OpenKeyList() {
  if (page_.failure) return;
  if (control_ != nullptr) control_->SetPaused(true);
  screen_->ReleasePointer();
  page_.is_help_open = false;
  CloseCards();
  page_.is_key_list_open = true;
  Refresh();
}

void SimulatorPresenter::CloseKeyList() {
  page_.is_key_list_open = false;
  if (control_ == nullptr && !loading_.IsRunning()) page_.is_home_open = true;
  Refresh();
}

base::Status SimulatorPresenter::ChangeKey(const std::string& id, std::uint32_t key) {
  KeyBindings::Own former = bindings_.GetOwn();
  const base::Status changed = bindings_.SetKey(id, key);
  if (!changed.ok()) {
    Announce(changed.error().message, true);
    return changed;
  }
  KeepBindings(std::move(former));
  return {};
}

void SimulatorPresenter::ChangeButton(ButtonAct act, MouseButton button) {
  KeyBindings::Own former = bindings_.GetOwn();
  bindings_.SetButton(act, button);
  KeepBindings(std::move(former));
}

void SimulatorPresenter::RestoreKeys() {
  KeyBindings::Own former = bindings_.GetOwn();
  bindings_.RestoreAll();
  KeepBindings(std::move(former));
}

void SimulatorPresenter::UndoKeys() {
  if (former_bindings_.empty()) return;
  const KeyBindings::Own former = std::move(former_bindings_.back());
  former_bindings_.pop_back();
  bindings_.Use(former);
  settings_.keys = former.keys;
  settings_.buttons = former.buttons;
  KeepSettings();
  Refresh();
}

}  // namespace trocar::presenter
