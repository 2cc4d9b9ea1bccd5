// SPDX-License-Identifier: Apache-2.0
/// \file gauss_seidel_brown2001.cpp  Gauss-Seidel in waves: what is out of balance moves first, then its
/// neighbours.
///
/// A sweep starts at the nodes whose residual is above the tolerance. After a tool has moved a few nodes
/// those are their neighbours, so that a local deformation costs what its surroundings cost, not what the
/// organ does. Each node moves by R_i / (sum_j k_ij + k_v), which lowers the energy wherever the others are,
/// and hands the wave on to its neighbours; a node in balance stops it.
/// Source: Brown, Sorkin, Bruyns, Latombe, Montgomery, Stephanides, "Real-time simulation of deformable
/// objects: tools and application", Computer Animation 2001 (the paper's reference [8]).
#include <algorithm>
#include <cmath>

#include "node_balance.h"
#include "solver_content.h"

namespace trocar::tissue {
namespace {

/// Stiffness that bounds what node i feels while its neighbours stay [N/m].
double CalcNodeStiffness(const TissueModel& model, const TissueLoad& load, const TissueState& state,
                         std::uint32_t i) noexcept {
  double links = SumSpringStiffness(model, i);
  for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
    if (state.strand_is_intact[model.half_strands[h].strand]) links += model.half_strands[h].stiffness;
  }
  double contacts = 0;
  for (const ContactSpring& contact : load.contacts) {
    for (int corner = 0; corner < 3; ++corner) {
      if (contact.nodes[corner] == i)
        contacts += contact.weights[corner] * contact.weights[corner] * contact.stiffness;
    }
  }
  if (HasElements(load)) contacts += CalcElementBound(*load.elements, state.position, i);
  return load.stiffness_scale * links + load.shape_scale * model.shape_stiffness[i] + contacts;
}

}  // namespace

GaussSeidelScratch::GaussSeidelScratch(std::size_t node_count) : visited(node_count), residual(node_count) {
  wave.reserve(node_count);
}

SolveReport SolveGaussSeidelBrown2001(const TissueModel& model, GaussSeidelScratch& scratch,
                                      const IterationSettings& settings, const TissueLoad& load,
                                      TissueState& state, ConstraintSet* constraints) noexcept {
  const auto n = static_cast<std::uint32_t>(model.Size());
  std::vector<std::uint32_t>& wave = scratch.wave;
  const auto calc_residual = [&](std::uint32_t i) {
    return GatherNodeForce(model, state.strand_is_intact, load, state.position, i) +
           GatherContactForce(load, state.position, i);
  };
  std::fill(scratch.visited.begin(), scratch.visited.end(), 0u);
  SolveReport report;
  while (true) {
    // every node's balance: where the next wave starts, and whether one is needed
    double largest = 0, scale = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (state.condition[i] == NodeCondition::kPrescribed) continue;
      scale = math::Max(scale, CalcForceScale(model, load, state.position, i));
      scratch.residual[i] = math::Norm(calc_residual(i));
      largest = math::Max(largest, scratch.residual[i]);
    }
    report.force_scale = scale;
    report.residual = scale > 0.0 ? largest / scale : 0.0;
    report.converged = report.residual <= settings.tolerance;
    if (report.converged || report.iterations >= settings.max_iterations || !std::isfinite(largest))
      return report;
    const double threshold = settings.tolerance * scale;
    const auto sweep = static_cast<std::uint32_t>(++report.iterations);
    wave.clear();
    for (std::uint32_t i = 0; i < n; ++i) {
      if (state.condition[i] == NodeCondition::kPrescribed || !(scratch.residual[i] > threshold)) continue;
      scratch.visited[i] = sweep;
      wave.push_back(i);
    }
    for (std::size_t at = 0; at < wave.size(); ++at) {
      const std::uint32_t i = wave[at];
      const math::Vec3 residual = calc_residual(i);
      if (!(math::SquaredNorm(residual) > threshold * threshold)) continue;  // the wave ends here
      const double stiffness = CalcNodeStiffness(model, load, state, i);
      if (stiffness > 0.0) state.position[i] += residual / stiffness;
      const auto reach = [&](std::uint32_t other) {
        if (scratch.visited[other] == sweep || state.condition[other] == NodeCondition::kPrescribed) return;
        scratch.visited[other] = sweep;
        wave.push_back(other);
      };
      ForEachNeighbour(model, i, reach);
      if (HasElements(load)) {
        load.elements->ForEach([&](const auto& element) {
          const auto& nodes = element.nodes;
          if (std::find(nodes.begin(), nodes.end(), i) != nodes.end())
            std::for_each(nodes.begin(), nodes.end(), reach);
        });
      }
    }
    if (constraints != nullptr && report.iterations % constraints->Interval() == 0)
      constraints->Project(state, {});
  }
}

}  // namespace trocar::tissue
