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
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/cholecystectomy/vessel_judgement.h"
#include "trocar/cholecystectomy/workflow_recogniser.h"
#include "trocar/instrument/hand.h"
#include "trocar/scene/procedure.h"
#include "trocar/surgery/observation.h"

namespace trocar::cholecystectomy {

/// The patient as a judge has to know it; constant.
struct JudgedAnatomy {
  TargetTable targets;
  scene::VesselAnatomy biliary;  ///< of the ducts and arteries, which follow the organs among the surfaces
  std::vector<std::uint32_t> main_ducts;  ///< nodes of ducts that must stay
  std::size_t organ_count = 0;
  bool has_critical_view = false;  ///< there is one to be had before anything is clipped
  bool may_cut_organs = false;     ///< of a training task: its sheets are there to be cut
};

/// What is found of a cholecystectomy beside what every procedure says: scene::ProcedureResult::detail.
struct OperationDetail {
  DissectionFacts facts;
  CriticalViewScore critical_view;
  InjuryReport injuries;
};
/// Null of another procedure.
const OperationDetail* FindDetail(const scene::ProcedureResult& result) noexcept;

class OperationJudge final : public scene::ProcedureJudge {
 public:
  OperationJudge(JudgedAnatomy anatomy, DissectionMonitor dissection,
                 const surgery::JudgementSettings& settings = {});

  void SeeTools(const surgery::OperationObservation& now) noexcept override;
  void Update(const surgery::OperationObservation& now) noexcept override;
  std::span<const surgery::ErrorEntry> NewErrors() const noexcept override {
    return errors_.Entries().subspan(errors_before_);
  }
  const surgery::ErrorLog& Errors() const noexcept override { return errors_; }
  void Publish(scene::ProcedureSnapshot& snapshot) const noexcept override;
  /// `detail` is an OperationDetail.
  scene::ProcedureResult CalcResult(const surgery::Vessels& vessels,
                                    const surgery::StoneCount& stones) const override;
  void VisitState(base::StateArchive& archive) override;

  const DissectionFacts& Facts() const { return dissection_.Facts(); }
  const CriticalViewScore& View() const { return view_.Score(); }
  /// At some time before.
  bool WasViewAchieved() const { return was_achieved_; }
  Phase CurrentPhase() const { return phases_.Current(); }

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
  surgery::JudgementSettings settings_;     // constant
  std::vector<std::uint8_t> is_upper_bed_;  // (strands) constant
  DissectionMonitor dissection_;
  surgery::ErrorLog errors_;
  CriticalView view_;
  WorkflowRecogniser phases_;
  std::array<HandState, instrument::kHandCount> hands_;
  bool was_achieved_ = false, was_completed_ = false;
  std::size_t errors_before_ = 0;  // before this tick
  std::size_t facts_seen_ = 0;     // of this tick
};

}  // namespace trocar::cholecystectomy
