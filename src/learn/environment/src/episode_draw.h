// SPDX-License-Identifier: Apache-2.0
/// \file episode_draw.h  What the seed of an episode decides beside the task's layout.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/environment/settings.h"
#include "trocar/scene/scene.h"

namespace trocar::environment {

/// Drawn once for an episode; saved with it.
struct EpisodeDraw {
  std::uint64_t seed = 0;                                   ///< of the episode
  std::uint64_t choice = 0;                                 ///< chooses among models
  std::array<double, kVariedCount> values{};                ///< indexed by Varied
  std::array<math::Vec3, instrument::kHandCount> asides{};  ///< directions of the tips' starts, unit
  double aside_pan = 0, aside_tilt = 0;                     ///< direction of the laparoscope's start, unit

  friend bool operator==(const EpisodeDraw&, const EpisodeDraw&) = default;
  double Get(Varied quantity) const { return values[static_cast<std::size_t>(quantity)]; }
};

/// \return kUsage for a range out of its limits, or upside down
base::Status CheckRanges(const Ranges& ranges);

/// Each quantity has its own numbers of the seed's row, so that one that does not vary changes none of the others.
EpisodeDraw DrawEpisode(std::uint64_t seed, const Ranges& ranges);

/// The scene's home, moved as was drawn; jaws as they were.
scene::Input CalcStart(const scene::Scene& scene, const EpisodeDraw& draw);

/// Whether the scene has to be made anew for it.
bool ChangesThings(const EpisodeDraw& draw) noexcept;
/// Mass and friction of things that move.
void ChangeThings(const EpisodeDraw& draw, scene::Scene& scene);

}  // namespace trocar::environment
