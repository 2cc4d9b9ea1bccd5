// SPDX-License-Identifier: Apache-2.0
#include "hand_events.h"

#include <gtkmm/eventcontrollerlegacy.h>

#include <algorithm>
#include <optional>

namespace trocar::app {
namespace {

/// The pedal whose key it is, or nothing.
std::optional<Pedal> FindPedal(Action action) {
  switch (action) {
    case Action::kHoldCut:
      return Pedal::kCut;
    case Action::kHoldCoagulate:
      return Pedal::kCoagulate;
    case Action::kHoldRinse:
      return Pedal::kRinse;
    case Action::kHoldAspirate:
      return Pedal::kAspirate;
    case Action::kHoldClutch:
      return Pedal::kClutch;
    default:
      return std::nullopt;
  }
}

constexpr guint kLeftButton = 1, kMiddleButton = 2, kRightButton = 3;

}  // namespace

HandEvents::HandEvents(Gtk::Window& window, Gtk::Widget& picture, Gtk::Widget& panel)
    : window_(window), picture_(picture), panel_(panel) {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(sigc::mem_fun(*this, &HandEvents::OnKeyPressed), false);
  keys->signal_key_released().connect(sigc::mem_fun(*this, &HandEvents::OnKeyReleased), false);
  window.add_controller(keys);

  const auto motion = Gtk::EventControllerMotion::create();
  motion->signal_motion().connect(sigc::mem_fun(*this, &HandEvents::OnMotion));
  motion->signal_enter().connect([this](double, double) { has_last_ = false; });
  motion->signal_leave().connect([this] { has_last_ = false; });
  picture.add_controller(motion);

  const auto buttons = Gtk::EventControllerLegacy::create();
  buttons->signal_event().connect(sigc::mem_fun(*this, &HandEvents::OnPicturePointer), false);
  picture.add_controller(buttons);

  const auto wheel = Gtk::EventControllerScroll::create();
  wheel->set_flags(Gtk::EventControllerScroll::Flags::VERTICAL);
  wheel->signal_scroll().connect(
      [this](double, double dy) {
        if (control_ == nullptr || control_->IsPaused()) return true;
        if (is_taken_ || control_->IsLaparoscopeHeld()) control_->Device().Scroll(-dy);
        return true;
      },
      false);
  picture.add_controller(wheel);

  window.property_is_active().signal_changed().connect([this] {
    if (!window_.is_active()) ReleaseAll();
  });
}

void HandEvents::ReleasePointer() {
  is_taken_ = false;
  has_last_ = false;
  picture_.set_cursor("");
}

void HandEvents::ReleaseAll() {
  ReleasePointer();
  held_.clear();
  if (control_ == nullptr) return;
  control_->HoldLaparoscope(false);
  control_->Device().ReleaseAll();
  control_->ReleasePedals();
}

bool HandEvents::IsFocusInPanel() const {
  const Gtk::Widget* focus = window_.get_focus();
  return focus != nullptr && focus != &picture_ && !focus->is_ancestor(picture_);
}

/// In a field for text, letters are letters.
bool HandEvents::IsTyping() const {
  const Gtk::Widget* focus = window_.get_focus();
  return focus != nullptr && GTK_IS_EDITABLE(focus->gobj());
}

std::vector<std::string> HandEvents::SetKeys(const std::map<std::string, device::HandAct>& keys) {
  std::vector<std::string> refused;
  own_keys_.clear();
  for (const auto& [name, act] : keys) {
    const guint keyval = gdk_keyval_to_lower(gdk_keyval_from_name(name.c_str()));
    if (keyval == GDK_KEY_VoidSymbol || keyval == GDK_KEY_Escape) {
      refused.push_back(name);
    } else {
      own_keys_[keyval] = FindAction(act);
    }
  }
  return refused;
}

KeyMeaning HandEvents::FindMeaning(guint keyval, bool control) const {
  const auto own = own_keys_.find(gdk_keyval_to_lower(keyval));
  if (own != own_keys_.end() && !control) return {own->second, device::Motion::kCount};
  return FindKeyMeaning(control ? keyval : MirrorKey(keyval, layout_), control);
}

bool HandEvents::OnKeyPressed(guint keyval, guint, Gdk::ModifierType state) {
  using Gdk::ModifierType;
  if ((state & (ModifierType::ALT_MASK | ModifierType::SUPER_MASK)) != ModifierType{}) return false;
  const KeyMeaning meaning = FindMeaning(keyval, (state & ModifierType::CONTROL_MASK) != ModifierType{});
  if (meaning.action == Action::kNone) return false;
  if (IsFocusInPanel() && !WorksInPanel(meaning.action)) return false;
  const bool is_letter =
      (state & ModifierType::CONTROL_MASK) == ModifierType{} && gdk_keyval_to_unicode(keyval) > ' ';
  if (is_letter && IsTyping()) return false;
  const bool is_repeat = std::find(held_.begin(), held_.end(), keyval) != held_.end();
  if (is_repeat) return true;
  held_.push_back(keyval);
  if (const std::optional<Pedal> pedal = FindPedal(meaning.action)) {
    if (control_ != nullptr) control_->SetPedal(*pedal, true);
    return true;
  }
  switch (meaning.action) {
    case Action::kMove:
      if (control_ != nullptr && !control_->IsPaused()) control_->Device().SetKey(meaning.motion, true);
      break;
    case Action::kHoldLaparoscope:
      if (control_ != nullptr) control_->HoldLaparoscope(true);
      break;
    case Action::kReleasePointer:
      ReleasePointer();
      [[fallthrough]];
    default:
      signal_action_.emit(meaning.action);
  }
  return true;
}

void HandEvents::OnKeyReleased(guint keyval, guint, Gdk::ModifierType) {
  std::erase(held_, keyval);
  const KeyMeaning meaning = FindMeaning(keyval, false);
  if (control_ == nullptr) return;
  if (const std::optional<Pedal> pedal = FindPedal(meaning.action)) control_->SetPedal(*pedal, false);
  if (meaning.action == Action::kMove) control_->Device().SetKey(meaning.motion, false);
  if (meaning.action == Action::kHoldLaparoscope) control_->HoldLaparoscope(false);
}

void HandEvents::OnMotion(double x, double y) {
  if (has_last_ && control_ != nullptr && !control_->IsPaused() &&
      (is_taken_ || control_->IsLaparoscopeHeld()))
    control_->Device().MovePointer(x - last_x_, y - last_y_);
  has_last_ = true;
  last_x_ = x;
  last_y_ = y;
}

bool HandEvents::OnPicturePointer(const Glib::RefPtr<const Gdk::Event>& event) {
  const Gdk::Event::Type type = event->get_event_type();
  if (type != Gdk::Event::Type::BUTTON_PRESS && type != Gdk::Event::Type::BUTTON_RELEASE) return false;
  OnButton(event->get_button(), type == Gdk::Event::Type::BUTTON_PRESS);
  return true;
}

void HandEvents::OnButton(guint button, bool is_down) {
  if (is_down) picture_.grab_focus();
  if (control_ == nullptr) return;
  if (button == kMiddleButton) {
    control_->HoldLaparoscope(is_down);
    return;
  }
  if (is_down && !is_taken_) {
    // the click that takes the pointer moves no jaw
    if (button == kLeftButton && !control_->IsDemonstration()) {
      is_taken_ = true;
      picture_.set_cursor("none");
      signal_taken_.emit();
    }
    return;
  }
  if (control_->IsPaused()) is_down = false;
  const bool is_mirrored = layout_ == KeyLayout::kLeftHanded;
  const guint closing = is_mirrored ? kRightButton : kLeftButton;
  const guint opening = is_mirrored ? kLeftButton : kRightButton;
  if (button == closing) control_->Device().SetKey(device::Motion::kCloseJaw, is_down);
  if (button == opening) control_->Device().SetKey(device::Motion::kOpenJaw, is_down);
}

}  // namespace trocar::app
