// SPDX-License-Identifier: Apache-2.0
/// \file operation_judge.h  What the acts of an operation amount to: errors, phases, the critical view, and how it ended.
/// It only looks: a tick without it leaves the same world.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "operation/dissection_monitor.h"
#include "operation/operation.h"
#include "trocar/core/state_archive.h"
#include "trocar/simulation/operation_result.h"

namespace trocar::simulation {

class OperationJudge {
 public:
  /// \param operation  as it was made
  OperationJudge(const Scene& scene, const PatientTissue& tissue, const Operation& operation);

  /// Once a tick, at its end.
  /// \param camera  through which the trainee looks
  /// \note Real-time safe.
  void Update(const Operation& operation, const HandsNow& hands, const TissueNow& tissue,
              const Camera& camera) noexcept;

  /// Errors of the last Update.
  std::span<const training::ErrorEntry> NewErrors() const { return errors_.Entries().subspan(told_errors_); }

  const training::ErrorLog& Errors() const { return errors_; }
  void Publish(OperationSnapshot& snapshot) const noexcept;
  /// Adds what this one knows.
  void AddTo(OperationResult& result) const;
  void VisitState(core::StateArchive& archive);

 private:
  struct HandState {
    bool is_inserting = false;
    double blind_seconds = 0;
  };
  void Report(training::OperationError error, const Vec3& p, int hand, double time) noexcept;
  void JudgeAct(const EmittedAct& act, double time) noexcept;
  void JudgeHand(int hand, const Operation& operation, const HandsNow& hands, const Camera& camera,
                 EmittedActs& acts) noexcept;

  bool has_view_ = true;  // there is a critical view to be had before anything is clipped; constant
  DissectionMonitor watch_;
  training::ErrorLog errors_;
  training::CriticalView view_;
  training::PhaseRecogniser phases_;
  std::array<HandState, kHandCount> hands_;
  bool was_achieved_ = false, was_completed_ = false;
  std::size_t told_errors_ = 0;
};

}  // namespace trocar::simulation
