// SPDX-License-Identifier: Apache-2.0
/// \file rate_hands.h  Hands from devices that say how fast, not where: gamepads and SpaceMice.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "trocar/device/driver.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/device/ports.h"

namespace trocar::device {

/// How fast the joints of a hand move.
struct HandRates {
  double pan = 0, tilt = 0, spin = 0;  ///< [rad/s]
  double depth = 0;                    ///< [m/s]
  double jaw = 0;                      ///< [rad/s]
};
/// Moves a hand on by `dt` [s] within its limits.
/// \note Real-time safe.
void MoveHand(const HandRates& rates, double dt, const HandLimits& limits, HandSample& hand) noexcept;
/// A stick or cap's deflection without the middle, where it never rests at exactly 0; -1 to 1. NaN gives 0.
double WithoutDeadZone(double deflection, double dead_zone) noexcept;

/// Hands that move from where they were placed, by as much as each Read() says.
class RateHands : public Driver {
 public:
  void PlaceHand(int channel, const HandSample& home) noexcept override;

 protected:
  /// \param clock  outlives the driver
  RateHands(std::string name, Clock& clock);
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override {}

  /// Time since the last Read() [s]; no more than a moment, so that a program that stood still makes no jump.
  double Step() noexcept;
  HandSample& Hand(Channel channel) noexcept { return hands_[channel]; }
  /// Writes both instruments as seen now, and the laparoscope as not seen.
  ReadStatus Publish(std::span<HandSample> samples) noexcept;

 private:
  Clock& clock_;
  std::array<HandSample, kChannelCount> hands_;
  double time_ = 0;  // of the last Read [s]
};

// --- gamepad

/// Sticks to the right and down are positive, as SDL has it.
struct GamepadState {
  struct Side {
    double x = 0, y = 0;  ///< stick, -1 to 1
    double trigger = 0;   ///< 0 to 1, pulled
    bool is_shoulder_down = false;
    /// left: direction pad down, right, left, up, stick pressed, Back; right: A, B, X, Y, stick pressed, Start
    std::uint32_t buttons = 0;
  };
  std::array<Side, 2> sides;  ///< left, right
};

/// Where the state comes from: SDL, or a test.
class GamepadSource {
 public:
  virtual ~GamepadSource() = default;
  /// \return kDeviceLost where there is none, kDeviceUnsupported in a build without SDL
  virtual base::Status Open() = 0;
  /// \return false where the gamepad is gone
  virtual bool Poll(GamepadState& state) noexcept = 0;
  virtual void Close() noexcept = 0;
};
/// The first gamepad that SDL finds.
std::unique_ptr<GamepadSource> MakeSdlGamepad();
/// Names of the gamepads that are plugged in.
std::vector<std::string> ListGamepads();

/// Each stick moves the tip of its hand across; with the shoulder button held, in and out, and it turns the shaft. The
/// trigger closes the jaws: as far as it is pulled. Direction pad and letters are the buttons of left and right hand.
class Gamepad : public RateHands {
 public:
  /// \param clock  outlives the driver
  Gamepad(std::unique_ptr<GamepadSource> source, Clock& clock);

 private:
  base::Status DoConfigure() override { return source_->Open(); }
  void DoCleanup() noexcept override { source_->Close(); }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  std::unique_ptr<GamepadSource> source_;
};

// --- SpaceMouse

/// A cap that is pushed and turned: x right, y up, z towards the person; counts as the daemon sends them, about -350 to 350.
struct SpaceMouseState {
  std::array<double, 3> push{}, turn{};
  std::array<bool, 2> is_button_down{};
  std::uint32_t more_buttons = 0;  ///< bit n is the device's button n + 3, where it has so many
};

class SpaceMouseSource {
 public:
  virtual ~SpaceMouseSource() = default;
  virtual base::Status Open() = 0;
  /// \return false where the daemon or the device is gone
  virtual bool Poll(SpaceMouseState& state) noexcept = 0;
  virtual void Close() noexcept = 0;
};
/// Through spacenavd, which must run.
/// \param socket  the daemon's; empty: where it lies by default. Kept in the environment variable SPNAV_SOCKET, by which
///                the library finds it
std::unique_ptr<SpaceMouseSource> MakeSpacenavSource(const std::string& socket = {});
/// True if a spacenavd answers.
bool IsSpacenavThere();

/// Moves one hand; the left button closes and opens its jaws while held, the right one changes hands, further ones are that
/// hand's buttons.
class SpaceMouse : public RateHands {
 public:
  /// \param clock  outlives the driver
  SpaceMouse(std::unique_ptr<SpaceMouseSource> source, Clock& clock);

 private:
  base::Status DoConfigure() override { return source_->Open(); }
  base::Status DoActivate() override;
  void DoCleanup() noexcept override { source_->Close(); }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  std::unique_ptr<SpaceMouseSource> source_;
  Channel chosen_ = kRightHand;
  bool was_switch_down_ = false;
};

}  // namespace trocar::device
