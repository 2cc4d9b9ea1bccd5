// SPDX-License-Identifier: Apache-2.0
/// \file mouse_keyboard.h  Two instruments and the laparoscope from a mouse and a keyboard. Pure logic: no
/// window, no clock of its own; whoever has the events calls in.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/device/driver.h"

namespace trocar::device {

/// Order of the samples of Read().
enum Channel { kLeftHand = 0, kRightHand = 1, kLaparoscope = 2 };
inline constexpr int kChannelCount = 3;

/// Motion by a key or mouse button while it is held.
enum class Motion {
  kRight,
  kLeft,
  kUp,
  kDown,  ///< across the picture
  kIn,
  kOut,  ///< deeper into the body, back out
  kSpinRight,
  kSpinLeft,  ///< about the shaft
  kCloseJaw,
  kOpenJaw,
  kCount
};

/// Which joint rates move the tip by one metre.
struct JointRates {
  double pan = 0;    ///< [rad/m]
  double tilt = 0;   ///< [rad/m]
  double depth = 0;  ///< [m/m]
};

/// Joint rates that move the tip along the picture's axes.
struct PointerMap {
  JointRates right, up, away;
};

struct MouseKeyboardSettings {
  /// false (default, for beginners): the tip follows the mouse in the picture. true: the mouse is the handle,
  /// as in a real trocar: sideways the tip goes the other way, d / (L - d) as far; along the shaft it goes
  /// the same way.
  bool mirror_fulcrum = false;
  double metres_per_pixel = 0.00015;  ///< pointer to tip, or to handle with mirror_fulcrum [m/pixel], > 0
  double metres_per_step = 0.004;     ///< of the wheel [m], > 0
  double wheel_time = 0.06;           ///< time constant in which a wheel step is walked [s], > 0
  double tip_rate = 0.06;             ///< of a held direction key [m/s], > 0
  double spin_rate = 1.8;             ///< [rad/s], > 0
  double jaw_rate = 2.0;              ///< [rad/s], > 0
  double ramp_time = 0.12;            ///< from rest to full rate and back [s], > 0
  double max_pointer_speed = 1.0;     ///< faster pointer motion is cut off, never saved up [m/s], > 0
  double shaft_length = 0.33;         ///< L, from tip to handle [m], > max_depth of every channel
  std::array<HandLimits, kChannelCount> limits;
};

/// A driver whose events come from calls. One channel is chosen and moves; the others hold still.
class MouseKeyboard : public Driver {
 public:
  explicit MouseKeyboard(const MouseKeyboardSettings& settings = {});

  /// Puts a channel somewhere at rest, for example at its home pose; clamped to the limits.
  /// A sample that is not finite is ignored.
  void Place(Channel channel, const HandSample& sample) noexcept;

  /// The channel that moves from now on; the former one stops where it is. kRightHand at first.
  void Choose(Channel channel) noexcept;
  Channel GetChosen() const noexcept { return chosen_; }

  /// How the picture lies: which joints move this channel's tip right, up and away. Without it the picture is
  /// taken to look along the shaft: right turns -pan, up turns +tilt, away inserts.
  void SetPointerMap(Channel channel, const PointerMap& map) noexcept;
  void SetMirrorFulcrum(bool is_mirrored) noexcept { settings_.mirror_fulcrum = is_mirrored; }
  /// Ignored unless positive and finite.
  void SetMetresPerPixel(double metres) noexcept;

  /// Pointer motion since the last call [pixels], x to the right, y down as windows count.
  void MovePointer(double dx, double dy) noexcept;
  /// Wheel [steps], positive turns away from the person and moves the tip away: into the picture, or with
  /// mirror_fulcrum along the shaft.
  void Scroll(double steps) noexcept;
  void SetKey(Motion motion, bool is_down) noexcept;
  /// As if every key were let go; for a window that loses the keyboard. Wheel motion under way ends too.
  void ReleaseAll() noexcept;

  /// Lets `dt` pass; does nothing unless active.
  ///
  /// \param dt  [s]; NaN and negative count as 0, and no more than kLongestStep at once, so that a window
  /// that stood
  ///            still makes no jump
  void Advance(double dt) noexcept;
  static constexpr double kLongestStep = 0.1;  // [s]

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override;
  void DoCleanup() noexcept override;
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  /// Directions that a held key moves in, each with its own ramp.
  enum Axis { kAxisRight, kAxisUp, kAxisAway, kAxisSpin, kAxisJaw, kAxisCount };

  /// Moves the chosen tip (or handle) by metres along the picture's axes.
  void MoveInPicture(double right, double up, double away) noexcept;
  PointerMap CalcMap() const noexcept;

  MouseKeyboardSettings settings_;
  std::array<HandSample, kChannelCount> samples_;
  std::array<PointerMap, kChannelCount> maps_{};
  std::array<bool, kChannelCount> has_map_{};
  Channel chosen_ = kRightHand;
  std::array<bool, static_cast<int>(Motion::kCount)> is_down_{};
  std::array<double, kAxisCount> rates_{};     // of the chosen channel, as a fraction of the full rate [-]
  double pointer_right_ = 0, pointer_up_ = 0;  // since the last Advance [m]
  double wheel_ = 0;                           // still to walk [m]
  double time_ = 0;                            // [s]
  bool is_fresh_ = false;
};

}  // namespace trocar::device
