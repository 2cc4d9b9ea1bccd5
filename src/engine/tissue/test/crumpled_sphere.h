// SPDX-License-Identifier: Apache-2.0
/// \file crumpled_sphere.h  A start far outside the range where a solver is provably stable.
#pragma once

#include <cmath>

#include "test_systems.h"

namespace trocar::tissue {

/// A spherical membrane, each node of it moved by up to a third of its radius.
struct CrumpledSphere {
  TissueModel model = MakeTissueModel(MakeMembrane(geometry::MakeSphere({0, 0, 0}, 0.03, 3), 400.0, 2e4));
  TissueState state = MakeRestState(model);

  CrumpledSphere() {
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const auto wobble = [&](int salt) {
        return 0.01 * std::sin(12.9898 * static_cast<double>(i) + 78.233 * salt);
      };
      state.position[i] += math::Vec3{wobble(1), wobble(2), wobble(3)};
    }
  }
};

}  // namespace trocar::tissue
