// SPDX-License-Identifier: Apache-2.0
#include "pointer_lock.h"

#include <gdk/gdk.h>

#include <algorithm>
#include <cmath>
#include <utility>
#ifdef GDK_WINDOWING_X11
#include <gdk/x11/gdkx.h>
#endif

namespace trocar::app {
namespace {

/// So far from the picture's middle, as a share of its smaller side, the pointer is set back [-].
constexpr double kReach = 0.3;
/// A jump that is not seen after so many places has not come about.
constexpr int kMostWhileJumping = 12;

#ifdef GDK_WINDOWING_X11
struct XPlace {
  Display* display = nullptr;
  Window window = 0;
};

/// The picture's window; nothing where it is none of X11.
std::optional<XPlace> FindXPlace(Gtk::Widget& picture) {
  GtkNative* native = gtk_widget_get_native(picture.gobj());
  GdkSurface* surface = native == nullptr ? nullptr : gtk_native_get_surface(native);
  if (surface == nullptr || !GDK_IS_X11_SURFACE(surface)) return std::nullopt;
  return XPlace{gdk_x11_display_get_xdisplay(gdk_surface_get_display(surface)),
                gdk_x11_surface_get_xid(surface)};
}

/// A place of the picture in its window [device pixels].
std::optional<std::pair<int, int>> FindInWindow(Gtk::Widget& picture, double x, double y) {
  GtkNative* native = gtk_widget_get_native(picture.gobj());
  double out_x = 0, out_y = 0, at_x = 0, at_y = 0;
  if (native == nullptr ||
      !gtk_widget_translate_coordinates(picture.gobj(), GTK_WIDGET(native), x, y, &out_x, &out_y))
    return std::nullopt;
  gtk_native_get_surface_transform(native, &at_x, &at_y);
  const int scale = gdk_surface_get_scale_factor(gtk_native_get_surface(native));
  return std::pair(static_cast<int>(std::lround((out_x + at_x) * scale)),
                   static_cast<int>(std::lround((out_y + at_y) * scale)));
}
#endif

}  // namespace

WaylandPointer* PointerLock::FindWayland() {
  if (!std::exchange(has_looked_for_wayland_, true))
    wayland_ = WaylandPointer::Find(picture_, [this](double dx, double dy) { moved_({dx, dy}); });
  return wayland_.get();
}

bool PointerLock::CanHold() {
  if (FindWayland() != nullptr) return true;
#ifdef GDK_WINDOWING_X11
  return FindXPlace(picture_).has_value();
#else
  return false;
#endif
}

bool PointerLock::Take() {
  Forget();
  if (WaylandPointer* wayland = FindWayland()) return is_held_ = wayland->Lock();
#ifdef GDK_WINDOWING_X11
  const auto place = FindXPlace(picture_);
  if (!place) return false;
  gdk_x11_display_error_trap_push(gtk_widget_get_display(picture_.gobj()));
  const int status = XGrabPointer(place->display, place->window, True,
                                  PointerMotionMask | ButtonPressMask | ButtonReleaseMask, GrabModeAsync,
                                  GrabModeAsync, place->window, None, CurrentTime);
  const int error = gdk_x11_display_error_trap_pop(gtk_widget_get_display(picture_.gobj()));
  is_held_ = status == GrabSuccess && error == 0;
  if (is_held_) JumpToMiddle();
#endif
  return is_held_;
}

void PointerLock::Release() {
  if (!is_held_) return;
  is_held_ = false;
  if (wayland_) wayland_->Unlock();
#ifdef GDK_WINDOWING_X11
  if (const auto place = FindXPlace(picture_)) {
    XUngrabPointer(place->display, CurrentTime);
    XFlush(place->display);
  }
#endif
  Forget();
}

/// \return what the pointer has been moved since it was last seen, which would be lost
PointerLock::Motion PointerLock::JumpToMiddle() {
  Motion unseen;
#ifdef GDK_WINDOWING_X11
  const auto place = FindXPlace(picture_);
  const auto middle = FindInWindow(picture_, 0.5 * picture_.get_width(), 0.5 * picture_.get_height());
  if (!place || !middle) return unseen;
  const auto last = FindInWindow(picture_, last_x_, last_y_);
  Window root = 0, child = 0;
  int root_x = 0, root_y = 0, x = 0, y = 0;
  unsigned mask = 0;
  if (has_last_ && last &&
      XQueryPointer(place->display, place->window, &root, &child, &root_x, &root_y, &x, &y, &mask)) {
    const double scale = picture_.get_scale_factor();
    unseen = {(x - last->first) / scale, (y - last->second) / scale};
  }
  XWarpPointer(place->display, None, place->window, 0, 0, 0, 0, middle->first, middle->second);
  XFlush(place->display);
  is_jumping_ = true;
  seen_while_jumping_ = 0;
#endif
  return unseen;
}

void PointerLock::See(double x, double y) {
  // a locked pointer stays where it is; its motions come by themselves
  if (wayland_ && wayland_->IsLocked()) return Forget();
  if (const auto motion = FindMotion(x, y)) moved_(*motion);
}

/// \return how it was moved; nothing where that is not known
std::optional<PointerLock::Motion> PointerLock::FindMotion(double x, double y) {
  const double middle_x = 0.5 * picture_.get_width(), middle_y = 0.5 * picture_.get_height();
  const double off = std::hypot(x - middle_x, y - middle_y);
  const double reach = kReach * std::min(picture_.get_width(), picture_.get_height());
  if (is_jumping_) {
    // places from before the jump may still come, and have been counted; the first near the middle is after it
    if (off > 0.5 * reach && ++seen_while_jumping_ < kMostWhileJumping) return std::nullopt;
    is_jumping_ = false;
    has_last_ = true;
    last_x_ = off > 0.5 * reach ? x : middle_x;
    last_y_ = off > 0.5 * reach ? y : middle_y;
  }
  std::optional<Motion> motion;
  if (has_last_) motion = Motion{x - last_x_, y - last_y_};
  has_last_ = true;
  last_x_ = x, last_y_ = y;
  if (is_held_ && !wayland_ && off > reach) {
    const Motion unseen = JumpToMiddle();
    if (motion) motion = Motion{motion->dx + unseen.dx, motion->dy + unseen.dy};
  }
  return motion;
}

}  // namespace trocar::app
