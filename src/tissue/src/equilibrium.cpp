// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "capacity.h"
#include "node_force.h"
#include "solver_content.h"
#include "trocar/core/assert.h"

namespace trocar::tissue {

namespace {

/// True where everything that a solve takes is finite.
bool IsFinite(const TissueLoad& load, const TissueState& state) noexcept {
  bool is_finite =
      math::IsFinite(load.gravity) && std::isfinite(load.stiffness_scale) && std::isfinite(load.shape_scale);
  for (const ContactSpring& c : load.contacts) {
    is_finite = is_finite && math::IsFinite(c.normal) && std::isfinite(c.offset) &&
                std::isfinite(c.stiffness) && std::isfinite(c.weights[0]) && std::isfinite(c.weights[1]) &&
                std::isfinite(c.weights[2]);
  }
  for (const Vec3& f : load.external_force) is_finite = is_finite && math::IsFinite(f);
  for (const Vec3& p : state.position) is_finite = is_finite && math::IsFinite(p);
  return is_finite;
}

/// True where an intact strand holds the node.
bool HangsOnStrand(const TissueModel& model, const TissueState& state, std::uint32_t node) noexcept {
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
    if (state.strand_is_intact[model.half_strands[h].strand]) return true;
  }
  return false;
}

/// One solve with the springs as they are linearised now.
SolveReport SolveLinearised(EquilibriumSolver::Content& c, const SolverSettings& settings,
                            const TissueLoad& load, TissueState& state, ConstraintSet* constraints,
                            std::span<const Vec3> extrapolation) noexcept {
  if (settings.kind == SolverKind::kRelaxationPaper)
    return SolveRelaxationPaper(c, settings, load, state, constraints);
  if (settings.kind == SolverKind::kGaussSeidelBrown2001)
    return SolveGaussSeidelBrown2001(c, settings, load, state, constraints);
  const Workers::Session session(*c.workers);
  switch (settings.kind) {
    case SolverKind::kChebyshevJacobi2015:
      return SolveChebyshevJacobiWang2015(c, settings, load, state, constraints);
    case SolverKind::kAcceleratedDescent:
      // a stencil has no place for springs of their own; the recurrence in double precision has
      if (c.accelerated->IsStructured() && !c.spring_linearisation->IsPlain())
        return SolveChebyshevJacobiWang2015(c, settings, load, state, constraints);
      return c.accelerated->Solve(*c.kernels, *c.workers, settings, load, state, constraints);
    case SolverKind::kNewtonMultigrid:
      return c.newton->Solve(*c.kernels, *c.workers, settings, load, state, constraints, extrapolation);
    default:
      return SolveAdaptive(c, settings, load, state, constraints, extrapolation);
  }
}

}  // namespace

EquilibriumSolver::EquilibriumSolver(const TissueModel& model, int threads)
    : EquilibriumSolver(model, SolverOptions{.threads = threads}) {}

EquilibriumSolver::EquilibriumSolver(const TissueModel& model, const SolverOptions& options)
    : content_(std::make_unique<Content>()) {
  const std::size_t n = model.Size();
  Content& c = *content_;
  c.laws = &model;
  c.kernels = &GetKernels(options.simd);
  c.workers = std::make_unique<Workers>(options.threads);
  c.newton = std::make_unique<NewtonMultigrid>(model);
  c.accelerated = std::make_unique<AcceleratedDescent>(model, c.newton->Springs(), options.recognises_grids);
  SetSlicedSprings(model, c.springs);
  c.spring_linearisation = std::make_unique<SpringLinearisation>(model, c.springs, c.newton->Springs());
  c.model = &c.spring_linearisation->Model();
  c.SetStrandNodes(model);
  c.wave.reserve(n);
  c.visited.resize(n);
  c.residual.resize(n);
  c.unconstrained_condition.resize(n);
  c.previous.resize(n);
  c.blocks.resize(n);
  c.slices.resize((n + kLanes - 1) / kLanes, SliceData{});
  c.constant_force.resize(n);
  c.touched_nodes.reserve(3 * kMaxContacts);
  c.chunk_reports.resize(n / CalcChunk(n) + 1);
  if (options.spare_share > 0.0) c.Reserve(options.spare_share);
}

