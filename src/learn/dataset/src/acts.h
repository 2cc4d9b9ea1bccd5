// SPDX-License-Identifier: Apache-2.0
/// \file acts.h  Acts of each hand in the terms of CholecT50, from what a tick publishes and what the surgeon commands.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/cholecystectomy/triplet.h"
#include "trocar/scene/input.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/labels.h"

namespace trocar::dataset {

struct Act {
  cholecystectomy::Triplet triplet;
  std::size_t hand = 0;
  view::LabelClass tool = view::LabelClass::kNothing;  ///< its label in the picture
};

/// Follows an attempt tick by tick: a cut or a clip is an act of some moments, and must not fall between two frames.
class ActWatch {
 public:
  ActWatch(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces)
      : scene_(&scene), surfaces_(surfaces) {}

  void Look(const simulation::Snapshot& now, const scene::Input& input);
  /// Of hands whose tool is one of CholecT50's instruments.
  std::vector<Act> Acts() const;

 private:
  cholecystectomy::Target TargetOf(std::int32_t surface) const;

  const scene::Scene* scene_;
  std::span<const scene::SurfaceInfo> surfaces_;
  std::array<Act, instrument::kHandCount> acts_;
  std::array<bool, instrument::kHandCount> is_instrument_{};
  std::array<double, instrument::kHandCount> cut_until_{}, clip_until_{};  // [s]
  std::array<cholecystectomy::Target, instrument::kHandCount> last_target_{};
  std::size_t cuts_ = 0, clips_ = 0;
  std::uint32_t topology_ = 0;
};

}  // namespace trocar::dataset
