// SPDX-License-Identifier: Apache-2.0
/// \file coach_measures.h  Measures of the coach: one number for each habit, and the moment at which it shows most.
///
/// Metrics answer "how much"; a coach also needs "when". These are pure functions of a trace, of which some have no
/// counterpart among the metrics, because the metrics' low-pass takes most of the tremor away, and leaves too much of it for paths.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trocar/training/attempt_trace.h"

namespace trocar::training {

/// Where a habit shows most.
struct CoachMoment {
  double time = 0;     ///< when it begins, since the attempt's first tick [s]
  double seconds = 0;  ///< how long it lasts; 0 for an event
  int hand = -1;       ///< instrument::Hand, or -1 where it is of both or of the camera
};

struct CoachMeasure {
  std::string name;
  double value = 0;  ///< see CalcCoachMeasures; finite
  std::optional<CoachMoment> moment;
  /// The single greatest value, where `value` is not that: of "peak_force", the peak of a report's plot [N].
  std::optional<double> most;
};

/// In this order:
///
/// "tremor" [m]: root mean square of the tip's motion between 5 and 20 Hz, of the hand that trembles more.
/// "one_hand_waits" [-]: of the time in which a hand moves, in which the other has rested for a second or more.
/// "peak_force" [N]: that is passed in one hundredth of the time in which a tool is loaded; a single blow does not make it.
/// "energy_in_air" [s]: a current pedal is down and no current flows.
/// "tips_unseen" [-]: part of the time in which a tip is out of the picture for half a second or more.
/// "detour" [-]: of the movements longer than 20 mm, by how much the paths are longer than straight lines.
/// "corrections" [-]: of the movements longer than 20 mm, how many are followed at once by a short one back.
/// "pauses" [-]: part of the time in which both hands rest for half a second or more.
/// "time" [s]: from the first tick to the last.
///
/// \pre trace.dt > 0 and both hands have as many samples (TROCAR_ASSERT)
/// \note Not real-time safe: allocates.
std::vector<CoachMeasure> CalcCoachMeasures(const AttemptTrace& trace);

/// Measures that an event may stand for: "event:board_pressed" counts the events of that kind.
CoachMeasure CountEvents(const AttemptTrace& trace, const std::string& kind);

}  // namespace trocar::training
