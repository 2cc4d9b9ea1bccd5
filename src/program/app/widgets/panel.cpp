// SPDX-License-Identifier: Apache-2.0
#include "panel.h"

namespace trocar::app {
namespace {

constexpr int kPanelWidth = 340;

}  // namespace

Panel::Panel() {
  set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  set_size_request(kPanelWidth, -1);
  set_hexpand(false);
  add_css_class("panel");
  cards_.set_spacing(7);
  cards_.set_margin(8);
  set_child(cards_);
  cards_.append(task_);
  cards_.append(hands_);
  cards_.append(operation_);
  for (const auto& card : settings_.Cards()) cards_.append(*card);
  cards_.append(measures_);
  cards_.append(patient_);
  cards_.append(stages_);
}

void Panel::ShowScene(const presenter::ScenePage& page) {
  task_.ShowScene(page);
  operation_.ShowScene(page);
  patient_.Show(page);
}

void Panel::ShowOperation(const presenter::OperationPage& page) {
  hands_.ShowNames(page);
  operation_.Show(page);
}

void Panel::ShowMeasures(const presenter::MeasuresPage& page) {
  measures_.Show(page);
  stages_.Show(page);
}

}  // namespace trocar::app
