// SPDX-License-Identifier: Apache-2.0
/// \file settings.h  Settings of an environment for reinforcement learning: task, kind of actions, weights of the reward.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::environment {

/// Meaning of an action's numbers.
enum class ActionKind : std::uint8_t {
  kJoints,   ///< rates of pan, tilt, spin, depth and jaw of each hand, as shares of the greatest, -1 to 1
  kTip,      ///< velocity of each tip along the world's axes, and rates of spin and jaw, as shares, -1 to 1
  kDiscrete  ///< one choice for each hand: a step of the tip along an axis, a turn, open, close, a pedal
};
/// "joints", "tip", "discrete"
std::string_view NameOf(ActionKind kind) noexcept;
/// Nothing for another word.
std::optional<ActionKind> FindActionKind(std::string_view name) noexcept;

/// Rewarded feature of an action: a reward is the sum of features, each times its weight.
enum class Feature : std::uint8_t {
  kGoal,           ///< share of the task's goals that were reached [-]
  kStep,           ///< share of the steps of all goals that were done, minus those undone [-]
  kApproach,       ///< by which what the next step wants came nearer [m]
  kCompleted,      ///< 1 when the task or the operation is completed [-]
  kError,          ///< errors that are not critical, counted
  kCriticalError,  ///< counted
  kForce,          ///< of both tools on tissue and things, over the time of the action [N s]
  kPath,           ///< of both tips [m]
  kTime,           ///< that passed [s]
  kCleared,        ///< share of the hepatocystic triangle that was cleared [-]
  kDetached,       ///< share of the organ's bed that was detached [-]
  kCriticalView,   ///< points of the critical view's six that were gained or lost [-]
  kBlood,          ///< that was lost [mL]
  kCount
};
inline constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::kCount);
/// "goal", "step", "approach", ...
std::string_view NameOf(Feature feature) noexcept;

/// Indexed by Feature.
using Features = std::array<double, kFeatureCount>;

/// Weights that reward reaching goals and getting nearer to them, and cost time and errors.
Features DefaultWeights() noexcept;

struct EnvironmentSettings {
  std::string task = "peg_transfer";  ///< key of a delivered task or operation, or a file of either
  std::string level = "normal";       ///< of a task or an operation
  std::filesystem::path patient;      ///< in place of the scene's, unless it is empty
  std::uint64_t seed = 1;  ///< of the task's random layout; an episode's seed chooses among `layouts`
  /// Layouts that episodes are drawn from: those of `seed`, `seed` + 1, ... Each has a model in memory, shared by all
  /// environments of a pool. 1 to 4096.
  int layouts = 1;
  ActionKind actions = ActionKind::kJoints;
  double actions_per_second = 10;  ///< 0.5 to 120; an action lasts a whole number of ticks
  /// After which an episode is truncated [s]; 0: the task's own limit and 30 s, 1800 s for an operation.
  double most_seconds = 0;
  bool moves_camera = false;  ///< the laparoscope is part of the action; tasks that are about it set this
  Features weights = DefaultWeights();
  /// JSON of a task or an operation that stands in no file; `task` is then its name in messages, and relative paths inside
  /// start from that name's folder. Empty: `task` is looked for.
  std::string document;
};

/// A named part of an action or of an observed state.
struct Field {
  std::string name;  ///< "left.pan", "right.tip", "object.ring_1.position"
  std::size_t first = 0, count = 1;
  std::string unit;         ///< "m", "rad", "N", "-"; of an action what 1 means, "rad/s"
  std::size_t choices = 0;  ///< of a discrete action: 0 to choices - 1
};

}  // namespace trocar::environment
