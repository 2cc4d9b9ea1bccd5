// SPDX-License-Identifier: Apache-2.0
/// \file organ_fixture.h  A spherical organ on a foundation, for tests of what tools do to it.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/material.h"

namespace trocar::surgery {

class OrganFixture : public testing::Test {
 protected:
  OrganFixture() {
    mesh_ = geometry::MakeSphere({0, 0, 0}, 0.02, 3);
    tissue::TissueDefinition definition;
    definition.rest = mesh_.positions;
    definition.mass.assign(mesh_.positions.size(), 1e-4);
    const auto areas = geometry::CalcVertexAreas(mesh_.positions, mesh_.triangles);
    definition.shape_stiffness = tissue::CalcFoundationStiffness(areas, 5400, 0.02);
    const auto edges = geometry::FindEdges(mesh_.triangles);
    const auto stiffness = tissue::CalcEdgeStiffness(mesh_.positions, mesh_.triangles, edges, 40);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto [a, b] = edges[i];
      definition.springs.push_back(
          {a, b, stiffness[i], math::Distance(mesh_.positions[a], mesh_.positions[b])});
    }
    model_ = tissue::MakeTissueModel(definition);
    state_ = tissue::MakeRestState(model_);
    auto surface = MakeOrganSurface(state_.position, 0, mesh_);
    EXPECT_TRUE(surface.ok());
    organs_.push_back(std::move(*surface));
    solver_.emplace(model_, 1);
  }

  geometry::TriangleMesh mesh_;
  tissue::TissueModel model_;
  tissue::TissueState state_;
  std::vector<OrganSurface> organs_;
  std::optional<tissue::EquilibriumSolver> solver_;
  instrument::Tool tool_;
};

}  // namespace trocar::surgery
