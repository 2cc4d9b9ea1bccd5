// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/rate_hands.h"

#include <cstdlib>

#include "trocar/device/local_port.h"

#if TROCAR_HAS_SPNAV
#include <sys/socket.h>

// last: it includes Xlib, whose macro Status would change our own name
#include <spnav.h>
#undef Status
#endif

namespace trocar::device {
namespace {

constexpr const char* kSocketVariable = "SPNAV_SOCKET";

#if TROCAR_HAS_SPNAV
/// libspnav keeps one connection for the whole program.
class SpacenavSource : public SpaceMouseSource {
 public:
  ~SpacenavSource() override { Close(); }

  base::Status Open() override {
    state_ = {};
    if (spnav_open() != -1) {
      is_open_ = true;
      return {};
    }
    return base::Error{
        base::ErrorCode::kDeviceLost,
        "spacenavd does not answer: install spacenavd, start it (sudo systemctl start spacenavd), plug "
        "the SpaceMouse in"};
  }

  bool Poll(SpaceMouseState& state) noexcept override {
    spnav_event event;
    // bounded, so that a flood cannot hold it up
    for (int i = 0; i < 64 && spnav_poll_event(&event) != 0; ++i) {
      if (event.type == SPNAV_EVENT_MOTION) {
        const spnav_event_motion& motion = event.motion;
        // the daemon's z points away from the person
        state_.push = {double(motion.x), double(motion.y), -double(motion.z)};
        state_.turn = {double(motion.rx), double(motion.ry), -double(motion.rz)};
      } else if (event.type == SPNAV_EVENT_BUTTON) {
        SetButton(event.button.bnum, event.button.press != 0);
      }
    }
    state = state_;
    // the library does not say that the daemon has ended
    char byte = 0;
    return ::recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) != 0;
  }

  void Close() noexcept override {
    if (is_open_) spnav_close();
    is_open_ = false;
  }

 private:
  void SetButton(int number, bool is_down) noexcept {
    constexpr int kOwn = 2, kMore = 32;
    if (number < 0 || number >= kOwn + kMore) return;
    if (number < kOwn) {
      state_.is_button_down[static_cast<std::size_t>(number)] = is_down;
      return;
    }
    const std::uint32_t bit = std::uint32_t{1} << (number - kOwn);
    state_.more_buttons = is_down ? state_.more_buttons | bit : state_.more_buttons & ~bit;
  }

  SpaceMouseState state_;
  bool is_open_ = false;
};
#else
class SpacenavSource : public SpaceMouseSource {
 public:
  base::Status Open() override {
    return base::Error{base::ErrorCode::kDeviceUnsupported,
                       "this build has no SpaceMouse: install libspnav-dev and build again"};
  }
  bool Poll(SpaceMouseState&) noexcept override { return false; }
  void Close() noexcept override {}
};
#endif

}  // namespace

std::unique_ptr<SpaceMouseSource> MakeSpacenavSource(const std::string& socket) {
  if (!socket.empty()) ::setenv(kSocketVariable, socket.c_str(), 1);
  return std::make_unique<SpacenavSource>();
}

bool IsSpacenavThere() {
#if !TROCAR_HAS_SPNAV
  return false;
#endif
  const char* const named = std::getenv(kSocketVariable);
  return ConnectLocal(named != nullptr ? named : "/var/run/spnav.sock", LocalLine::kStream).ok();
}

}  // namespace trocar::device
