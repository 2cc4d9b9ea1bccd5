// SPDX-License-Identifier: Apache-2.0
/// \file film.h  Where blood and bile wet the tissue: below each leak, at the shore of the pool, where it was torn off.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/render/renderer.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Runs of liquid down from the leaks of one snapshot.
class Film {
 public:
  explicit Film(const simulation::Snapshot& snapshot);
  /// Liquid that lies there wets what it touches, and a little above its level.
  void AddPool(const render::Puddle& puddle);
  /// \param rows  (rows of Snapshot::positions) 1 where connective tissue was torn off; outlives this
  void SetRaw(std::span<const std::uint8_t> rows) { raw_ = rows; }
  bool IsEmpty() const { return runs_.empty() && pools_.empty() && raw_.empty(); }
  bool HasLiquid() const { return !runs_.empty() || !pools_.empty(); }
  /// Adds what wets a place to its mark.
  void Wet(const math::Vec3& p_world, render::SurfaceMark& mark) const;
  /// As above, for a node that may lie raw.
  void Wet(const math::Vec3& p_world, std::size_t row, render::SurfaceMark& mark) const;

 private:
  struct Run {
    math::Vec3 start;
    double width, length;  // [m]
    double strength;       // 0 to 1
    bool is_blood;
  };
  std::vector<Run> runs_;
  std::vector<render::Puddle> pools_;
  std::span<const std::uint8_t> raw_;
  math::Vec3 down_;
};

}  // namespace trocar::view
