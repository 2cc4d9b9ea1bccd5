// SPDX-License-Identifier: Apache-2.0
/// \file operation_judge.h  Judgement of the acts of an operation: errors, phases and the critical view.
/// It only looks: a tick without it leaves the same world.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/cholecystectomy/critical_view.h"
#include "trocar/cholecystectomy/dissection_monitor.h"
#include "trocar/cholecystectomy/emitted_acts.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/instrument/camera.h"
#include "trocar/instrument/hand.h"
#include "trocar/surgery/grasp.h"

namespace trocar::cholecystectomy {

/// Observation of a hand in a tick.
struct ObservedHand {
  math::Vec3 p_world_tip;      ///< of the tool that is seen [m]
  double depth = 0;            ///< of the tool in its trocar [m]
  bool is_retracting = false;  ///< jaws hold tissue
  bool is_holding_liver = false;
  Target held = Target::kNullTarget;                          ///< while retracting
  surgery::GraspChange change = surgery::GraspChange::kNone;  ///< in this tick
};

/// Observation of an operation at the end of a tick.
struct OperationObservation {
  double time = 0;     ///< [s]
  double seconds = 0;  ///< of the tick, > 0
  const EmittedActs& acts;
  std::array<ObservedHand, instrument::kHandCount> hands;
  const tissue::TissueState& tissue;
  const surgery::Vessels& vessels;
  std::span<const surgery::OrganSurface> organs;
  instrument::Camera camera;  ///< through which the trainee looks
  OperationFacts facts;
  double blood_lost = 0;   ///< since the start [m^3]
  int spilled_stones = 0;  ///< that lie in the abdomen
  math::Vec3 p_pool;       ///< where fluids gather, world frame [m]
};

/// From where on something counts as an error. Source: domain facts, section 1.4, for the blood and the duct; the others are tunables.
struct JudgementSettings {
  double much_blood = 50e-6;   ///< [m^3]
  double near_duct = 0.005;    ///< of current to a duct that must stay [m]
  double kept_fat = 0.005;     ///< beside the middle line of such a duct, which need not be exposed [m]
  double kept_sheath = 0.003;  ///< about the middle line of an artery that must stay; it may stay covered [m]
  double idle_seconds = 0.25;  ///< of current into nothing that no eye would note [s]
  double tip_in = 0.08;        ///< a tool this deep has been pushed in [m]
  double blind_seconds = 1.5;  ///< for which it may be outside the picture then [s]

  friend bool operator==(const JudgementSettings&, const JudgementSettings&) = default;
};

class OperationJudge {
 public:
  /// \param has_critical_view  there is a critical view to be had before anything is clipped
  OperationJudge(DissectionMonitor dissection, bool has_critical_view,
                 const JudgementSettings& settings = {});

  /// Once a tick, at its end.
  /// \note Real-time safe.
  void Update(const OperationObservation& now) noexcept;

  /// Errors of the last Update.
  std::span<const ErrorEntry> NewErrors() const { return errors_.Entries().subspan(errors_before_); }

  const ErrorLog& Errors() const { return errors_; }
  const DissectionFacts& Facts() const { return dissection_.Facts(); }
  const CriticalViewScore& View() const { return view_.Score(); }
  /// At some time before.
  bool WasViewAchieved() const { return was_achieved_; }
  Phase CurrentPhase() const { return phases_.Current(); }
  void VisitState(base::StateArchive& archive);

 private:
  struct HandState {
    bool is_inserting = false;
    double blind_seconds = 0;
  };
  void JudgeAct(const EmittedAct& act, double time) noexcept;
  void JudgeHand(int hand, const OperationObservation& now) noexcept;
  void JudgePhase(const OperationObservation& now) noexcept;

  bool has_view_ = true;        // constant
  JudgementSettings settings_;  // constant
  DissectionMonitor dissection_;
  ErrorLog errors_;
  CriticalView view_;
  PhaseRecogniser phases_;
  std::array<HandState, instrument::kHandCount> hands_;
  bool was_achieved_ = false, was_completed_ = false;
  std::size_t errors_before_ = 0;
};

}  // namespace trocar::cholecystectomy
