// SPDX-License-Identifier: Apache-2.0
/// \file hand_events.h  Mouse and keyboard events of the window, given to the device and named as actions.
#pragma once

#include <gtkmm.h>

#include <map>
#include <string>
#include <vector>

#include "trocar/app/session_control.h"
#include "trocar/app/simulator_commands.h"

namespace trocar::app {

/// Takes the pointer with a click into the picture, gives it back with Esc or when the window loses the
/// keyboard.
///
/// GTK 4 cannot hold a pointer inside a widget. So the hidden pointer moves the tip while it is over the
/// picture; where it leaves, the hand stands still, and where it comes back the hand goes on: lift and set
/// down again, as a mouse.
class HandEvents {
 public:
  HandEvents(Gtk::Window& window, Gtk::Widget& picture, Gtk::Widget& panel);

  void SetControl(SessionControl* control) { control_ = control; }
  /// Gives keys an act in place of what they do otherwise: foot pedals that are keyboards.
  /// \param keys  by name, as GDK has it: "F13", "b"
  /// \return the names that are no key, or Escape, which always stops the force
  std::vector<std::string> SetKeys(const std::map<std::string, device::HandAct>& keys);
  /// Left-handed, letters and mouse buttons change sides.
  void SetLayout(KeyLayout layout) { layout_ = layout; }
  bool IsPointerTaken() const { return is_taken_; }
  void ReleasePointer();
  /// Everything but motion.
  sigc::signal<void(Action)>& SignalAction() { return signal_action_; }
  /// A click into the picture has taken the pointer.
  sigc::signal<void()>& SignalTaken() { return signal_taken_; }

 private:
  bool OnKeyPressed(guint keyval, guint keycode, Gdk::ModifierType state);
  void OnKeyReleased(guint keyval, guint keycode, Gdk::ModifierType state);
  void OnMotion(double x, double y);
  bool OnPicturePointer(const Glib::RefPtr<const Gdk::Event>& event);
  void OnButton(guint button, bool is_down);
  void ReleaseAll();
  bool IsFocusInPanel() const;
  bool IsTyping() const;
  KeyMeaning FindMeaning(guint keyval, bool control) const;

  Gtk::Window& window_;
  Gtk::Widget& picture_;
  Gtk::Widget& panel_;
  SessionControl* control_ = nullptr;
  KeyLayout layout_ = KeyLayout::kRightHanded;
  bool is_taken_ = false;
  bool has_last_ = false;
  double last_x_ = 0, last_y_ = 0;  // [pixels]
  std::vector<guint> held_;         // key symbols, so that repeats toggle nothing
  std::map<guint, Action> own_keys_;
  sigc::signal<void(Action)> signal_action_;
  sigc::signal<void()> signal_taken_;
};

}  // namespace trocar::app
