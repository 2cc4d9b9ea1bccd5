// SPDX-License-Identifier: Apache-2.0
/// \file evaluated.h  A model's balance and stiffness as the solvers see them.
#pragma once

#include <vector>

#include "linearisation.h"
#include "solver_model.h"

namespace trocar::tissue {

/// The balance and the stiffness of one state, in the solvers' order.
struct Evaluated {
  SolverModel made;
  const OrderedModel& model = made.ordered;
  OrderedSprings springs;
  OrderedLoad load;
  LinkHierarchy hierarchy;
  Linearisation linearisation;
  Balance balance;
  std::vector<Double4> position;
  Workers workers;
  const Kernels* kernels;

  Evaluated(const TissueModel& from, const TissueLoad& loads, const TissueState& state, base::SimdLevel level)
      : made(MakeSolverModel(from)),
        springs(MakeOrderedSprings(from, model)),
        hierarchy(made.hierarchy, model.graph),
        linearisation(springs),
        kernels(&GetKernels(level)) {
    linearisation.SetModel(model);
    load.constant.resize(model.Size()), load.is_free.resize(model.Size());
    load.contacts.reserve(kMaxContacts);
    SetOrderedLoad(model, loads, state, load);
    balance.residual.resize(model.layout.PaddedNodes());
    balance.is_pressing.resize(kMaxContacts);
    position.resize(model.layout.PaddedNodes());
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      const math::Vec3& p = state.position[model.old_of_new[i]];
      position[i] = {p.x, p.y, p.z, 0.0};
    }
    linearisation.SetLoad(load, state.strand_is_intact, hierarchy.Finest());
    linearisation.Linearise(*kernels, workers, position, hierarchy.Finest(), balance);
  }
};

}  // namespace trocar::tissue
