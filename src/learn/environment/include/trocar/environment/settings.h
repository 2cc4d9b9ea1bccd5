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

/// Quantity that the seed of an episode draws from a range.
enum class Varied : std::uint8_t {
  kStart,      ///< how far each tip begins from where the task has it [mm]
  kCamera,     ///< how far the laparoscope begins turned aside, about its trocar [deg]
  kMass,       ///< of things, in the task's [-]
  kFriction,   ///< of things, in the task's [-]
  kStiffness,  ///< of tissue, in the task's [-]
  kLight,      ///< power of the head light in pictures, in the usual one [-]
  kLatency,    ///< from an action to the hands' motion [s]
  kCount
};
inline constexpr std::size_t kVariedCount = static_cast<std::size_t>(Varied::kCount);
/// "start_mm", "camera_deg", "mass", "friction", "stiffness", "light", "latency_s"
std::string_view NameOf(Varied quantity) noexcept;

struct Range {
  double low = 0, high = 0;
  friend bool operator==(const Range&, const Range&) = default;
};
/// Indexed by Varied.
using Ranges = std::array<Range, kVariedCount>;
/// In which a quantity's range has to lie.
Range LimitsOf(Varied quantity) noexcept;
/// Nothing varies.
Ranges StandardRanges() noexcept;
/// The tips begin up to 8 mm from where the task has them.
Ranges UsualRanges() noexcept;

struct EnvironmentSettings {
  std::string task = "peg_transfer";            ///< key of a delivered task or operation, or a file of either
  std::string level = "normal";                 ///< of a task or an operation
  std::vector<std::filesystem::path> patients;  ///< in place of the scene's; of several a seed chooses one
  /// Of the row of episodes where no reset names one, and of the first of `layouts`.
  std::uint64_t seed = 1;
  /// 0: every seed of an episode has a layout of its own, drawn from all that the task lets vary; of tissue, which takes long
  /// to make, one of `models`. Else standardised layouts, as people train at: those of `seed`, `seed` + 1, ..., among which
  /// an episode's seed chooses. Each has a model in memory, shared by all environments of a pool. At most 4096.
  int layouts = 0;
  /// With `layouts` 0, models of tissue that are kept, each of another layout: 1 to 4096, or 0 for 8 of a task's tissue and one
  /// of each patient.
  int models = 0;
  /// What a seed varies beside the layout; nothing said: UsualRanges(), with standardised layouts StandardRanges().
  std::optional<Ranges> ranges;
  ActionKind actions = ActionKind::kJoints;
  double actions_per_second = 10;  ///< 0.5 to 120; an action lasts a whole number of ticks
  /// After which an episode is truncated [s]; 0: the task's own limit and 30 s, 1800 s for an operation.
  double most_seconds = 0;
  bool moves_camera = false;   ///< the laparoscope is part of the action; tasks that are about it set this
  bool clips_actions = false;  ///< what lies out of range is cut to it; else it is refused
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
