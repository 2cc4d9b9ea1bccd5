// SPDX-License-Identifier: Apache-2.0
/// \file tutorial.h  Teaches each control by having it done, and notices that it was done.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "trocar/device/mouse_keyboard.h"
#include "trocar/presenter/key_bindings.h"
#include "trocar/scene/input.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::presenter {

inline constexpr int kTutorialSteps = 10;
/// Task in which it is held: the first that has rings.
inline constexpr const char* kTutorialTask = "peg_transfer";

/// That task for a person: "peg transfer".
std::string TutorialTaskName();

/// Texts of the steps, with placeholders for keys and buttons; translated where they are shown.
std::span<const std::string_view> TutorialTexts() noexcept;

/// State of simulation and controls in a frame, from which the tutorial sees what the person does.
struct TutorialSight {
  const simulation::Snapshot* snapshot = nullptr;
  const scene::Input* input = nullptr;  ///< what the person wants
  device::Channel hand = device::kRightHand;
  bool is_pointer_taken = false, is_laparoscope_held = false, is_paused = false;
};

class Tutorial {
 public:
  /// \param step  0 to kTutorialSteps: goes on there
  void Begin(int step);
  void Leave() { is_on_ = false; }
  bool IsOn() const { return is_on_; }
  bool IsDone() const { return step_ >= kTutorialSteps; }
  int Step() const { return step_; }

  /// Looks whether the present step has been done; then the next one begins.
  /// \return true where it went on
  bool Observe(const TutorialSight& sight);
  /// "3 of 10: turn the wheel ...": what is to be done now, or that all is done; empty while it is off.
  std::string Text(const KeyBindings& bindings) const;

 private:
  bool IsStepDone(const TutorialSight& sight);
  void Remember(const TutorialSight& sight);

  bool is_on_ = false;
  int step_ = 0;
  bool has_start_ = false;
  scene::Input start_;  // when the step began
  device::Channel start_hand_ = device::kRightHand;
  bool was_open_ = false, was_held_ = false, was_paused_ = false;
};

}  // namespace trocar::presenter