void EquilibriumSolver::UpdateTopology(const TissueModel& model) {
  Content& c = *content_;
  TROCAR_ASSERT(model.Size() == c.model->Size());
  c.laws = &model;
  c.newton->SetModel(model);
  c.accelerated->SetModel(model);
  SetSlicedSprings(model, c.springs);
  c.spring_linearisation->SetModel(model);
  c.SetStrandNodes(model);
}

void EquilibriumSolver::Content::SetStrandNodes(const TissueModel& with) {
  strand_nodes.clear();
  for (std::uint32_t i = 0; i < with.Size(); ++i) {
    if (with.strand_starts[i] < with.strand_starts[i + 1]) strand_nodes.push_back(i);
  }
}

void EquilibriumSolver::Content::Reserve(double share) {
  newton->Reserve(share);
  accelerated->Reserve(share);
  spring_linearisation->Reserve(share);
  ReserveMore(share, springs.starts, springs.others, springs.stiffness, springs.stiffness_times_rest,
              strand_nodes);
}

EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

bool EquilibriumSolver::IsStructured() const noexcept {
  return content_->accelerated->IsStructured();
}

SolveReport EquilibriumSolver::Solve(const SolverSettings& settings, const TissueLoad& load,
                                     TissueState& state, ConstraintSet* constraints,
                                     std::span<const Vec3> extrapolation) noexcept {
  TROCAR_ASSERT(state.position.size() == content_->model->Size());
  TROCAR_ASSERT(load.contacts.size() <= kMaxContacts);
  Content& c = *content_;
  if (!IsFinite(load, state)) return {.is_finite = false};
  if (!c.spring_linearisation->UpdateFactors(state)) return {.is_finite = false};
  // a node without any spring has no equilibrium: it stays where it is
  const std::span<const std::uint32_t> unconstrained = c.spring_linearisation->Unconstrained();
  for (std::size_t i = 0; i < unconstrained.size(); ++i) {
    c.unconstrained_condition[i] = state.condition[unconstrained[i]];
    if (!HangsOnStrand(*c.laws, state, unconstrained[i]))
      state.condition[unconstrained[i]] = NodeCondition::kPrescribed;
  }
  const SolveReport report =
      c.spring_linearisation->Iterate(settings, state, [&](const SolverSettings& rest) noexcept {
        // the first solve goes there, the others begin where it ended
        const auto guess = std::exchange(extrapolation, {});
        return SolveLinearised(c, rest, load, state, constraints, guess);
      });
  for (std::size_t i = 0; i < unconstrained.size(); ++i)
    state.condition[unconstrained[i]] = c.unconstrained_condition[i];
  return report;
}

Vec3 EquilibriumSolver::CalcReaction(const TissueLoad& load, const TissueState& state,
                                     std::span<const std::uint32_t> nodes) const noexcept {
  Vec3 force;
  for (const auto node : nodes) force += GatherLawForce(*content_->laws, state, load, node);
  return force;
}

double CalcLargestAlpha(const TissueModel& model, const TissueLoad& load) {
  double bound = 0;
  for (std::size_t i = 0; i < model.Size(); ++i) {
    double links = 0;
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h)
      links += model.half_springs[h].stiffness;
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h)
      links += model.half_strands[h].stiffness;
    bound = std::max(bound, 2.0 * load.stiffness_scale * links + load.shape_scale * model.shape_stiffness[i]);
  }
  double contacts = 0;
  for (const ContactSpring& contact : load.contacts) contacts += contact.stiffness;
  bound += contacts;
  return bound > 0.0 ? 2.0 / bound : 0.0;
}

}  // namespace trocar::tissue
