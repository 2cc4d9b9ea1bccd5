// SPDX-License-Identifier: Apache-2.0
/// \file charts.h  The drawings of the reports.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trocar/report/attempt_report.h"
#include "trocar/report/drawing.h"
#include "trocar/report/trainee_report.h"

namespace trocar::report {

/// Phases, errors, and the force on both instruments, over one axis of time.
Drawing DrawTimeline(const AttemptReport& report);

enum class PathView { kFromFront, kFromHead };
/// Where both tips went.
Drawing DrawPaths(const AttemptReport& report, PathView view);

/// At most eight metrics on axes from the centre; each in standard deviations from the expert set's mean, better outwards. Inside a
/// metric's axis the group's middle half and median are shown where there is a group.
/// \return nothing where fewer than three metrics have an expert set
std::optional<Drawing> DrawRadar(const AttemptReport& report);

/// Values over the number of the attempt, with the fitted curve.
Drawing DrawLearningCurve(const LearningCurve& curve);

/// Cumulative sum of failures with its limits.
Drawing DrawCusum(const CusumChart& chart);

}  // namespace trocar::report
