// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/input_sources.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "trocar/agent/taking_over.h"
#include "trocar/host/log.h"

namespace trocar::session {
namespace {

constexpr std::string_view kExpert = "expert";

}  // namespace

scene::Input ScriptSource::For(std::uint64_t /*tick*/, const simulation::Snapshot& before) {
  is_at_end_ = before.time >= scene_->script.Duration();
  return scene::CalcScriptInput(*scene_, before.time);
}

scene::Input SurgeonSource::For(std::uint64_t /*tick*/, const simulation::Snapshot& before) {
  return surgeon_->Act(before);
}

bool ExpertSource::Suits(const scene::Scene& scene) {
  const auto surgeons = agent::ListSurgeons();
  return std::any_of(surgeons.begin(), surgeons.end(), [&](const agent::SurgeonEntry& entry) {
    return std::string_view(entry.name) == kExpert && entry.suits(scene);
  });
}

scene::Input ExpertSource::For(std::uint64_t /*tick*/, const simulation::Snapshot& before) {
  if (surgeon_ == nullptr && !has_failed_) {
    auto made = agent::MakeSurgeonTakingOver(kExpert, *scene_, before, scene_->seed);
    if (made.ok()) {
      surgeon_ = std::move(*made);
    } else {
      has_failed_ = true;
      host::Log(host::LogLevel::kWarning, "nobody can demonstrate this scene: " + made.error().Text());
    }
  }
  if (surgeon_ != nullptr) return surgeon_->Act(before);
  scene::Input rest;
  for (std::size_t hand = 0; hand < rest.hands.size(); ++hand) {
    rest.hands[hand] = before.instruments[hand].joints;
    rest.controls[hand].tool = before.operation.tools[hand];
  }
  rest.laparoscope = before.laparoscope;
  rest.settings = scene_->settings;
  return rest;
}

void ExpertSource::Reset() {
  surgeon_.reset();
  has_failed_ = false;
}

}  // namespace trocar::session
