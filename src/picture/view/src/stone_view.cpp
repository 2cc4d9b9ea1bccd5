// SPDX-License-Identifier: Apache-2.0
#include "stone_view.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/primitives.h"
#include "trocar/math/noise.h"
#include "trocar/math/random.h"
#include "trocar/view/labels.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kFacetDepth = 0.16;  // of a radius, that a facet is cut off where stones lay on each other
constexpr int kFacets = 9;
constexpr double kRough = 0.05;       // of a radius
constexpr double kGolden = 2.399963;  // rad between turns of successive facets

/// A stone with facets rounded by its neighbours, rough as a mulberry; no two are alike.
geometry::TriangleMesh MakeStone(double radius, std::uint64_t seed) {
  math::Random random(seed);
  std::vector<Vec3> facets;
  std::vector<double> depths;
  for (int i = 0; i < kFacets; ++i) {
    const double z = 1.0 - 2.0 * (i + random.Uniform()) / kFacets,
                 turn = kGolden * i + random.Uniform(-0.5, 0.5);
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
    facets.push_back({across * std::cos(turn), across * std::sin(turn), z});
    depths.push_back(1.0 - kFacetDepth * random.Uniform());
  }
  const Vec3 offset{random.Uniform(0, 50), random.Uniform(0, 50), random.Uniform(0, 50)};
  geometry::TriangleMesh stone = geometry::MakeSphere({}, 1.0, 4);
  for (Vec3& p : stone.positions) {
    double reach = 1.0;
    for (int i = 0; i < kFacets; ++i) {
      const auto f = static_cast<std::size_t>(i);
      const double toward = math::Dot(p, facets[f]);
      if (toward > 0.0) reach = std::min(reach, depths[f] / toward);
    }
    const double rough =
        math::CalcGradientNoise(4.0 * p + offset, 0) + 0.5 * math::CalcGradientNoise(9.0 * p + offset, 0);
    p *= radius * (reach + kRough * rough);
  }
  return stone;
}

}  // namespace

void StoneView::AddTo(render::Renderer& renderer, render::Frame& frame,
                      const simulation::OperationSnapshot& operation) {
  shapes_.resize(std::max(shapes_.size(), operation.stones.size()));
  for (std::size_t i = 0; i < operation.stones.size(); ++i) {
    const surgery::StoneSnapshot& stone = operation.stones[i];
    if (stone.place != surgery::StonePlace::kSpilled && stone.place != surgery::StonePlace::kHeld) continue;
    Shape& shape = shapes_[i];
    if (shape.radius != stone.radius) {
      if (shape.radius > 0.0) renderer.RemoveSurface(shape.surface);
      shape = {renderer.AddSurface(MakeStone(stone.radius, i), render::Material::kStone), stone.radius};
    }
    frame.surfaces.push_back({shape.surface, {{}, stone.position}, MakeLabel(LabelClass::kGallstone, i)});
  }
}

}  // namespace trocar::view
