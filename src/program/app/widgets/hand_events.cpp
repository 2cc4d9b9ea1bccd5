// SPDX-License-Identifier: Apache-2.0
#include "hand_events.h"

#include <gtkmm/eventcontrollerlegacy.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace trocar::app {
namespace {

/// The pedal whose key it is, or nothing.
std::optional<presenter::Pedal> FindPedal(presenter::Action action) {
  switch (action) {
    case presenter::Action::kHoldCut:
      return presenter::Pedal::kCut;
    case presenter::Action::kHoldCoagulate:
      return presenter::Pedal::kCoagulate;
    case presenter::Action::kHoldRinse:
      return presenter::Pedal::kRinse;
    case presenter::Action::kHoldAspirate:
      return presenter::Pedal::kAspirate;
    case presenter::Action::kHoldClutch:
      return presenter::Pedal::kClutch;
    default:
      return std::nullopt;
  }
}

constexpr guint kFirstButton = 1, kLastButton = 3;

}  // namespace

HandEvents::HandEvents(Gtk::Window& window, Gtk::Widget& picture, Gtk::Widget& panel)
    : window_(window),
      picture_(picture),
      panel_(panel),
      lock_(picture, [this](const PointerLock::Motion& motion) { OnMotion(motion); }) {
  const auto keys = Gtk::EventControllerKey::create();
  keys->set_propagation_phase(Gtk::PropagationPhase::CAPTURE);
  keys->signal_key_pressed().connect(sigc::mem_fun(*this, &HandEvents::OnKeyPressed), false);
  keys->signal_key_released().connect(sigc::mem_fun(*this, &HandEvents::OnKeyReleased), false);
  window.add_controller(keys);

  const auto motion = Gtk::EventControllerMotion::create();
  motion->signal_motion().connect([this](double x, double y) { lock_.See(x, y); });
  motion->signal_enter().connect([this](double, double) {
    if (!lock_.IsHeld()) lock_.Forget();
  });
  motion->signal_leave().connect([this] {
    if (!lock_.IsHeld()) lock_.Forget();
  });
  picture.add_controller(motion);

  const auto buttons = Gtk::EventControllerLegacy::create();
  buttons->signal_event().connect(sigc::mem_fun(*this, &HandEvents::OnPicturePointer), false);
  picture.add_controller(buttons);

  const auto wheel = Gtk::EventControllerScroll::create();
  wheel->set_flags(Gtk::EventControllerScroll::Flags::VERTICAL);
  wheel->signal_scroll().connect(
      [this](double, double dy) {
        if (control_ == nullptr || control_->IsPaused()) return true;
        if (MovesSomething()) control_->Scroll(-dy);
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
  FollowPause();
}

void HandEvents::FollowPause() {
  const bool is_wanted = is_taken_ && control_ != nullptr && !control_->IsPaused();
  if (is_wanted == is_held_wanted_) return;
  is_held_wanted_ = is_wanted;
  is_wanted ? static_cast<void>(lock_.Take()) : lock_.Release();
  picture_.set_cursor(is_wanted ? "none" : "");
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
      own_keys_[keyval] = presenter::FindAction(act);
    }
  }
  return refused;
}

presenter::KeyMeaning HandEvents::FindMeaning(guint keyval, bool control) const {
  const auto own = own_keys_.find(gdk_keyval_to_lower(keyval));
  if (own != own_keys_.end() && !control) return {own->second, device::Motion::kCount};
  return bindings_.Find(keyval, control);
}

void HandEvents::AskKey(std::function<void(std::uint32_t)> told) {
  if (const auto former = std::exchange(asked_, std::move(told))) former(0);
}

