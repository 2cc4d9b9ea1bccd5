// SPDX-License-Identifier: Apache-2.0
/// \file stone_view.h  Gallstones outside of the gallbladder.
#pragma once

#include <vector>

#include "trocar/render/renderer.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Nothing where nobody has spilled a stone.
class StoneView {
 public:
  /// Adds the stones that lie in the abdomen or between jaws; uploads each when it is first seen.
  void AddTo(render::Renderer& renderer, render::Frame& frame,
             const simulation::OperationSnapshot& operation);

 private:
  struct Shape {
    render::SurfaceId surface;
    double radius = 0;  // that it was made for [m]; 0: not made
  };
  std::vector<Shape> shapes_;  // (stones)
};

}  // namespace trocar::view
