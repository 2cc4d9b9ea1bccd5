// SPDX-License-Identifier: Apache-2.0
#include "wayland_pointer.h"

#include <gdk/gdk.h>

#include <string_view>
#include <utility>
#ifdef GDK_WINDOWING_WAYLAND
#include <gdk/wayland/gdkwayland.h>

// made by wayland-scanner: declarations, then the tables, in this file alone
#include "pointer-constraints-client.h"
#include "pointer-constraints-code.h"
#include "relative-pointer-client.h"
#include "relative-pointer-code.h"
#endif

namespace trocar::app {

#ifdef GDK_WINDOWING_WAYLAND

struct WaylandPointer::Content {
  Gtk::Widget& widget;
  std::function<void(double, double)> moved;
  zwp_pointer_constraints_v1* constraints = nullptr;
  zwp_relative_pointer_manager_v1* motions = nullptr;
  zwp_locked_pointer_v1* lock = nullptr;
  zwp_relative_pointer_v1* pointer = nullptr;
  bool is_locked = false;

  Content(Gtk::Widget& wanted, std::function<void(double, double)> told)
      : widget(wanted), moved(std::move(told)) {}
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    Unlock();
    if (constraints != nullptr) zwp_pointer_constraints_v1_destroy(constraints);
    if (motions != nullptr) zwp_relative_pointer_manager_v1_destroy(motions);
  }

  void FindProtocols(wl_display* display);
  bool Lock();
  void Unlock();
};

namespace {

void TakeGlobal(void* data, wl_registry* registry, std::uint32_t name, const char* interface,
                std::uint32_t /*version*/) {
  auto& content = *static_cast<WaylandPointer::Content*>(data);
  const auto bind = [&](const wl_interface& wanted, auto*& proxy) {
    if (std::string_view(interface) != wanted.name || proxy != nullptr) return;
    proxy =
        static_cast<std::remove_reference_t<decltype(proxy)>>(wl_registry_bind(registry, name, &wanted, 1));
  };
  bind(zwp_pointer_constraints_v1_interface, content.constraints);
  bind(zwp_relative_pointer_manager_v1_interface, content.motions);
}

constexpr wl_registry_listener kRegistry = {TakeGlobal, [](void*, wl_registry*, std::uint32_t) {}};

template <bool kIsLocked>
void SetLocked(void* data, zwp_locked_pointer_v1* /*lock*/) {
  static_cast<WaylandPointer::Content*>(data)->is_locked = kIsLocked;
}
constexpr zwp_locked_pointer_v1_listener kLock = {SetLocked<true>, SetLocked<false>};

void Move(void* data, zwp_relative_pointer_v1* /*pointer*/, std::uint32_t /*time_high*/,
          std::uint32_t /*time_low*/, wl_fixed_t dx, wl_fixed_t dy, wl_fixed_t /*raw_dx*/,
          wl_fixed_t /*raw_dy*/) {
  const auto& content = *static_cast<WaylandPointer::Content*>(data);
  // before the lock is granted they are seen as places, too
  if (content.is_locked) content.moved(wl_fixed_to_double(dx), wl_fixed_to_double(dy));
}
constexpr zwp_relative_pointer_v1_listener kMotion = {Move};

}  // namespace

/// By a queue of its own, so that nothing else is handled meanwhile.
void WaylandPointer::Content::FindProtocols(wl_display* display) {
  wl_event_queue* queue = wl_display_create_queue(display);
  auto* wrapper = static_cast<wl_display*>(wl_proxy_create_wrapper(display));
  wl_proxy_set_queue(reinterpret_cast<wl_proxy*>(wrapper), queue);
  wl_registry* registry = wl_display_get_registry(wrapper);
  wl_proxy_wrapper_destroy(wrapper);
  wl_registry_add_listener(registry, &kRegistry, this);
  wl_display_roundtrip_queue(display, queue);
  wl_registry_destroy(registry);
  // what they make is told by GTK's queue
  if (constraints != nullptr) wl_proxy_set_queue(reinterpret_cast<wl_proxy*>(constraints), nullptr);
  if (motions != nullptr) wl_proxy_set_queue(reinterpret_cast<wl_proxy*>(motions), nullptr);
  wl_event_queue_destroy(queue);
}

bool WaylandPointer::Content::Lock() {
  Unlock();
  GtkNative* native = gtk_widget_get_native(widget.gobj());
  GdkSurface* surface = native == nullptr ? nullptr : gtk_native_get_surface(native);
  GdkSeat* seat = gdk_display_get_default_seat(gtk_widget_get_display(widget.gobj()));
  GdkDevice* device = seat == nullptr ? nullptr : gdk_seat_get_pointer(seat);
  if (surface == nullptr || device == nullptr) return false;
  wl_pointer* seen = gdk_wayland_device_get_wl_pointer(device);
  if (seen == nullptr) return false;
  lock =
      zwp_pointer_constraints_v1_lock_pointer(constraints, gdk_wayland_surface_get_wl_surface(surface), seen,
                                              nullptr, ZWP_POINTER_CONSTRAINTS_V1_LIFETIME_PERSISTENT);
  zwp_locked_pointer_v1_add_listener(lock, &kLock, this);
  pointer = zwp_relative_pointer_manager_v1_get_relative_pointer(motions, seen);
  zwp_relative_pointer_v1_add_listener(pointer, &kMotion, this);
  return true;
}

void WaylandPointer::Content::Unlock() {
  if (lock != nullptr) zwp_locked_pointer_v1_destroy(std::exchange(lock, nullptr));
  if (pointer != nullptr) zwp_relative_pointer_v1_destroy(std::exchange(pointer, nullptr));
  is_locked = false;
}

std::unique_ptr<WaylandPointer> WaylandPointer::Find(Gtk::Widget& widget,
                                                     std::function<void(double, double)> moved) {
  GdkDisplay* display = gtk_widget_get_display(widget.gobj());
  if (!GDK_IS_WAYLAND_DISPLAY(display)) return nullptr;
  auto content = std::make_unique<Content>(widget, std::move(moved));
  content->FindProtocols(gdk_wayland_display_get_wl_display(display));
  if (content->constraints == nullptr || content->motions == nullptr) return nullptr;
  return std::unique_ptr<WaylandPointer>(new WaylandPointer(std::move(content)));
}

bool WaylandPointer::Lock() {
  return content_->Lock();
}
void WaylandPointer::Unlock() {
  content_->Unlock();
}
bool WaylandPointer::IsLocked() const {
  return content_->is_locked;
}

#else

struct WaylandPointer::Content {};

std::unique_ptr<WaylandPointer> WaylandPointer::Find(Gtk::Widget&, std::function<void(double, double)>) {
  return nullptr;
}
bool WaylandPointer::Lock() {
  return false;
}
void WaylandPointer::Unlock() {}
bool WaylandPointer::IsLocked() const {
  return false;
}

#endif

WaylandPointer::WaylandPointer(std::unique_ptr<Content> content) : content_(std::move(content)) {}
WaylandPointer::~WaylandPointer() = default;

}  // namespace trocar::app