bool HandEvents::OnKeyPressed(guint keyval, guint, Gdk::ModifierType state) {
  using Gdk::ModifierType;
  if (asked_) {
    // a key of its own only: Shift and Ctrl are still to be followed by one
    if (keyval >= GDK_KEY_Shift_L && keyval <= GDK_KEY_Hyper_R) return true;
    const auto told = std::exchange(asked_, nullptr);
    told(keyval == GDK_KEY_Escape ? 0 : keyval);
    return true;
  }
  if ((state & (ModifierType::ALT_MASK | ModifierType::SUPER_MASK)) != ModifierType{}) return false;
  const bool has_control = (state & ModifierType::CONTROL_MASK) != ModifierType{};
  const presenter::KeyMeaning meaning = FindMeaning(keyval, has_control);
  if (is_resting_) {
    const bool is_windows =
        meaning.action == presenter::Action::kQuit || meaning.action == presenter::Action::kToggleFullscreen;
    if (!is_windows) return use_key_ && use_key_(keyval, state, true);
  }
  if (meaning.action == presenter::Action::kNone) return false;
  if (!has_control && IsFocusInPanel() && !presenter::WorksInPanel(meaning.action)) return false;
  const bool is_letter = !has_control && gdk_keyval_to_unicode(keyval) > ' ';
  if (is_letter && IsTyping()) return false;
  const bool is_repeat = std::find(held_.begin(), held_.end(), keyval) != held_.end();
  if (is_repeat) return true;
  held_.push_back(keyval);
  if (const std::optional<presenter::Pedal> pedal = FindPedal(meaning.action)) {
    if (control_ != nullptr) control_->SetPedal(*pedal, true);
    return true;
  }
  switch (meaning.action) {
    case presenter::Action::kMove:
      if (control_ != nullptr && !control_->IsPaused()) control_->Device().SetKey(meaning.motion, true);
      break;
    case presenter::Action::kHoldLaparoscope:
      if (control_ != nullptr) control_->HoldLaparoscope(true);
      break;
    default:  // Esc among them: whoever hears it gives the pointer back
      signal_action_.emit(meaning.action);
  }
  return true;
}

void HandEvents::OnKeyReleased(guint keyval, guint, Gdk::ModifierType state) {
  std::erase(held_, keyval);
  if (is_resting_) {
    if (use_key_) use_key_(keyval, state, false);
    return;
  }
  const presenter::KeyMeaning meaning = FindMeaning(keyval, false);
  if (control_ == nullptr) return;
  if (const std::optional<presenter::Pedal> pedal = FindPedal(meaning.action))
    control_->SetPedal(*pedal, false);
  if (meaning.action == presenter::Action::kMove) control_->Device().SetKey(meaning.motion, false);
  if (meaning.action == presenter::Action::kHoldLaparoscope) control_->HoldLaparoscope(false);
}

void HandEvents::OnMotion(const PointerLock::Motion& motion) {
  if (control_ == nullptr || control_->IsPaused()) return;
  if (MovesSomething()) control_->Device().MovePointer(motion.dx, motion.dy);
}

/// In a camera task the mouse has the laparoscope all the time, and moves it once it was taken by a click.
bool HandEvents::MovesSomething() const {
  return is_taken_ || (control_->IsLaparoscopeHeld() && !control_->IsCameraTask());
}

bool HandEvents::OnPicturePointer(const Glib::RefPtr<const Gdk::Event>& event) {
  const Gdk::Event::Type type = event->get_event_type();
  if (type != Gdk::Event::Type::BUTTON_PRESS && type != Gdk::Event::Type::BUTTON_RELEASE) return false;
  OnButton(event->get_button(), type == Gdk::Event::Type::BUTTON_PRESS);
  return true;
}

void HandEvents::OnButton(guint button, bool is_down) {
  if (is_down) picture_.grab_focus();
  if (control_ == nullptr || button < kFirstButton || button > kLastButton) return;
  const auto act = bindings_.ActOf(static_cast<presenter::MouseButton>(button));
  if (act == presenter::ButtonAct::kLook) {
    control_->HoldLaparoscope(is_down);
    return;
  }
  if (is_down && !is_taken_) {
    // the click that takes the pointer moves no jaw
    if (button == kFirstButton && !control_->IsDemonstration()) {
      is_taken_ = true;
      FollowPause();
      signal_taken_.emit();
    }
    return;
  }
  if (control_->IsPaused()) is_down = false;
  if (act == presenter::ButtonAct::kCloseJaws) control_->Device().SetKey(device::Motion::kCloseJaw, is_down);
  if (act == presenter::ButtonAct::kOpenJaws) control_->Device().SetKey(device::Motion::kOpenJaw, is_down);
}

}  // namespace trocar::app
