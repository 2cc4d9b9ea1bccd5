// SPDX-License-Identifier: Apache-2.0
/// \file hand_acts.h  Acts of hands, instrument, verb and target, from the facts of a tick.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trocar/cholecystectomy/triplet.h"
#include "trocar/roles/roles.h"
#include "trocar/surgery/fact.h"

namespace trocar::cholecystectomy {

InstrumentKind InstrumentOf(instrument::ToolKind tool) noexcept;
/// Liver, gallbladder; nothing of another organ.
std::optional<Target> TargetOf(roles::OrganRole organ) noexcept;
/// Cystic duct, cystic artery; every other duct or artery is a blood vessel to the data sets.
Target TargetOf(roles::TubeRole tube) noexcept;
Target TargetOf(roles::StrandRole strand) noexcept;

/// Names of a scene's parts in the data sets.
struct TargetTable {
  std::vector<Target> surfaces;  ///< (Simulation::Surfaces())
  std::vector<Target> strands;   ///< (Simulation::Strands())

  /// kNullTarget of none.
  Target OfSurface(std::int32_t surface) const noexcept;
  /// Of the strand of a fact, else of its surface.
  Target Of(const surgery::Fact& fact) const noexcept;
};

/// Act that a fact is; nothing where it is no act of a tool on a target. Holding is none: it is a state, not a fact of a tick.
///
/// Parting tissue is dissection, with a jaw that opens, with a hook, and whichever pedal is down: current into a fibre dissects.
/// Current into the wall of an organ, a duct or a vessel dissects with the cut pedal and coagulates with the other; a bipolar tool's
/// coagulation coagulates whatever it holds.
std::optional<Triplet> TripletOf(const surgery::Fact& fact, const TargetTable& targets) noexcept;
/// Jaws that hold: they grasp, with more than kRetraction they retract, and they pack while a bag is open for the gallbladder.
/// \param pull  force on the tool [N]
Triplet TripletOfHold(instrument::ToolKind tool, Target held, double pull, bool is_bag_open) noexcept;
inline constexpr double kRetraction = 0.3;  ///< [N]

/// Whether a fact is an act that is done at once, as a clip, a cut and a spread are, and is seen as one for kMoment.
bool IsMoment(surgery::FactKind kind) noexcept;
inline constexpr double kMoment = 1.0;  ///< [s]

/// Act of one hand in a tick, as evidence of a phase.
struct SeenAct {
  Triplet triplet;
  double seconds = 0;  ///< for which it counts, > 0
};

/// Different acts of one tick, of all hands, in the order of the facts. Fixed capacity.
class HandActs {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// Once for each hand; beyond the capacity left out.
  /// \param seconds  for which it counts: those of the tick, or kMoment
  void Add(const Triplet& triplet, int hand, double seconds) noexcept;
  std::span<const SeenAct> Acts() const { return std::span(acts_).first(count_); }

 private:
  std::array<SeenAct, kCapacity> acts_{};
  std::array<int, kCapacity> hands_{};
  std::size_t count_ = 0;
};

}  // namespace trocar::cholecystectomy
