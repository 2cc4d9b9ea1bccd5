// SPDX-License-Identifier: Apache-2.0
/// \file motion_log.h  Keeps of every tick what metrics and plots need.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/math/vector.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/training/motion_recorder.h"

namespace trocar::cli {

class MotionLog {
 public:
  /// \param seconds  room for so much [s], > 0
  MotionLog(const scene::Scene& scene, double seconds);

  /// Call after every tick, with every tick.
  void Record(const simulation::Snapshot& snapshot);

  const training::MotionRecording& Recording() const { return recorder_.Recording(); }
  const std::vector<double>& Times() const { return times_; }  ///< (ticks) [s]

 private:
  double field_of_view_;
  training::MotionRecorder recorder_;
  std::vector<double> times_;
  std::uint64_t known_events_ = 0;
};

}  // namespace trocar::cli
