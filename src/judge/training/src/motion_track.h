// SPDX-License-Identifier: Apache-2.0
/// \file motion_track.h  One tool's or the laparoscope's motion at an even rate, filtered, and what is found in it once for all
/// parts of an attempt.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_settings.h"

namespace trocar::training {

/// Samples [first, last] of a track.
struct Movement {
  std::size_t first = 0, last = 0;
  std::size_t latest_peak = 0;
};

/// All arrays have one entry per resampled time k / sample_rate_hz.
struct MotionTrack {
  std::vector<math::Vec3> tip;     // m; of the laparoscope its lens
  std::vector<math::Vec3> axis;    // unit; of the laparoscope its line of sight
  std::vector<double> insertion;   // m
  std::vector<double> speed;       // m/s, of the tip
  std::vector<double> slow_speed;  // m/s, over idle_window
  // of the tip's motion below jerk_cutoff_hz; none of the laparoscope
  std::vector<double> jerk_speed;    // m/s
  std::vector<double> squared_jerk;  // m^2/s^6, 0 in the first and last two
  // how much each sample adds to a path; 0 where it lies too near the last that counted
  std::vector<double> tip_step, depth_step;  // m
  std::vector<double> axis_step, spin_step;  // rad
  std::vector<char> is_resting;              // in a rest of idle_duration or more
  std::vector<Movement> movements;

  std::size_t Size() const { return tip.size(); }
};

/// \param dt  between samples [s], > 0
MotionTrack MakeMotionTrack(std::span<const ToolSample> samples, double dt, const MetricSettings& settings);
/// Lens and line of sight: the rest is 0.
MotionTrack MakeMotionTrack(std::span<const CameraSample> samples, double dt, const MetricSettings& settings);

}  // namespace trocar::training
