// SPDX-License-Identifier: Apache-2.0
/// \file motion_metrics.h  What a recording says about how the tools were moved.
///
/// Training feedback, not certified assessment: no cut-off between good and bad has been validated with this
/// simulator.
///
/// Positions, axes and angles are resampled to 100 Hz and low-passed without phase shift before anything is
/// measured; forces, view and contact are measured on the recorded ticks. Smoothness is defined for one
/// movement, so SPARC and dimensionless jerk are computed for each detected movement and averaged. A movement
/// is cut where its speed passes movement_end_speed, and there jerk is greatest, so it comes out smaller than
/// of the whole movement: compare only figures of the same settings.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/training/motion_recorder.h"
#include "trocar/training/smoothness.h"

namespace trocar::training {

/// Thresholds. Defaults follow the literature on laparoscopic motion analysis; all are conventions, none is a
/// law.
struct MetricSettings {
  double sample_rate_hz = 100.0;  ///< of the resampled signals, > 0
  double cutoff_hz = 6.0;         ///< of the low-pass, > 0
  /// Tremor and tracker noise: a new point counts only when it lies this far from the last that counted [m],
  /// >= 0.
  double noise_step = 0.5e-3;
  double angle_noise_step =
      0.0044;  ///< the same for the shaft's direction and its spin, a quarter degree [rad], >= 0
  double movement_start_speed = 0.020;  ///< a movement's speed rises above this [m/s]
  double movement_end_speed =
      0.005;                     ///< and it lasts as long as the speed stays above this [m/s], <= start speed
  double movement_gap = 0.2;     ///< peaks closer together belong to one movement [s], >= 0
  double idle_speed = 0.005;     ///< slower is idle [m/s]
  double idle_duration = 0.5;    ///< if it lasts at least so long [s], >= 0
  double force_threshold = 3.0;  ///< above it tissue is at risk [N], >= 0
  double force_release =
      0.9;  ///< the next exceedance counts after the force fell below this part [-], in (0, 1]
  SparcSettings sparc;
  /// Shortest path of the task for each tool [m], > 0. Where absent, economy of motion is undefined: the
  /// straight line from first to last position says nothing of a hand that comes back.
  std::vector<std::optional<double>> ideal_path_lengths;
};

/// One tool. Absent values are undefined for this recording: for example the economy of a tool that never
/// moved.
struct MotionMetrics {
  std::string tool;
  double time = 0;                               ///< [s]
  double path_length = 0;                        ///< of the tip [m]
  std::optional<double> economy_of_motion;       ///< ideal path / path length [-]
  double depth_path = 0;                         ///< sum of the insertion's changes: "depth perception" [m]
  double angular_path = 0;                       ///< swing of the shaft plus spin [rad]
  double spin_path = 0;                          ///< spin alone [rad]
  std::optional<double> mean_speed;              ///< [m/s]
  std::optional<double> max_speed;               ///< [m/s]
  std::optional<double> motion_smoothness;       ///< sqrt(T^5 / (2 PL^2) * int |x'''|^2 dt) [-]
  int movements = 0;                             ///< detected movements
  std::optional<double> sparc;                   ///< mean over the movements [-]
  std::optional<double> dimensionless_jerk;      ///< mean over the movements [-]
  std::optional<double> log_dimensionless_jerk;  ///< mean over the movements [-]
  std::optional<double> idle_fraction;           ///< part of the time [-]
  int out_of_view_count = 0;                     ///< times that the tip left the picture, or started outside
  double out_of_view_time = 0;                   ///< [s]
  double contact_time = 0;                       ///< [s]
  double grasping_time = 0;                      ///< [s]
  int grasp_attempts = 0;
  int grasp_successes = 0;
  int grasp_slips = 0;
  std::optional<double> grasp_efficiency;  ///< successes / attempts [-]
  double max_force = 0;                    ///< [N]
  double force_excess = 0;                 ///< integral of max(0, F - threshold) [N s]
  int force_exceedances = 0;               ///< times that the force rose above the threshold
};

/// The whole session.
struct SessionMetrics {
  double time = 0;                  ///< [s]
  std::uint64_t held_ticks = 0;     ///< as in MotionRecording
  std::uint64_t dropped_ticks = 0;  ///< as in MotionRecording
  std::vector<MotionMetrics> tools;
  /// Of the first two tools: part of the time in which both move [-].
  std::optional<double> bimanual_fraction;
  /// Of the first two tools: Pearson correlation of their speeds [-]; absent where one speed is constant.
  std::optional<double> bimanual_correlation;
};

/// \return kNumberNotFinite for a setting, dt or sample that is not finite or out of its range, named in the
/// message
/// \note Not real-time safe: allocates.
core::Result<SessionMetrics> CalcSessionMetrics(const MotionRecording& recording,
                                                const MetricSettings& settings = {});

/// Which way a trainee improves.
enum class BetterWhen { kHigher, kLower, kNeither };

/// What a number in the report means.
struct MetricDefinition {
  std::string_view name;     ///< key in the JSON, with its unit: "path_length_mm"
  std::string_view unit;     ///< "mm"; "-" for none
  std::string_view meaning;  ///< one sentence
  BetterWhen better;
  std::string_view source;  ///< who defined it
  bool per_tool;            ///< of each tool, otherwise of the session
};

/// Every number that FormatMetricsJson writes, in its order.
std::span<const MetricDefinition> MetricDefinitions() noexcept;

/// "training feedback, not certified assessment": stands in every JSON and belongs on every page that shows a
/// metric.
std::string_view MetricsDisclaimer() noexcept;

/// JSON text {"disclaimer", session metrics..., "tools": [{"tool", metrics...}]}; undefined values are null,
/// never NaN.
std::string FormatMetricsJson(const SessionMetrics& metrics);

}  // namespace trocar::training
