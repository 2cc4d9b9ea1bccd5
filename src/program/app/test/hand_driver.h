// SPDX-License-Identifier: Apache-2.0
/// \file hand_driver.h  A person's hand on mouse and keys: brings the tip of a tool to a place in the scene with real events
/// alone, knowing only how the picture lies to the joints.
#pragma once

#include <X11/keysym.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "trocar/presenter/level_horizon.h"
#include "trocar/presenter/pointer_map.h"
#include "trocar/render/frame.h"
#include "trocar/scene/scene.h"
#include "x_screen.h"

namespace trocar::test {

class HandDriver {
 public:
  /// \param screen  with the simulator's window, hands at home
  HandDriver(const Screen& screen, const scene::Scene& scene)
      : screen_(&screen),
        scene_(&scene),
        X_world_view_(
            presenter::LevelHorizon(scene::CalcLaparoscopePose(scene.laparoscope, scene.laparoscope.home))) {
    for (const int hand : {instrument::kLeft, instrument::kRight})
      joints_[static_cast<std::size_t>(hand)] = scene.instruments[static_cast<std::size_t>(hand)].home;
  }

  /// Finds the picture in the window, and takes the mouse with a click into it. \return whether there is one
  bool Take() {
    const WindowPicture picture = screen_->Look();
    const auto is_black = [&](unsigned y) {
      const unsigned char* p = picture.At(kEdge, y);
      return p[0] + p[1] + p[2] < 6;
    };
    unsigned top = 0, bottom = 0;
    for (unsigned y = 30; y + 10 < picture.height; ++y) {
      if (!is_black(y)) continue;
      if (top == 0) top = y;
      bottom = y;
    }
    if (bottom < top + 300) return false;
    pixels_ = render::kMaskDiameter * (bottom - top + 1);
    screen_->SwitchOffAcceleration();
    screen_->Click(static_cast<int>(picture.width) / 2, static_cast<int>(top + bottom) / 2);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    // each turn of the wheel is a step of its own, as this driver reckons
    screen_->Press(XK_8);
    return true;
  }

  void Choose(instrument::Hand hand) {
    hand_ = hand;
    screen_->Press(hand == instrument::kLeft ? XK_1 : XK_2);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  void OpenJaws() const { screen_->Hold(XK_b, std::chrono::milliseconds(1500)); }
  void CloseJaws() const { screen_->Hold(XK_g, std::chrono::milliseconds(1800)); }

  math::Pose Tool(instrument::Hand hand) const {
    return instrument::CalcToolPose(scene_->instruments[hand].p_world_port, joints_[hand]);
  }
  math::Vec3 Tip() const { return Tool(hand_).translation; }
  /// A place so far back on the line from a target to the trocar, or beyond it where negative.
  math::Vec3 Behind(const math::Vec3& p_world, double back) const {
    return p_world + back * math::Normalized(scene_->instruments[hand_].p_world_port - p_world);
  }

  /// In short steps, as a careful person does.
  void MoveTo(const math::Vec3& p_world) {
    const math::Vec3 from = Tip();
    const int steps = std::max(1, static_cast<int>(std::ceil(math::Distance(from, p_world) / kStep)));
    for (int step = 1; step <= steps; ++step)
      Approach(math::Lerp(from, p_world, static_cast<double>(step) / steps));
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
  }

  /// Tip that brings something held, in the tool's frame, to a place.
  math::Vec3 FindTip(const math::Vec3& p_tool, const math::Vec3& p_world) const {
    math::Vec3 tip = Tip();
    for (int round = 0; round < 10; ++round) {
      const auto& setup = scene_->instruments[hand_];
      const math::Pose X = instrument::CalcToolPose(
          setup.p_world_port, instrument::FindJoints(setup.p_world_port, tip, joints_[hand_].spin, 0));
      tip = tip + (p_world - X * p_tool);
    }
    return tip;
  }

 private:
  static constexpr unsigned kEdge = 6;         // column that is black within the picture [pixels]
  static constexpr double kStep = 0.004;       // [m]
  static constexpr double kWheelStep = 0.004;  // of MouseKeyboardSettings [m]
  static constexpr int kMostPixels = 10;       // in an event

  math::Vec3 InView(const math::Vec3& p_world) const {
    return math::Rotate(math::Inverse(X_world_view_.rotation), p_world - Tip());
  }
  void Approach(const math::Vec3& p_world) {
    // a turn of the wheel goes along the line of sight, which is a little longer than straight ahead
    const double ahead = -presenter::CalcSightLine(X_world_view_, Tip()).z * kWheelStep;
    const double away = -InView(p_world).z;
    for (int n = static_cast<int>(std::lround(away / ahead)); n != 0; n += n > 0 ? -1 : 1) {
      screen_->Turn(n > 0 ? 1 : -1);
      Go(0, 0, n > 0 ? kWheelStep : -kWheelStep);
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
    for (int round = 0; round < 60; ++round) {
      const math::Vec3 d = InView(p_world);
      const double metres =
          presenter::CalcMetresPerPixel(X_world_view_, Tip(), scene_->laparoscope.field_of_view, pixels_);
      const double far = std::max(1.0, std::hypot(d.x, d.y) / metres / kMostPixels);
      const int dx = static_cast<int>(std::lround(d.x / metres / far)),
                dy = static_cast<int>(std::lround(-d.y / metres / far));
      if (dx == 0 && dy == 0) return;
      screen_->MoveBy(dx, dy);
      Go(metres * dx, -metres * dy, 0);
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  }
  /// What the window makes of it.
  void Go(double right, double up, double away) {
    constexpr int kParts = 4;
    instrument::TrocarJoints& joints = joints_[hand_];
    for (int part = 0; part < kParts; ++part) {
      const math::Vec3 tip =
          instrument::CalcToolPose(scene_->instruments[hand_].p_world_port, joints).translation;
      const device::PointerMap map =
          presenter::CalcPointerMap(joints, X_world_view_, presenter::CalcSightLine(X_world_view_, tip));
      const auto sum = [&](double device::JointRates::*rate) {
        return (right * map.right.*rate + up * map.up.*rate + away * map.away.*rate) / kParts;
      };
      joints.pan += sum(&device::JointRates::pan);
      joints.tilt += sum(&device::JointRates::tilt);
      joints.depth += sum(&device::JointRates::depth);
    }
  }

  const Screen* screen_;
  const scene::Scene* scene_;
  math::Pose X_world_view_;
  std::array<instrument::TrocarJoints, instrument::kHandCount> joints_;
  instrument::Hand hand_ = instrument::kRight;
  double pixels_ = 700;
};

}  // namespace trocar::test
