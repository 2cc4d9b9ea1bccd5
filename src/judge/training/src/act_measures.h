// SPDX-License-Identifier: Apache-2.0
/// \file act_measures.h  Measures of what was done: view, force, grasps, current, clips, errors, the task.
#pragma once

#include "attempt_part.h"

namespace trocar::training {

/// View, contact, force and current, on the recorded ticks.
void MeasureHandTicks(const AttemptTrace& trace, int hand, const AttemptPart& part,
                      const MetricSettings& settings, MetricList& list);
/// Grasps, tears and what else hands did, from the events.
void MeasureHandEvents(const AttemptTrace& trace, int hand, const AttemptPart& part,
                       const MetricSettings& settings, MetricList& list);
/// Times that the instruments met.
void MeasureCollisions(const AttemptTrace& trace, const AttemptPart& part, const MetricSettings& settings,
                       MetricList& list);
/// By severity, of the attempt and of each hand.
void MeasureErrors(const AttemptTrace& trace, const AttemptPart& part, MetricList& list);
void MeasureClips(const AttemptTrace& trace, const AttemptPart& part, MetricList& list);
void MeasureFluids(const AttemptTrace& trace, const AttemptPart& part, MetricList& list);
/// Stones, critical view, goals and score: of the whole attempt alone.
void MeasureOutcome(const AttemptTrace& trace, const AttemptPart& part, MetricList& list);

}  // namespace trocar::training
