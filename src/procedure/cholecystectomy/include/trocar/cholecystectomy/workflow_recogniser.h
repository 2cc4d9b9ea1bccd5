// SPDX-License-Identifier: Apache-2.0
/// \file workflow_recogniser.h  Phases of an operation by the definitions and in the order of Cholec80.
///
/// Source: A. P. Twinanda et al., "EndoNet", IEEE TMI 36, 2017 (phases and their order); the phase labels of CholecT50, CAMMA.
#pragma once

#include <array>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/cholecystectomy/hand_acts.h"
#include "trocar/cholecystectomy/triplet.h"

namespace trocar::cholecystectomy {

/// Progress of the operation so far, as far as phases depend on it.
struct WorkflowFacts {
  bool is_gallbladder_free = false;  ///< nothing holds it any more
  bool is_gallbladder_in_bag = false;
  bool is_bag_leaving = false;  ///< the bag is drawn into a port
  bool has_divided = false;     ///< a clip was closed, or a structure that enters the gallbladder was cut
  int structures_entering = 0;  ///< the gallbladder, and not cut
  bool is_upper_bed =
      false;  ///< in this tick the bed is dissected beyond its middle, seen from the infundibulum
};

/// Says in which phase an operation is, from what is done. docs/operation.md has the definitions.
///
/// Each act speaks for a phase, or for none; evidence fades with time, and another phase begins when it has clearly more of it.
/// Phases follow the order of Cholec80: dissection before the first clip is that of the hepatocystic triangle, the lower half of the
/// bed with it, which the critical view asks for; afterwards it is that of the gallbladder. Fluids are cleaned from when the
/// gallbladder is free. Nothing goes back to the preparation, and nothing to the triangle once a structure is clipped or cut.
class WorkflowRecogniser {
 public:
  /// Seconds of work of one kind after which a phase has begun: one clip, one cut or one spread is as many.
  static constexpr double kBeginSeconds = 1.0;
  /// In which evidence falls to 1/e [s].
  static constexpr double kFadeSeconds = 20.0;

  /// One tick.
  /// \param acts  of all instruments, those included that only are there (null_verb)
  /// \param seconds  > 0
  /// \note Real-time safe.
  void Update(std::span<const SeenAct> acts, const WorkflowFacts& facts, double seconds) noexcept;

  Phase Current() const noexcept { return current_; }
  /// Time spent in a phase so far [s].
  double SecondsIn(Phase phase) const noexcept { return seconds_[static_cast<std::size_t>(phase)]; }

  void VisitState(base::StateArchive& archive);

 private:
  Phase current_ = Phase::kPreparation;
  std::array<double, kPhaseCount> evidence_{}, seconds_{};
};

}  // namespace trocar::cholecystectomy
