// SPDX-License-Identifier: Apache-2.0
/// \file band_view.h  The cords of a training task: round, coloured, piece by piece as far as they hold.
#pragma once

#include <span>
#include <vector>

#include "trocar/render/renderer.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Nothing where a scene has no bands.
class BandView {
 public:
  /// Uploads everything.
  /// \param strands  as in Simulation::Strands()
  void Add(render::Renderer& renderer, const scene::Scene& scene, std::span<const scene::StrandInfo> strands,
           std::span<const math::Vec3> start);
  void Append(const simulation::Snapshot& snapshot, std::vector<render::SurfaceDraw>& surfaces) const;

 private:
  struct Piece {
    std::size_t strand = 0;
    std::uint32_t a = 0, b = 0;  // rows of Snapshot::positions
    render::SurfaceId surface;
  };
  std::vector<Piece> pieces_;
};

}  // namespace trocar::view
