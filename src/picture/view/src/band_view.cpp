// SPDX-License-Identifier: Apache-2.0
#include "band_view.h"

#include "object_view.h"
#include "trocar/view/labels.h"

namespace trocar::view {

void BandView::Add(render::Renderer& renderer, const scene::Scene& scene,
                   std::span<const scene::StrandInfo> strands, std::span<const math::Vec3> start) {
  if (!scene.model) return;
  std::int32_t last = -1;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    const scene::StrandInfo& info = strands[i];
    if (info.band < 0) continue;
    // the pieces of a band follow each other and are equally long
    if (info.band != last) {
      const scene::ModelBand& band = scene.model->bands[static_cast<std::size_t>(info.band)];
      const double half = 0.5 * math::Distance(start[info.a], start[info.b]);
      pieces_.push_back(
          {i, info.a, info.b, renderer.AddSurface(MakeCapsule(band.radius, half), MaterialOf(band.colour))});
    } else {
      pieces_.push_back({i, info.a, info.b, pieces_.back().surface});
    }
    last = info.band;
  }
}

void BandView::Append(const simulation::Snapshot& snapshot,
                      std::vector<render::SurfaceDraw>& surfaces) const {
  for (const Piece& piece : pieces_) {
    if (snapshot.operation.strand_is_intact[piece.strand] == 0) continue;
    const math::Vec3 &a = snapshot.positions[piece.a], &b = snapshot.positions[piece.b];
    surfaces.push_back(
        {piece.surface,
         {math::RotationBetween({0, 0, 1}, math::Normalized(b - a, {0, 0, 1})), math::Lerp(a, b, 0.5)},
         MakeLabel(LabelClass::kTissueModel)});
  }
}

}  // namespace trocar::view
