// SPDX-License-Identifier: Apache-2.0
#include "live_input.h"

#include <utility>

namespace trocar::cli {

base::Result<std::unique_ptr<LiveInput>> LiveInput::Open(const std::string& device,
                                                         const scene::Scene& scene) {
  std::unique_ptr<LiveInput> input(new LiveInput(scene));
  if (device.empty()) return input;
  auto opened = DeviceInput::Open(device, scene);
  if (!opened) return opened.error();
  input->device_ = opened->get();
  input->hands_.UseDevice(std::move(*opened));
  return input;
}

base::Status LiveInput::UseHaptics(const HapticOptions& options, const simulation::Simulation& simulation) {
  if (options.name.empty()) return {};
  auto opened = HapticInput::Open(options, simulation);
  if (!opened) return opened.error();
  haptics_ = std::move(*opened);
  hands_.UseHaptics(haptics_->Link());
  if (device_ != nullptr) return {};
  hands_.SetGuide({.source = std::make_shared<session::ScriptSource>(*scene_),
                   .is_hands_only = true,
                   .yields_to_devices = true});
  return {};
}

scene::Input LiveInput::For(std::uint64_t tick, const simulation::Snapshot& before) {
  if (device_ == nullptr && haptics_ == nullptr) return script_.For(tick, before);
  if (!has_begun_ && device_ != nullptr) hands_.GoOnFrom(script_.For(tick, before));
  has_begun_ = true;
  if (device_ != nullptr) device_->Await(before.time);
  if (haptics_ != nullptr) haptics_->Await(before.time);
  return hands_.For(tick, before);
}

void LiveInput::AfterStep(simulation::Simulation& simulation) {
  if (haptics_ != nullptr) haptics_->AfterStep(simulation);
}

}  // namespace trocar::cli
