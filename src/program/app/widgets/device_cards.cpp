// SPDX-License-Identifier: Apache-2.0
#include "device_cards.h"

#include "trocar/device/force_device_spec.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kSpacing = 6, kListHeight = 110;  // [pixels]
constexpr int kTextCharacters = 46;             // of a line

void SetWrapped(Gtk::Label& label, const char* style) {
  label.add_css_class(style);
  label.set_wrap(true);
  label.set_xalign(0);
  label.set_max_width_chars(kTextCharacters);
}

}  // namespace

FoundCard::FoundCard(presenter::DevicePresenter& presenter) : gui::Card("DEVICES", kSpacing) {
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_child(found_);
  scrolled->set_min_content_height(kListHeight);
  append(*scrolled);
  found_.signal_row_activated().connect([&presenter](Gtk::ListBoxRow* row) {
    presenter.ChooseFound(static_cast<std::size_t>(row->get_index()));
  });
  spec_.set_placeholder_text("liberty:/dev/ttyUSB0");
  spec_.set_tooltip_text(host::Translate(
      "Device to try, as KIND:ADDRESS; a + joins hands and jaws. `trocar devices list` names the kinds"));
  spec_.signal_changed().connect([this, &presenter] { presenter.SetSpec(spec_.get_text().raw()); });
  spec_.signal_activate().connect([&presenter] { presenter.Test(); });
  append(spec_);
  test_.add_css_class("primary");
  test_.set_tooltip_text(host::Translate("Open the device and show what it says"));
  stop_.set_tooltip_text(host::Translate("Close the device"));
  find_.set_tooltip_text(host::Translate("Look for what has been plugged in since"));
  test_.signal_clicked().connect([&presenter] { presenter.Test(); });
  stop_.signal_clicked().connect([&presenter] { presenter.Stop(); });
  find_.signal_clicked().connect([&presenter] { presenter.Find(); });
  append(gui::MakeRow(kSpacing, {&test_, &stop_, &find_}));
}

void FoundCard::ShowFound(const std::vector<std::string>& devices) {
  while (Gtk::ListBoxRow* row = found_.get_row_at_index(0)) found_.remove(*row);
  for (const std::string& device : devices) {
    auto* label = Gtk::make_managed<Gtk::Label>(device);
    label->set_xalign(0);
    label->set_ellipsize(Pango::EllipsizeMode::END);
    found_.append(*label);
  }
  if (devices.empty())
    found_.append(*Gtk::make_managed<Gtk::Label>(host::Translate("nothing but mouse and keyboard")));
}

void FoundCard::Show(const presenter::DevicePageState& state) {
  if (spec_.get_text().raw() != state.spec) spec_.set_text(state.spec);
}

CalibrationCard::CalibrationCard(presenter::DevicePresenter& presenter)
    : gui::Card("HAND AND CALIBRATION", kSpacing) {
  hand_.set_model(Gtk::StringList::create(
      {host::Translate("Left hand"), host::Translate("Right hand"), host::Translate("Laparoscope")}));
  hand_.property_selected().signal_changed().connect(
      [this, &presenter] { presenter.ChooseHand(static_cast<device::Channel>(hand_.get_selected())); });
  swap_.set_tooltip_text(
      host::Translate("The left hand's sensor becomes the right hand's, and the other way round; kept"));
  swap_.signal_clicked().connect([&presenter] { presenter.SwapHands(); });
  append(gui::MakeRow(kSpacing, {&hand_, &swap_}));
  const auto step = [&presenter](Gtk::Button& button, presenter::CalibrationStep which,
                                 const std::string& tip) {
    button.set_tooltip_text(tip);
    button.signal_clicked().connect([&presenter, which] { presenter.Begin(which); });
  };
  step(tip_, presenter::CalibrationStep::kTip,
       host::Translate("Where the tip is, seen from its sensor: swing the handle about the tip"));
  step(trocar_, presenter::CalibrationStep::kTrocar,
       host::Translate("Where the trocar is: swing the instrument in it"));
  step(jaw_, presenter::CalibrationStep::kJaw, host::Translate("What the jaw sensor reads closed and open"));
  append(gui::MakeRow(kSpacing, {&tip_, &trocar_, &jaw_}));
  SetWrapped(hint_, "name");
  SetWrapped(result_, "value");
  append(hint_);
  append(progress_);
  append(result_);
}

void CalibrationCard::Show(const presenter::DevicePageState& state) {
  progress_.set_fraction(state.progress);
  gui::SetText(hint_, state.hint);
  gui::SetText(result_, state.result);
  for (Gtk::Button* button : {&tip_, &trocar_, &jaw_, &swap_}) button->set_sensitive(state.can_measure);
}

UseCard::UseCard(presenter::DevicePresenter& presenter) : gui::Card("IN THE OPERATION", kSpacing) {
  use_.set_tooltip_text(
      host::Translate("The device above holds the instruments; the mouse keeps what it does not see"));
  use_.signal_clicked().connect([&presenter] { presenter.Use(); });
  append(use_);
  haptic_name_.set_placeholder_text(host::Translate("haptic device"));
  haptic_name_.set_text("simulated");
  haptic_name_.set_tooltip_text(host::TranslateWith("Haptic devices: {1}", {device::ListForceDrivers()}));
  use_haptics_.signal_clicked().connect(
      [this, &presenter] { presenter.UseHaptics(haptic_name_.get_text().raw()); });
  check_pose_.set_tooltip_text(host::Translate("Confirm which haptic device is which hand"));
  check_pose_.signal_clicked().connect([&presenter] { presenter.CheckPose(); });
  force_.set_tooltip_text(
      host::Translate("Asks for force, or takes it away; nothing switches it on by itself"));
  force_.signal_toggled().connect([this, &presenter] {
    if (!is_showing_) presenter.SetForce(force_.get_active());
  });
  append(gui::MakeRow(kSpacing, {&haptic_name_, &use_haptics_, &check_pose_, &force_}));
  SetWrapped(haptics_, "name");
  append(haptics_);
}

void UseCard::Show(const presenter::DevicePageState& state) {
  check_pose_.set_sensitive(state.has_haptics);
  force_.set_sensitive(state.has_haptics);
  gui::SetText(haptics_, state.haptics);
  is_showing_ = true;
  force_.set_active(state.is_force_on);
  is_showing_ = false;
}

}  // namespace trocar::app
