// SPDX-License-Identifier: Apache-2.0
/// \file wayland_pointer.h  Wayland's own way to hold a pointer: it is locked where it is, and its motions are told apart from places.
/// Source: wayland-protocols, pointer-constraints and relative-pointer (both unstable, version 1).
#pragma once

#include <gtkmm.h>

#include <functional>
#include <memory>

namespace trocar::app {

class WaylandPointer {
 public:
  struct Content;

  /// \param moved  gets the motions while it is locked [pixels]
  /// \return nothing where the widget's display is none of Wayland's, or its compositor holds no pointer
  static std::unique_ptr<WaylandPointer> Find(Gtk::Widget& widget, std::function<void(double, double)> moved);
  ~WaylandPointer();
  WaylandPointer(const WaylandPointer&) = delete;
  WaylandPointer& operator=(const WaylandPointer&) = delete;

  /// Asks for the lock, which the compositor grants while the pointer is over the window and the window has the keyboard.
  /// \return whether there is a pointer and a window to ask for
  bool Lock();
  void Unlock();
  /// Whether the compositor has granted it.
  bool IsLocked() const;

 private:
  explicit WaylandPointer(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::app
