// SPDX-License-Identifier: Apache-2.0
/// \file panel.h  The right side of the window: read-outs and settings in cards.
#pragma once

#include <gtkmm.h>

#include <array>
#include <vector>

#include "force_bar.h"
#include "trocar/app/read_outs.h"
#include "trocar/app/session_control.h"
#include "trocar/app/settings_form.h"

namespace trocar::app {

class Panel : public Gtk::ScrolledWindow {
 public:
  Panel();

  /// Fills in the patient and takes the settings over.
  /// \param control  outlives the panel's use
  void SetControl(SessionControl* control);
  /// Refreshes forces and contacts.
  void ShowForces(const simulation::Snapshot& snapshot);
  /// Refreshes tools, liquids and the assistant.
  void ShowOperation(const simulation::Snapshot& snapshot);
  /// Refreshes how the task goes; nothing in a scene without one.
  void ShowTask(const simulation::Snapshot& snapshot);
  /// Refreshes solver and time read-outs.
  void ShowTimes(const simulation::Snapshot& snapshot, const session::RunnerStatistics& statistics,
                 const StageMeter& stages, double frame_rate);
  /// Moves the sliders to the control's settings.
  void ShowSettings();

 private:
  struct HandRow {
    Gtk::Label name, force, contact;
    ForceBar bar;
  };
  struct SliderRow {
    Gtk::Label value;
    Gtk::Scale slider;
  };

  Gtk::Box& AddCard(const char* title);
  void AddTask();
  void AddHands();
  void AddOperation();
  void AddPatient();
  void AddSettings();
  void AddDefaults(Gtk::Box& card);
  void AddMeasures();
  void AddStages();
  Gtk::Label& AddLine(Gtk::Box& card, const char* name, const char* tooltip);

  SessionControl* control_ = nullptr;
  bool is_showing_ = false;  // sliders are being moved by us, not by the person
  Gtk::Box cards_{Gtk::Orientation::VERTICAL};
  Gtk::Box* task_card_ = nullptr;
  Gtk::Label task_name_, task_about_, task_next_, task_errors_;
  Gtk::Label *task_time_ = nullptr, *task_progress_ = nullptr, *task_score_ = nullptr;
  std::array<HandRow, scene::kHandCount> hands_;
  Gtk::Box* operation_card_ = nullptr;  // hidden where there is one tool a hand, and nothing else to do
  std::array<Gtk::DropDown, scene::kHandCount> trays_;
  Gtk::DropDown assistant_;
  Gtk::Label *clips_ = nullptr, *blood_ = nullptr, *bile_ = nullptr, *stones_ = nullptr,
             *assistant_does_ = nullptr;
  Gtk::Box* patient_card_ = nullptr;
  Gtk::Label patient_name_, patient_organs_, patient_source_;
  std::vector<std::unique_ptr<SliderRow>> sliders_;
  Gtk::DropDown solver_;
  Gtk::Button defaults_{"Defaults"};
  Gtk::Label *residual_ = nullptr, *iterations_ = nullptr, *tick_ = nullptr, *late_ = nullptr,
             *frames_ = nullptr, *time_ = nullptr;
  std::array<Gtk::Label, simulation::kStageCount> stages_;
};

}  // namespace trocar::app
