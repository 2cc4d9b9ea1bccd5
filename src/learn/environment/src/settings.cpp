// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/settings.h"

namespace trocar::environment {
namespace {

constexpr std::array<std::string_view, 3> kActionNames = {"joints", "tip", "discrete"};
constexpr std::array<std::string_view, kFeatureCount> kFeatureNames = {
    "goal", "step", "approach", "completed", "error",         "critical_error", "force",
    "path", "time", "cleared",  "detached",  "critical_view", "blood"};

constexpr std::array<std::string_view, kVariedCount> kVariedNames = {
    "start_mm", "camera_deg", "mass", "friction", "stiffness", "light", "latency_s"};
constexpr Ranges kLimits = {{{0, 30}, {0, 30}, {0.1, 10}, {0, 5}, {0.05, 20}, {0, 4}, {0, 1}}};

}  // namespace

std::string_view NameOf(Varied quantity) noexcept {
  return kVariedNames[static_cast<std::size_t>(quantity)];
}

Range LimitsOf(Varied quantity) noexcept {
  return kLimits[static_cast<std::size_t>(quantity)];
}

Ranges StandardRanges() noexcept {
  return {{{0, 0}, {0, 0}, {1, 1}, {1, 1}, {1, 1}, {1, 1}, {0, 0}}};
}

Ranges UsualRanges() noexcept {
  Ranges ranges = StandardRanges();
  ranges[static_cast<std::size_t>(Varied::kStart)] = {0, 8};
  return ranges;
}

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
