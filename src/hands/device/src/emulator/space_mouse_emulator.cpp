// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

constexpr double kPeriod = 1.0 / 60.0;  // [s]
constexpr double kLongestStep = 0.250;  // as in the trackers [s]
constexpr double kTwoPi = 6.283185307179586;

/// spacenavd's first protocol: eight words an event, as the machine stores them.
using Event = std::array<std::int32_t, 8>;
enum : std::int32_t { kMotion = 0, kPress = 1, kRelease = 2 };

void Append(std::string& bytes, const Event& event) {
  char raw[sizeof event];
  std::memcpy(raw, event.data(), sizeof raw);
  bytes.append(raw, sizeof raw);
}

std::int32_t Round(double value) noexcept {
  return static_cast<std::int32_t>(std::lround(value));
}

class SpaceMouseEmulator : public Emulator {
 public:
  explicit SpaceMouseEmulator(CapMotion motion) : motion_(std::move(motion)) {}

  // later protocols ask; a daemon that knows only the first says nothing
  void Receive(std::string_view) override {}
  void Connect() override { is_down_ = {}; }
  std::string Advance(double time) override {
    std::string bytes;
    if (next_ < time - kLongestStep) next_ = time;
    for (; next_ <= time; next_ += kPeriod) {
      const SpaceMouseState cap = motion_(next_);
      // the daemon's z points away from the person
      Append(bytes, {kMotion, Round(cap.push[0]), Round(cap.push[1]), Round(-cap.push[2]), Round(cap.turn[0]),
                     Round(cap.turn[1]), Round(-cap.turn[2]), Round(1e3 * kPeriod)});
      for (std::int32_t button = 0; button < 2; ++button) {
        const bool is_down = cap.is_button_down[static_cast<std::size_t>(button)];
        if (std::exchange(is_down_[static_cast<std::size_t>(button)], is_down) != is_down)
          Append(bytes, {is_down ? kPress : kRelease, button, 0, 0, 0, 0, 0, 0});
      }
    }
    return bytes;
  }

 private:
  CapMotion motion_;
  std::array<bool, 2> is_down_{};
  double next_ = 0;  // [s]
};

}  // namespace

SpaceMouseState CalcCapMotion(double time) noexcept {
  constexpr double kMost = 200;  // counts
  SpaceMouseState cap;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double phase = kTwoPi * time / (2.3 + 0.7 * static_cast<double>(axis));
    cap.push[axis] = kMost * std::sin(phase);
    cap.turn[axis] = kMost * std::cos(phase);
  }
  cap.is_button_down[0] = std::fmod(time, 3.0) > 1.5;
  return cap;
}

std::unique_ptr<Emulator> MakeSpaceMouseEmulator(CapMotion motion) {
  return std::make_unique<SpaceMouseEmulator>(std::move(motion));
}

}  // namespace trocar::device
