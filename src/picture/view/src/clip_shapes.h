// SPDX-License-Identifier: Apache-2.0
/// \file clip_shapes.h  Titanium clips, from open to closed.
#pragma once

#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/renderer.h"
#include "trocar/simulation/operation_snapshot.h"

namespace trocar::view {

inline constexpr double kClipLength = 0.009;  ///< from the bend to the tips [m]

/// A bent strip: both legs along +x, `gap` apart, in the frame of simulation::ClipSnapshot. The same connectivity for every
/// gap.
/// \param gap  between the legs [m], >= 0
geometry::TriangleMesh MakeClip(double gap);

class ClipShapes {
 public:
  /// Adds the clips of a snapshot, uploading those that are new or have closed further.
  void AddTo(render::Renderer& renderer, render::Frame& frame,
             const simulation::OperationSnapshot& operation);

 private:
  struct Shown {
    render::SurfaceId surface;
    double gap = 0;  // that is on the graphics card [m]
  };
  std::vector<Shown> shown_;  // in the order of OperationSnapshot::clips
};

}  // namespace trocar::view
