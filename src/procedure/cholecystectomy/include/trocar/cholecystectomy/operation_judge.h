// SPDX-License-Identifier: Apache-2.0
/// \file operation_judge.h  Judgement of the facts of an operation: errors, phases and the critical view.
/// It only looks: a tick without it leaves the same world.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/cholecystectomy/critical_view.h"
#include "trocar/cholecystectomy/dissection_monitor.h"
#include "trocar/cholecystectomy/hand_acts.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/cholecystectomy/vessel_judgement.h"
#include "trocar/cholecystectomy/workflow_recogniser.h"
#include "trocar/instrument/hand.h"
#include "trocar/surgery/observation.h"

namespace trocar::cholecystectomy {

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

/// The patient as a judge has to know it; constant.
struct JudgedAnatomy {
  TargetTable targets;
  BiliaryAnatomy biliary;  ///< of the ducts and arteries, which follow the organs among the surfaces
  std::vector<std::uint32_t> main_ducts;  ///< nodes of ducts that must stay
  std::size_t organ_count = 0;
  bool has_critical_view = false;  ///< there is one to be had before anything is clipped
  bool may_cut_organs = false;     ///< of a training task: its sheets are there to be cut
};

class OperationJudge {
 public:
  OperationJudge(JudgedAnatomy anatomy, DissectionMonitor dissection, const JudgementSettings& settings = {});

  /// First in a tick, once tools and heat have done their part: judges the facts so far by the tissue in which they came about.
  /// \note Real-time safe.
  void SeeTools(const surgery::OperationObservation& now) noexcept;
  /// Then at its end: the facts since, hands, dissection, view and phase.
  /// \note Real-time safe.
  void Update(const surgery::OperationObservation& now) noexcept;

  /// Errors of the last tick.
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
  void JudgeFact(const surgery::Fact& fact, const surgery::OperationObservation& now) noexcept;
  void JudgeTube(const surgery::Fact& fact, const surgery::OperationObservation& now) noexcept;
  void JudgeCurrent(const surgery::Fact& fact, const surgery::OperationObservation& now) noexcept;
  void JudgeHand(int hand, const surgery::OperationObservation& now) noexcept;
  void JudgePhase(const surgery::OperationObservation& now) noexcept;
  void Report(OperationError error, const surgery::Fact& fact, double time) noexcept;

  JudgedAnatomy anatomy_;                   // constant
  JudgementSettings settings_;              // constant
  std::vector<std::uint8_t> is_upper_bed_;  // (strands) constant
  DissectionMonitor dissection_;
  ErrorLog errors_;
  CriticalView view_;
  WorkflowRecogniser phases_;
  std::array<HandState, instrument::kHandCount> hands_;
  bool was_achieved_ = false, was_completed_ = false;
  std::size_t errors_before_ = 0;  // before this tick
  std::size_t facts_seen_ = 0;     // of this tick
};

}  // namespace trocar::cholecystectomy
