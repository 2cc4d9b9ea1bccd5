// SPDX-License-Identifier: Apache-2.0
/// \file operation_judge.h  What the acts of an operation amount to: errors, phases, the critical view, and how it ended.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dissection_watch.h"
#include "trocar/session/operation_result.h"
#include "trocar/training/triplet.h"
#include "vessel_work.h"

namespace trocar::session {

/// One thing that a hand did in a tick.
struct HandAct {
  training::Triplet triplet;
  std::int32_t hand = -1;
};

class OperationJudge {
 public:
  OperationJudge();
  /// \param has_view  whether there is a critical view to be had before anything is clipped
  void Clear(bool has_view);

  // what happened; each real-time safe
  void OnClip(const ClipResult& clip, const VesselMap& map, const Vec3& p, int hand, double time) noexcept;
  void OnCut(const TubePlace& place, const VesselWork& vessels, const Vec3& p, int hand,
             double time) noexcept;
  void OnHole(const TubePlace& place, const VesselWork& vessels, const Vec3& p, int hand,
              double time) noexcept;
  void Report(training::OperationError error, const Vec3& p, int hand, double time) noexcept;
  void Note(const training::Triplet& triplet, int hand) noexcept;

  /// Once a tick, at its end.
  void Update(const DissectionWatch& watch, const surgery::FluidLedger& fluids, bool is_in_bag,
              bool is_leaving, const Vec3& p_pool, double time, double seconds) noexcept;

  const training::ErrorLog& Errors() const { return errors_; }
  const training::CriticalView& View() const { return view_; }
  const training::PhaseRecogniser& Phases() const { return phases_; }
  bool WasViewAchieved() const { return was_achieved_; }
  std::span<const HandAct> Acts() const { return std::span(acts_).first(act_count_); }

 private:
  training::ErrorLog errors_;
  training::CriticalView view_;
  training::PhaseRecogniser phases_;
  bool was_achieved_ = false, has_view_ = true;
  std::array<HandAct, 16> acts_{};
  std::size_t act_count_ = 0;
};

}  // namespace trocar::session
