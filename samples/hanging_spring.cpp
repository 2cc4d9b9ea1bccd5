// SPDX-License-Identifier: Apache-2.0
/// \file hanging_spring.cpp  The smallest tissue: a weight on a spring, x = m g / k.
#include <cstdio>

#include "trocar/tissue/equilibrium.h"

int main() {
  using namespace trocar;
  tissue::TissueDefinition definition;
  definition.rest = {{0, 0, 0}, {0, 0, -0.1}};
  definition.mass = {0, 0.05};
  definition.shape_stiffness = {0, 0};
  definition.fixed = {0};
  definition.springs = {{0, 1, 20.0, 0.1}};

  const tissue::TissueModel model = tissue::MakeTissueModel(definition);
  tissue::TissueState state = tissue::MakeRestState(model);
  tissue::EquilibriumSolver solver(model);
  const tissue::SolveReport report = solver.Solve({tissue::SolverKind::kRelaxationPaper, 10'000, 1e-9, 0.0},
                                                  {.gravity = {0, 0, -9.81}}, state);
  std::printf("50 g on 20 N/m sinks %.3f mm (m g / k = 24.525 mm) after %d iterations\n",
              1000.0 * (-0.1 - state.position[1].z), report.iterations);
}
