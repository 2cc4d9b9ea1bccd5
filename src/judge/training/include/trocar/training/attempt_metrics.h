// SPDX-License-Identifier: Apache-2.0
/// \file attempt_metrics.h  Metrics of an attempt: pure functions of its trace.
///
/// Training feedback, not certified assessment: no cut-off between good and bad has been validated with this simulator.
///
/// Positions, axes and angles are resampled to 100 Hz and low-passed without phase shift before anything is measured; forces, view
/// and contact are measured on the recorded ticks. Smoothness is defined for one movement, so SPARC and dimensionless jerk are
/// computed for each detected movement and averaged. A movement is cut where its speed passes movement_end_speed, and there jerk is
/// greatest, so it comes out smaller than of the whole movement: compare only figures of the same settings.
#pragma once

#include <string>

#include "trocar/base/result.h"
#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_settings.h"
#include "trocar/training/metric_value.h"

namespace trocar::training {

/// All metrics of the definitions: of the attempt, of each hand and the camera, each also per phase, and per tool where a hand used
/// more than one. The same trace gives the same bits.
///
/// \return kNumberNotFinite for a setting, dt or sample that is not finite or out of its range, and for hands of different lengths,
/// named in the message
/// \note Not real-time safe: allocates.
base::Result<AttemptMetrics> CalcAttemptMetrics(const AttemptTrace& trace,
                                                const MetricSettings& settings = {});

/// JSON array of {"metric", "hand", "phase", "tool", "value", "unit"}; texts that are empty are left out.
std::string FormatMetricsJson(const AttemptMetrics& metrics);
/// The metrics as lines of comma-separated values, with a heading.
std::string FormatMetricsCsv(const AttemptMetrics& metrics);

}  // namespace trocar::training
