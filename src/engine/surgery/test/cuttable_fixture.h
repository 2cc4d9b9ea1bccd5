// SPDX-License-Identifier: Apache-2.0
/// \file cuttable_fixture.h  One organ with spare nodes, its system, and the change of each cut taken into both.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/surgery/cuttable_organ.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::surgery {

struct CuttableSystem {
  tissue::TissueDefinition definition;
  tissue::TissueModel model;
  tissue::TissueState state;
  std::optional<CuttableOrgan> organ;
  TopologyChange change;
  geometry::CutFront front;

  CuttableSystem(const geometry::TriangleMesh& mesh, const WallMaterial& wall,
                 const geometry::CutSettings& cut, std::uint32_t spare_count = 2000) {
    definition.rest = mesh.positions;
    for (const double area : geometry::CalcVertexAreas(mesh.positions, mesh.triangles)) {
      definition.mass.push_back(wall.mass_by_area * area);
      definition.shape_stiffness.push_back(wall.foundation * area);
    }
    definition.springs = CalcWallSprings(mesh, wall);
    CuttableOrganSettings settings{wall, cut, 0, 0, spare_count};
    settings.first_spare = AddSpareNodes(spare_count, definition);
    auto made = CuttableOrgan::Make(mesh, settings);
    EXPECT_TRUE(made.ok());
    organ.emplace(std::move(*made));
    organ->ReserveFor(change);
    Rebuild();
    state = tissue::MakeRestState(model);
  }

  void Rebuild() { model = tissue::MakeTissueModel(definition); }

  /// One tick: cut, then take the change into definition, model and state.
  geometry::CutReport Cut(const geometry::BladeEdge& before, const geometry::BladeEdge& now) {
    change.Clear();
    const auto report = organ->Cut(before, now, state.position, front, change);
    const auto origins = ApplyChange(change, definition);
    Rebuild();
    ApplyChange(change, origins, model, state);
    return report;
  }

  std::size_t CutLine(const geometry::BladeEdge& from, const geometry::BladeEdge& to, int ticks) {
    std::size_t opened = 0;
    geometry::BladeEdge before = from;
    front = {};
    for (int i = 1; i <= ticks; ++i) {
      const double s = static_cast<double>(i) / ticks;
      const geometry::BladeEdge now{math::Lerp(from.a, to.a, s), math::Lerp(from.b, to.b, s)};
      opened += Cut(before, now).opened;
      before = now;
    }
    return opened;
  }
};

inline geometry::BladeEdge Upright(double x, double y) {
  return {{x, y, -0.01}, {x, y, 0.01}};
}

}  // namespace trocar::surgery
