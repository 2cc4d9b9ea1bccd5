// SPDX-License-Identifier: Apache-2.0
/// \file emitted_acts.h  Acts of hands on tissue in a tick, as it was at that moment. The simulation of an operation emits them,
/// the judge reads them at the end of the tick.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/cholecystectomy/vessel_judgement.h"
#include "trocar/instrument/hand.h"
#include "trocar/surgery/vessels.h"

namespace trocar::cholecystectomy {

/// One thing that a hand did.
struct HandAct {
  Triplet triplet;
  std::int32_t hand = -1;
};

/// An act that can be an error, with what decides whether it is one.
struct EmittedAct {
  enum class Kind : std::uint8_t {
    kError,  ///< `error`, whatever else is true
    kClip,
    kCut,  ///< through a duct or vessel
    kHole  ///< burnt or torn into one
  } kind = Kind::kError;
  math::Vec3 position;     ///< world frame [m]
  std::int32_t hand = -1;  ///< or -1
  OperationError error = OperationError::kExcessForce;
  surgery::ClipResult clip;  ///< of kClip
  VesselJudgement vessel;    ///< of the others but kError: the duct or vessel there
};

/// The acts of one tick. Fixed capacity; the same error of the same hand, and the same triplet of it, are kept once.
class EmittedActs {
 public:
  static constexpr std::size_t kMostActs = 128, kMostHandActs = 16;

  void Clear() noexcept {
    act_count_ = hand_act_count_ = 0;
    was_exchanged_ = {};
  }
  void Report(OperationError error, const math::Vec3& p, int hand) noexcept {
    for (const EmittedAct& act : Acts()) {
      if (act.kind == EmittedAct::Kind::kError && act.error == error && act.hand == hand) return;
    }
    EmittedAct act;
    act.position = p;
    act.hand = hand;
    act.error = error;
    Add(act);
  }
  void Add(const EmittedAct& act) noexcept {
    if (act_count_ < acts_.size()) acts_[act_count_++] = act;
  }
  void Add(const Triplet& triplet, int hand) noexcept {
    for (const HandAct& act : HandActs()) {
      if (act.triplet == triplet && act.hand == hand) return;
    }
    if (hand_act_count_ < hand_acts_.size()) hand_acts_[hand_act_count_++] = {triplet, hand};
  }
  void SetExchanged(int hand) noexcept { was_exchanged_[static_cast<std::size_t>(hand)] = true; }

  std::span<const EmittedAct> Acts() const { return std::span(acts_).first(act_count_); }
  std::span<const HandAct> HandActs() const { return std::span(hand_acts_).first(hand_act_count_); }
  /// Another tool was put into the trocar.
  bool WasExchanged(int hand) const { return was_exchanged_[static_cast<std::size_t>(hand)]; }

 private:
  std::array<EmittedAct, kMostActs> acts_{};
  std::array<HandAct, kMostHandActs> hand_acts_{};
  std::size_t act_count_ = 0, hand_act_count_ = 0;
  std::array<bool, instrument::kHandCount> was_exchanged_{};
};

}  // namespace trocar::cholecystectomy
