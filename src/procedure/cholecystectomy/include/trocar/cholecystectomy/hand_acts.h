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
std::optional<Triplet> TripletOf(const surgery::Fact& fact, const TargetTable& targets) noexcept;

/// Different acts of one tick, of all hands, in the order of the facts. Fixed capacity.
class HandActs {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// Once for each hand; beyond the capacity left out.
  void Add(const Triplet& triplet, int hand) noexcept;
  std::span<const Triplet> Triplets() const { return std::span(triplets_).first(count_); }

 private:
  std::array<Triplet, kCapacity> triplets_{};
  std::array<int, kCapacity> hands_{};
  std::size_t count_ = 0;
};

}  // namespace trocar::cholecystectomy
