// SPDX-License-Identifier: Apache-2.0
/// \file hand_events.h  Mouse and keyboard events of the window, given to the device and named as actions.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pointer_lock.h"
#include "trocar/presenter/key_bindings.h"
#include "trocar/presenter/session_control.h"
#include "trocar/presenter/simulator_commands.h"

namespace trocar::app {

/// Takes the pointer with a click into the picture, gives it back with Esc or when the window loses the
/// keyboard.
///
/// Where the display lets nobody hold the pointer (PointerLock), the hidden pointer moves the tip while it is over the picture;
/// where it leaves, the hand stands still, and where it comes back the hand goes on: lift and set down again, as a mouse.
class HandEvents {
 public:
  HandEvents(Gtk::Window& window, Gtk::Widget& picture, Gtk::Widget& panel);

  void SetControl(presenter::SessionControl* control) { control_ = control; }
  /// Gives keys an act in place of what they do otherwise: foot pedals that are keyboards.
  /// \param keys  by name, as GDK has it: "F13", "b"
  /// \return the names that are no key, or Escape, which always stops the force
  std::vector<std::string> SetKeys(const std::map<std::string, device::HandAct>& keys);
  /// Sets the functions of keys and buttons.
  void SetBindings(const presenter::KeyBindings& bindings) { bindings_ = bindings; }
  /// The next key that is pressed is told to the function and does nothing else; Esc tells 0.
  void AskKey(std::function<void(std::uint32_t)> told);
  bool IsPointerTaken() const { return is_taken_; }
  /// Whether a pointer that is taken stays over the picture.
  bool CanHoldPointer() { return lock_.CanHold(); }
  /// Keys go to somebody else, who has the whole window: only Ctrl+Q and full screen stay.
  void SetResting(bool is_resting) { is_resting_ = is_resting; }
  /// \param use  what a key means while the hands rest; it returns whether it was used
  void SignalKey(std::function<bool(guint, Gdk::ModifierType, bool is_down)> use) {
    use_key_ = std::move(use);
  }
  void ReleasePointer();
  /// The pointer is free while the simulation is paused, and held again when it goes on. Once a frame.
  void FollowPause();
  /// Everything but motion.
  sigc::signal<void(presenter::Action)>& SignalAction() { return signal_action_; }
  /// A click into the picture has taken the pointer.
  sigc::signal<void()>& SignalTaken() { return signal_taken_; }

 private:
  bool OnKeyPressed(guint keyval, guint keycode, Gdk::ModifierType state);
  void OnKeyReleased(guint keyval, guint keycode, Gdk::ModifierType state);
  void OnMotion(const PointerLock::Motion& motion);
  bool OnPicturePointer(const Glib::RefPtr<const Gdk::Event>& event);
  void OnButton(guint button, bool is_down);
  void ReleaseAll();
  bool IsFocusInPanel() const;
  bool IsTyping() const;
  bool MovesSomething() const;
  presenter::KeyMeaning FindMeaning(guint keyval, bool control) const;

  Gtk::Window& window_;
  Gtk::Widget& picture_;
  Gtk::Widget& panel_;
  presenter::SessionControl* control_ = nullptr;
  presenter::KeyBindings bindings_;
  std::function<void(std::uint32_t)> asked_;  // waits for a key; may be empty
  PointerLock lock_;
  bool is_resting_ = false;
  std::function<bool(guint, Gdk::ModifierType, bool)> use_key_;
  bool is_taken_ = false, is_held_wanted_ = false;
  std::vector<guint> held_;  // key symbols, so that repeats toggle nothing
  std::map<guint, presenter::Action> own_keys_;
  sigc::signal<void(presenter::Action)> signal_action_;
  sigc::signal<void()> signal_taken_;
};

}  // namespace trocar::app
