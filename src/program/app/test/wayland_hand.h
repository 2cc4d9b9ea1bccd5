// SPDX-License-Identifier: Apache-2.0
/// \file wayland_hand.h  A mouse of its own on a Wayland display, for tests of windows.
/// Source: wlr-virtual-pointer (unstable, version 1), which Sway and other compositors of its family speak. Debian has no
/// description of it from which a scanner could make code, so what is used of it stands here.
#pragma once

#include <wayland-client.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>

namespace trocar::test {

class WaylandHand {
 public:
  WaylandHand() : display_(wl_display_connect(nullptr)) {
    if (display_ == nullptr) return;
    wl_registry* registry = wl_display_get_registry(display_);
    static constexpr wl_registry_listener kListener = {TakeGlobal, [](void*, wl_registry*, std::uint32_t) {}};
    wl_registry_add_listener(registry, &kListener, this);
    wl_display_roundtrip(display_);
    wl_registry_destroy(registry);
    if (manager_ == nullptr) return;
    pointer_ = wl_proxy_marshal_flags(manager_, kCreate, &kPointer, 1, 0, nullptr, nullptr);
    wl_display_roundtrip(display_);
  }
  ~WaylandHand() {
    if (display_ != nullptr) wl_display_disconnect(display_);
  }
  WaylandHand(const WaylandHand&) = delete;
  WaylandHand& operator=(const WaylandHand&) = delete;

  bool IsThere() const { return pointer_ != nullptr; }

  /// To a place of a display of width x height pixels.
  void MoveTo(unsigned x, unsigned y, unsigned width, unsigned height) {
    wl_proxy_marshal_flags(pointer_, kMoveTo, nullptr, 1, 0, Now(), x, y, width, height);
    Frame();
  }
  /// By so many pixels, in steps as a mouse makes them.
  void MoveBy(int dx, int dy, int steps) {
    for (int i = 0; i < steps; ++i) {
      wl_proxy_marshal_flags(pointer_, kMove, nullptr, 1, 0, Now(),
                             wl_fixed_from_double(static_cast<double>(dx) / steps),
                             wl_fixed_from_double(static_cast<double>(dy) / steps));
      Frame();
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
  }
  void Click() {
    constexpr std::uint32_t kLeftButton = 0x110;
    for (const std::uint32_t is_down : {1u, 0u}) {
      wl_proxy_marshal_flags(pointer_, kButton, nullptr, 1, 0, Now(), kLeftButton, is_down);
      Frame();
      std::this_thread::sleep_for(std::chrono::milliseconds(120));
    }
  }

 private:
  static constexpr std::uint32_t kCreate = 0;  // of the manager's requests
  static constexpr std::uint32_t kMove = 0, kMoveTo = 1, kButton = 2, kFrame = 4;  // of the pointer's

  static std::uint32_t Now() {
    return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(
                                          std::chrono::steady_clock::now().time_since_epoch())
                                          .count());
  }
  void Frame() {
    wl_proxy_marshal_flags(pointer_, kFrame, nullptr, 1, 0);
    wl_display_flush(display_);
  }
  static void TakeGlobal(void* data, wl_registry* registry, std::uint32_t name, const char* interface,
                         std::uint32_t /*version*/) {
    auto& hand = *static_cast<WaylandHand*>(data);
    if (std::strcmp(interface, kManager.name) == 0)
      hand.manager_ = static_cast<wl_proxy*>(wl_registry_bind(registry, name, &kManager, 1));
  }

  // requests up to the last that is used, with their arguments: u number, f fixed, ? may be none, o object, n new one
  static const std::array<const wl_interface*, 8> kNothing;
  static const std::array<const wl_interface*, 2> kMade;
  static const std::array<wl_message, 5> kPointerRequests;
  static const std::array<wl_message, 1> kManagerRequests;
  static const wl_interface kPointer, kManager;

  wl_display* display_;
  wl_proxy* manager_ = nullptr;
  wl_proxy* pointer_ = nullptr;
};

inline const std::array<const wl_interface*, 8> WaylandHand::kNothing{};
inline const std::array<const wl_interface*, 2> WaylandHand::kMade = {&wl_seat_interface, &kPointer};
inline const std::array<wl_message, 5> WaylandHand::kPointerRequests = {
    {{"motion", "uff", const_cast<const wl_interface**>(kNothing.data())},
     {"motion_absolute", "uuuuu", const_cast<const wl_interface**>(kNothing.data())},
     {"button", "uuu", const_cast<const wl_interface**>(kNothing.data())},
     {"axis", "uuf", const_cast<const wl_interface**>(kNothing.data())},
     {"frame", "", const_cast<const wl_interface**>(kNothing.data())}}};
inline const std::array<wl_message, 1> WaylandHand::kManagerRequests = {
    {{"create_virtual_pointer", "?on", const_cast<const wl_interface**>(kMade.data())}}};
inline const wl_interface WaylandHand::kPointer = {"zwlr_virtual_pointer_v1", 1, kPointerRequests.size(),
                                                   kPointerRequests.data(),   0, nullptr};
inline const wl_interface WaylandHand::kManager = {
    "zwlr_virtual_pointer_manager_v1", 1, kManagerRequests.size(), kManagerRequests.data(), 0, nullptr};

}  // namespace trocar::test
