// SPDX-License-Identifier: Apache-2.0
/// \file motion_measures.h  How tools and laparoscope were moved.
#pragma once

#include "attempt_part.h"
#include "motion_track.h"

namespace trocar::training {

/// The path as published, from the ticks as they were recorded.
void MeasurePlainPath(std::span<const ToolSample> samples, const std::optional<double>& ideal_path,
                      const AttemptPart& part, std::string_view hand, MetricList& list);
void MeasureHandMotion(const MotionTrack& track, const std::optional<double>& ideal_path,
                       const AttemptPart& part, std::string_view hand, const MetricSettings& settings,
                       MetricList& list);
/// Of both hands together.
void MeasureBimanual(const MotionTrack& left, const MotionTrack& right, const AttemptPart& part,
                     const MetricSettings& settings, MetricList& list);
void MeasureCamera(const MotionTrack& track, const AttemptTrace& trace, const AttemptPart& part,
                   MetricList& list);

}  // namespace trocar::training
