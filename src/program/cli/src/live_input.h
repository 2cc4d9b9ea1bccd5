// SPDX-License-Identifier: Apache-2.0
/// \file live_input.h  Input of runs without a window: the scene's script, and devices that hold hands in its place.
#pragma once

#include <memory>
#include <string>

#include "device_input.h"
#include "haptic_input.h"
#include "trocar/session/input_sources.h"
#include "trocar/session/session_input.h"

namespace trocar::cli {

/// Without a device the script alone, as fast as it goes. With one the run keeps the device's time, and hands that the device does
/// not see stay where they were; with a haptic device alone they follow the script.
class LiveInput final : public simulation::InputSource {
 public:
  /// \param device  as device::MakeDriver reads it; empty: none
  /// \param scene   outlives this
  /// \return as DeviceInput::Open
  static base::Result<std::unique_ptr<LiveInput>> Open(const std::string& device, const scene::Scene& scene);
  /// Before the first tick. \param options  without a name: nothing
  /// \return as HapticInput::Open
  base::Status UseHaptics(const HapticOptions& options, const simulation::Simulation& simulation);

  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  /// Gives the tissue round the tools to the haptic loop.
  void AfterStep(simulation::Simulation& simulation);
  /// nullptr without a haptic device.
  const HapticInput* Haptics() const { return haptics_.get(); }
  /// kDeviceLost once the device was lost.
  base::Status Check() const { return device_ != nullptr ? device_->Check() : base::Status{}; }

 private:
  explicit LiveInput(const scene::Scene& scene) : scene_(&scene), script_(scene), hands_(scene, 1, false) {}

  const scene::Scene* scene_;
  session::ScriptSource script_;
  std::unique_ptr<HapticInput> haptics_;  // null: none
  session::SessionInput hands_;           // bits of play:FILE are those of the file: nothing is rounded
  DeviceInput* device_ = nullptr;         // of hands_; null: none
  bool has_begun_ = false;
};

}  // namespace trocar::cli
