// SPDX-License-Identifier: Apache-2.0
/// \file pointer_lock.h  Keeps the hidden pointer over the picture while it moves a hand, so that a hand is never left behind.
///
/// GTK 4 has no such thing, so it is the platform's: under X11 the pointer is grabbed, confined to the window, and set back to the
/// picture's middle before it comes to an edge; under Wayland the compositor locks it. Where neither can be had nothing holds it, and
/// CanHold() says so.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <memory>
#include <optional>

#include "wayland_pointer.h"

namespace trocar::app {

class PointerLock {
 public:
  struct Motion {
    double dx = 0, dy = 0;  ///< [pixels]
  };

  /// \param moved  gets how the pointer is moved, held or not
  PointerLock(Gtk::Widget& picture, std::function<void(const Motion&)> moved)
      : picture_(picture), moved_(std::move(moved)) {}
  ~PointerLock() { Release(); }
  PointerLock(const PointerLock&) = delete;
  PointerLock& operator=(const PointerLock&) = delete;

  /// Whether the picture's display lets a pointer be held: X11 does, and most of Wayland's.
  bool CanHold();
  /// \return whether it is held, or asked for (Wayland); another program may hold it
  bool Take();
  void Release();
  /// Under Wayland once the compositor has granted it; one that never does leaves the pointer free.
  bool IsHeld() const { return is_held_ && (!wayland_ || wayland_->IsLocked()); }

  /// The pointer is seen somewhere in the picture.
  void See(double x, double y);
  /// It has left, or comes back: the next place is a beginning.
  void Forget() { has_last_ = is_jumping_ = false; }

 private:
  std::optional<Motion> FindMotion(double x, double y);
  Motion JumpToMiddle();
  WaylandPointer* FindWayland();

  Gtk::Widget& picture_;
  std::function<void(const Motion&)> moved_;
  std::unique_ptr<WaylandPointer> wayland_;
  bool has_looked_for_wayland_ = false;
  bool is_held_ = false;
  bool has_last_ = false;
  double last_x_ = 0, last_y_ = 0;  // [pixels]
  bool is_jumping_ = false;         // it has been set to the middle, and is not seen there yet
  int seen_while_jumping_ = 0;
};

}  // namespace trocar::app
