// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/settings.h"

namespace trocar::environment {
namespace {

constexpr std::array<std::string_view, 3> kActionNames = {"joints", "tip", "discrete"};
constexpr std::array<std::string_view, kFeatureCount> kFeatureNames = {
    "goal", "step", "approach", "completed", "error",         "critical_error", "force",
    "path", "time", "cleared",  "detached",  "critical_view", "blood"};

}  // namespace

std::string_view NameOf(ActionKind kind) noexcept {
  return kActionNames[static_cast<std::size_t>(kind)];
}

std::optional<ActionKind> FindActionKind(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kActionNames.size(); ++i) {
    if (kActionNames[i] == name) return static_cast<ActionKind>(i);
  }
  return {};
}

std::string_view NameOf(Feature feature) noexcept {
  return kFeatureNames[static_cast<std::size_t>(feature)];
}

Features DefaultWeights() noexcept {
  Features weights{};
  const auto set = [&](Feature feature, double weight) {
    weights[static_cast<std::size_t>(feature)] = weight;
  };
  set(Feature::kGoal, 10);
  set(Feature::kStep, 2);
  set(Feature::kApproach, 5);
  set(Feature::kCompleted, 10);
  set(Feature::kError, -0.5);
  set(Feature::kCriticalError, -5);
  set(Feature::kForce, -0.01);
  set(Feature::kTime, -0.01);
  set(Feature::kCleared, 5);
  set(Feature::kDetached, 10);
  set(Feature::kCriticalView, 1);
  set(Feature::kBlood, -0.05);
  return weights;
}

}  // namespace trocar::environment
