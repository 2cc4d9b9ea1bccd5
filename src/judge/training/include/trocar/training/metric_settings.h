// SPDX-License-Identifier: Apache-2.0
/// \file metric_settings.h  Thresholds of the metrics. The defaults are those of docs/metrics.json; a test compares the two.
#pragma once

#include "trocar/training/smoothness.h"

namespace trocar::training {

/// Defaults follow the literature on laparoscopic motion analysis; all are conventions, none is a law. Metrics of different
/// settings must not be compared.
struct MetricSettings {
  double sample_rate_hz = 100.0;  ///< of the resampled signals, > 0
  double cutoff_hz = 6.0;         ///< of the low-pass, > 0
  /// Of the low-pass before jerk is taken, > 0. A third derivative amplifies noise with the cube of its frequency: at 6 Hz the
  /// 0.2 mm rms of a tracker weigh more than a reach of a second, at 2.5 Hz a tenth as much as it.
  double jerk_cutoff_hz = 2.5;
  /// Tremor and tracker noise: a new point counts only when it lies this far from the last that counted [m], >= 0.
  double noise_step = 0.5e-3;
  /// As noise_step, for the directions of shaft and line of sight, and for spin: a quarter degree [rad], >= 0.
  double angle_noise_step = 0.0044;
  double movement_start_speed = 0.020;  ///< a movement's speed rises above this [m/s]
  double movement_end_speed =
      0.005;                     ///< and it lasts as long as the speed stays above this [m/s], <= start speed
  double movement_gap = 0.2;     ///< peaks closer together belong to one movement [s], >= 0
  double idle_speed = 0.005;     ///< slower is idle [m/s], >= 0
  double idle_window = 0.2;      ///< over which that speed is taken, so that noise is not motion [s], > 0
  double idle_duration = 0.5;    ///< if it lasts at least so long [s], >= 0
  double force_threshold = 3.0;  ///< above it tissue is at risk [N], >= 0
  double hard_contact_depth = 0.002;  ///< a tool that is pressed deeper touches hard [m], >= 0
  double release_share = 0.9;  ///< the next excess counts after the value fell below this part [-], in (0, 1]
  double regrasp_time = 2.0;   ///< a grasp so soon after letting go is a regrasp [s], >= 0
  double collision_gap = 0.5;  ///< instruments that part for less long have not parted [s], >= 0
  double safe_duct_distance = 0.005;  ///< of current from a main bile duct [m], >= 0
  SparcSettings sparc;
};

}  // namespace trocar::training
