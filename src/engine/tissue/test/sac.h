// SPDX-License-Identifier: Apache-2.0
/// \file sac.h  A sac of fluid on a bed, for tests that keep its volume.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "test_systems.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/volume_constraint.h"

namespace trocar::tissue {

/// Newton to the end, where a tick would stop at four parts in ten thousand.
inline constexpr SolverSettings kExact{.max_iterations = 1000,
                                       .tolerance = 1e-8,
                                       .max_error = 1e-9,
                                       .newton = {.max_steps = 100, .max_linear_iterations = 200}};
inline constexpr double kRadius = 0.015, kMembrane = 510.0, kTick = 1.0 / 120;

/// A sac on a bed: a sphere whose cap is tied by strands to fixed nodes.
struct Sac {
  TissueModel model;
  TissueState tissue;
  ConservationSettings settings;
  std::size_t organ_nodes = 0;

  explicit Sac(double foundation, int subdivisions = 3) {
    const auto mesh = geometry::MakeSphere({0.02, 0.05, -0.1}, kRadius, subdivisions);
    TissueDefinition definition = MakeMembrane(mesh, kMembrane, foundation);
    organ_nodes = definition.rest.size();
    for (std::uint32_t i = 0; i < organ_nodes; ++i) {
      if (mesh.positions[i].y < 0.05 + 0.8 * kRadius) continue;
      definition.fixed.push_back(static_cast<std::uint32_t>(definition.rest.size()));
      definition.strands.push_back({i, definition.fixed.back(), 30.0});
      definition.rest.push_back(mesh.positions[i] + math::Vec3{0, 0.001, 0});
      definition.mass.push_back(0.0);
      definition.shape_stiffness.push_back(0.0);
    }
    model = MakeTissueModel(definition);
    tissue = MakeRestState(model);
    settings.organs = {{0, static_cast<std::uint32_t>(organ_nodes), mesh.triangles}};
  }
  double Volume() const {
    return CalcClosedVolume(std::span(tissue.position).first(organ_nodes), settings.organs[0].triangles);
  }
  /// Nodes around the pole in a direction.
  std::vector<std::uint32_t> Pole(const math::Vec3& direction, double share = 0.93) const {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < organ_nodes; ++i) {
      if (math::Dot(model.rest[i] - math::Vec3{0.02, 0.05, -0.1}, direction) > share * kRadius)
        nodes.push_back(i);
    }
    return nodes;
  }
  void Hold(const std::vector<std::uint32_t>& nodes, const math::Pose& X) {
    for (const auto node : nodes) {
      tissue.condition[node] = NodeCondition::kPrescribed;
      tissue.position[node] = X * model.rest[node];
    }
  }
};

}  // namespace trocar::tissue
