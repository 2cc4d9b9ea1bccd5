// SPDX-License-Identifier: Apache-2.0
#include "solver_model.h"

#include "trocar/base/spare_capacity.h"

namespace trocar::tissue {

void SolverModelBuilder::Build(const TissueModel& model, SolverModel& made) {
  SetOrderedModel(model, ordered_, made.ordered);
  hierarchy_.Build(made.ordered.graph, made.ordered.graph_stiffness, made.hierarchy);
  made.ends.assign(model.SpringCount(), {});
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      SpringEnds& ends = made.ends[half.spring];
      if (i < half.other) {
        ends.a = i, ends.half_a = h;
      } else {
        ends.b = i, ends.half_b = h;
      }
    }
  }
}

SolverModel MakeSolverModel(const TissueModel& model) {
  SolverModel made;
  SolverModelBuilder().Build(model, made);
  return made;
}

void SolverModelBuilder::Reserve(const SolverModel& like, double share, SolverModel& own) {
  ordered_.Reserve(like.ordered, share);
  own.ordered.Reserve(like.ordered, share);
  hierarchy_.Reserve(like.hierarchy, share, own.hierarchy);
  own.ends.reserve(base::AddSpare(like.ends.size(), share));
}

}  // namespace trocar::tissue
