// SPDX-License-Identifier: Apache-2.0
/// \file task_monitor.h  Judges a task tick by tick, from what the snapshot shows.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

/// Whether a condition is true in a tick, and of what.
struct Finding {
  bool is_true = false;
  math::Vec3 position;  ///< of the object or the tip, world frame [m]
  std::int32_t hand = -1;
};

/// Nothing is done in a scene without a task.
class TaskMonitor {
 public:
  void Reset(const scene::Scene& scene, scene::TaskSnapshot& task);
  /// The first movement is one away from where tools and lens are now. After Reset, before the first tick.
  void BeginFrom(const Snapshot& snapshot) noexcept;
  /// After everything else of a tick has been published.
  /// \note Real-time safe.
  void Update(const scene::Scene& scene, const Snapshot& snapshot, scene::TaskSnapshot& task) noexcept;
  void VisitState(base::StateArchive& archive);

 private:
  /// How an object went from hand to hand, and whether it falls.
  struct Track {
    double start_height = 0;    ///< [m]
    std::uint8_t held_by = 0;   ///< in the tick before
    double both_seconds = 0;    ///< for which both hands have held it in the air [s]
    int from = -1, to = -1;     ///< hands of the hand-over that ended in this tick
    double handed_seconds = 0;  ///< for which both had held it then [s]
    bool is_falling = false;    ///< let go in the air
    double let_go_height = 0;   ///< [m]
  };
  /// A condition of an error: how long it has been true, and whether that has been counted.
  struct ConditionMonitor {
    double seconds = 0;
    bool is_counted = false;
  };

  void Follow(const Snapshot& snapshot, double dt) noexcept;
  bool HasMoved(const Snapshot& snapshot) const noexcept;
  Finding Find(const scene::Scene& scene, const Snapshot& snapshot,
               const scene::Condition& condition) const noexcept;
  Finding FindOfObject(const scene::Scene& scene, const Snapshot& snapshot,
                       const scene::Condition& condition) const noexcept;
  Finding FindOfTool(const scene::Scene& scene, const Snapshot& snapshot,
                     const scene::Condition& condition) const noexcept;
  Finding FindOfEvents(const scene::Scene& scene, const Snapshot& snapshot,
                       const scene::Condition& condition) const noexcept;
  void UpdateGoals(const scene::Scene& scene, const Snapshot& snapshot, scene::TaskSnapshot& task) noexcept;
  void UpdateErrors(const scene::Scene& scene, const Snapshot& snapshot, scene::TaskSnapshot& task) noexcept;
  void Judge(const scene::Task& task, scene::TaskSnapshot& now) const noexcept;

  std::vector<Track> tracks_;                                      // (objects)
  std::vector<std::vector<ConditionMonitor>> condition_monitors_;  // (errors) of (conditions)
  std::array<math::Vec3, instrument::kHandCount> start_tips_;
  math::Pose X_world_start_view_;
  std::uint64_t events_before_ = 0;  // of the ticks before
};

}  // namespace trocar::simulation
