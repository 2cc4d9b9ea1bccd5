// SPDX-License-Identifier: Apache-2.0
/// \file film.h  Where blood and bile wet the tissue: below each leak.
#pragma once

#include "trocar/render/renderer.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Runs of liquid down from the leaks of one snapshot.
class Film {
 public:
  explicit Film(const simulation::Snapshot& snapshot);
  bool IsEmpty() const { return runs_.empty(); }
  /// Adds what wets a place to its mark.
  void Wet(const math::Vec3& p_world, render::SurfaceMark& mark) const;

 private:
  struct Run {
    math::Vec3 start;
    double width, length;  // [m]
    double strength;       // 0 to 1
    bool is_blood;
  };
  std::vector<Run> runs_;
  math::Vec3 down_;
};

}  // namespace trocar::view
