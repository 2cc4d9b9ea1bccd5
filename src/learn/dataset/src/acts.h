// SPDX-License-Identifier: Apache-2.0
/// \file acts.h  Acts of each hand in the terms of CholecT50, from the facts of a tick and what its jaws hold. Which fact is which act
/// stands in cholecystectomy/hand_acts.h, where the phases have it from too.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/cholecystectomy/hand_acts.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/labels.h"

namespace trocar::dataset {

/// Tool that a hand has in use.
const instrument::Tool& ToolOf(const scene::Scene& scene, const simulation::Snapshot& now, std::size_t hand);

struct Act {
  cholecystectomy::Triplet triplet;
  std::size_t hand = 0;
  view::LabelClass tool = view::LabelClass::kNothing;  ///< its label in the picture
};

/// Follows an attempt tick by tick: a cut, a clip or a spread is seen as an act of some moments, and must not fall between two frames.
class ActWatch {
 public:
  ActWatch(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
           std::span<const scene::StrandInfo> strands);

  /// One tick.
  void Look(const simulation::Snapshot& now);
  /// Of hands whose tool is one of CholecT50's instruments.
  std::vector<Act> Acts() const;

 private:
  /// What is still seen of it.
  struct Moment {
    cholecystectomy::Triplet triplet;
    double until = 0;  ///< [s]
  };
  cholecystectomy::Triplet ActOf(const simulation::Snapshot& now, std::size_t hand);

  const scene::Scene* scene_;
  cholecystectomy::TargetTable targets_;
  std::array<Act, instrument::kHandCount> acts_;
  std::array<bool, instrument::kHandCount> is_instrument_{};
  std::array<Moment, instrument::kHandCount> moments_;
};

}  // namespace trocar::dataset
