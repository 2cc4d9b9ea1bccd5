// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "node_force.h"
#include "solver_content.h"
#include "trocar/base/assert.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {

using math::Vec3;

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
  if (HasElements(load)) is_finite = is_finite && AreUsable(*load.elements, state.position.size());
  return is_finite;
}

/// True where an intact strand or an element holds the node.
bool HangsOnLink(const TissueModel& model, const TissueLoad& load, const TissueState& state,
                 std::uint32_t node) noexcept {
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
    if (state.strand_is_intact[model.half_strands[h].strand]) return true;
  }
  return HasElements(load) && CalcElementBound(*load.elements, state.position, node) > 0.0;
}

/// One solve with the springs as they are linearised now.
SolveReport SolveLinearised(EquilibriumSolver::Content& c, const SolverSettings& settings,
                            const TissueLoad& load, TissueState& state, ConstraintSet* constraints,
                            std::span<const Vec3> extrapolation) noexcept {
  const IterationSettings iteration{settings.max_iterations, settings.tolerance};
  if (settings.kind == SolverKind::kRelaxationPaper)
    return SolveRelaxationPaper(c.spring_linearisation.Nodewise().model, iteration, settings.relaxation, load,
                                state, constraints);
  if (settings.kind == SolverKind::kGaussSeidelBrown2001)
    return SolveGaussSeidelBrown2001(c.spring_linearisation.Nodewise().model, c.GaussSeidel(), iteration,
                                     load, state, constraints);
  const Workers::Session session(*c.workers);
  switch (settings.kind) {
    case SolverKind::kChebyshevJacobi2015:
      return c.SolveChebyshev(settings, load, state, constraints);
    case SolverKind::kAcceleratedDescent:
      // a stencil has no place for springs of their own, and the descent keeps elements' forces for a whole cycle; the
      // recurrence in double precision has and does not
      if ((c.grid.has_value() && !c.spring_linearisation.IsPlain()) || HasElements(load))
        return c.SolveChebyshev(settings, load, state, constraints);
      return c.SolveAccelerated(settings.max_iterations, settings.max_error, load, state, constraints);
    case SolverKind::kNewtonMultigrid:
      return c.SolveNewton(settings, load, state, constraints, extrapolation);
    default:
      return SolveAdaptive(c, settings, load, state, constraints, extrapolation);
  }
}

}  // namespace

// --- memory

EquilibriumSolver::Content::Content(const TissueModel& model, const SolverOptions& how,
                                    std::shared_ptr<const SolverModel> same_model)
    : laws(&model),
      options(how),
      shared(same_model != nullptr ? std::move(same_model)
                                   : std::make_shared<const SolverModel>(MakeSolverModel(model))),
      made(shared.get()),
      grid(how.recognises_grids ? FindGridShape(model) : std::nullopt),
      spring_linearisation(how.spare_share),
      unconstrained_condition(model.Size()),
      workers(std::make_unique<Workers>(how.threads)),
      kernels(&GetKernels(how.simd)) {
  TROCAR_ASSERT(made->ordered.Size() == model.Size() && made->ends.size() == model.SpringCount());
  if (options.spare_share > 0.0) builder.Reserve(*shared, options.spare_share, own);
  spring_linearisation.SetModel(model, *made);
}

void EquilibriumSolver::Content::UpdateTopology(const TissueModel& model) {
  TROCAR_ASSERT(model.Size() == laws->Size());
  laws = &model;
  builder.Build(model, own);
  made = &own;
  grid = options.recognises_grids ? FindGridShape(model) : std::nullopt;
  spring_linearisation.SetModel(model, *made);
  if (chebyshev_ != nullptr) chebyshev_->SetModel(model);
  if (accelerated_ != nullptr) accelerated_->SetModel(model, made->ordered, grid);
  if (newton_ != nullptr) newton_->SetModel(*made);
}

GaussSeidelScratch& EquilibriumSolver::Content::GaussSeidel() {
  if (gauss_seidel_ == nullptr) gauss_seidel_ = std::make_unique<GaussSeidelScratch>(laws->Size());
  return *gauss_seidel_;
}

ChebyshevScratch& EquilibriumSolver::Content::Chebyshev() {
  if (chebyshev_ == nullptr) chebyshev_ = std::make_unique<ChebyshevScratch>(*laws, options.spare_share);
  return *chebyshev_;
}

AcceleratedDescent& EquilibriumSolver::Content::Accelerated() {
  if (accelerated_ == nullptr) {
    accelerated_ = std::make_unique<AcceleratedDescent>(spring_linearisation.Ordered(), options.spare_share);
    accelerated_->SetModel(*laws, made->ordered, grid);
  }
  return *accelerated_;
}

NewtonMultigrid& EquilibriumSolver::Content::Newton() {
  if (newton_ == nullptr) {
    newton_ = std::make_unique<NewtonMultigrid>(*made, spring_linearisation.Ordered(), options.spare_share);
  }
  return *newton_;
}

void EquilibriumSolver::Content::Prepare(const SolverSettings& settings, std::size_t constraints) {
  const auto prepare_chebyshev = [&] { (void)Chebyshev(), (void)spring_linearisation.Nodewise(); };
  switch (settings.kind) {
    case SolverKind::kRelaxationPaper:
      (void)spring_linearisation.Nodewise();
      return;
    case SolverKind::kGaussSeidelBrown2001:
      (void)spring_linearisation.Nodewise(), (void)GaussSeidel();
      return;
    case SolverKind::kChebyshevJacobi2015:
      return prepare_chebyshev();
    case SolverKind::kAcceleratedDescent:
      (void)Accelerated();
      if (grid) prepare_chebyshev();
      return;
    case SolverKind::kAdaptive:
      if (constraints == 0) prepare_chebyshev();
      if (grid) (void)Accelerated();
      [[fallthrough]];
    case SolverKind::kNewtonMultigrid:
      Newton().Prepare(constraints, settings.newton.follows_snap_through);
  }
}

// --- methods, each with what it uses of the settings

SolveReport EquilibriumSolver::Content::SolveChebyshev(const SolverSettings& settings, const TissueLoad& load,
                                                       TissueState& state,
                                                       ConstraintSet* constraints) noexcept {
  return SolveChebyshevJacobiWang2015(spring_linearisation.Nodewise(), Chebyshev(), *workers,
                                      {settings.max_iterations, settings.tolerance}, load, state,
                                      constraints);
}

SolveReport EquilibriumSolver::Content::SolveAccelerated(int max_iterations, double max_error,
                                                         const TissueLoad& load, TissueState& state,
                                                         ConstraintSet* constraints) noexcept {
  return Accelerated().Solve(*kernels, *workers, {max_iterations, max_error}, load, state, constraints);
}

SolveReport EquilibriumSolver::Content::SolveNewton(const SolverSettings& settings, const TissueLoad& load,
                                                    TissueState& state, ConstraintSet* constraints,
                                                    std::span<const Vec3> extrapolation) noexcept {
  return Newton().Solve(*kernels, *workers, settings.max_error, settings.newton, load, state, constraints,
                        extrapolation);
}

// --- the solver

EquilibriumSolver::EquilibriumSolver(const TissueModel& model) : EquilibriumSolver(model, SolverOptions{}) {}

EquilibriumSolver::EquilibriumSolver(const TissueModel& model, const SolverOptions& options,
                                     std::shared_ptr<const SolverModel> same_model)
    : content_(std::make_unique<Content>(model, options, std::move(same_model))) {}

void EquilibriumSolver::UpdateTopology(const TissueModel& model) {
  content_->UpdateTopology(model);
}

void EquilibriumSolver::Prepare(const SolverSettings& settings, std::size_t constraints) {
  content_->Prepare(settings, constraints);
}

std::shared_ptr<const SolverModel> EquilibriumSolver::ShareModel() const noexcept {
  return content_->shared;
}

EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

bool EquilibriumSolver::IsStructured() const noexcept {
  return content_->grid.has_value();
}

SolveReport EquilibriumSolver::Solve(const SolverSettings& settings, const TissueLoad& load,
                                     TissueState& state, ConstraintSet* constraints,
                                     std::span<const Vec3> extrapolation) noexcept {
  TROCAR_ASSERT(state.position.size() == content_->laws->Size());
  TROCAR_ASSERT(load.contacts.size() <= kMaxContacts);
  Content& c = *content_;
  if (!IsFinite(load, state)) return {.is_finite = false};
  if (!c.spring_linearisation.UpdateFactors(state)) return {.is_finite = false};
  // a node without any spring has no equilibrium: it stays where it is
  const std::span<const std::uint32_t> unconstrained = c.spring_linearisation.Unconstrained();
  for (std::size_t i = 0; i < unconstrained.size(); ++i) {
    c.unconstrained_condition[i] = state.condition[unconstrained[i]];
    if (!HangsOnLink(*c.laws, load, state, unconstrained[i]))
      state.condition[unconstrained[i]] = NodeCondition::kPrescribed;
  }
  const SolveReport report =
      c.spring_linearisation.Iterate(settings, state, [&](const SolverSettings& rest) noexcept {
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
  if (HasElements(load)) {
    for (const auto node : nodes) force += CalcElementForceOn(*load.elements, state.position, node).sum;
  }
  return force;
}

double CalcLargestAlpha(const TissueModel& model, const TissueLoad& load, std::span<const Vec3> position) {
  double bound = 0;
  for (std::size_t i = 0; i < model.Size(); ++i) {
    double links = SumSpringStiffness(model, static_cast<std::uint32_t>(i));
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h)
      links += model.half_strands[h].stiffness;
    bound = std::max(bound, 2.0 * load.stiffness_scale * links + load.shape_scale * model.shape_stiffness[i]);
  }
  double contacts = 0;
  for (const ContactSpring& contact : load.contacts) contacts += contact.stiffness;
  bound += contacts;
  if (HasElements(load))
    bound += CalcLargestElementStiffness(*load.elements, position.empty() ? std::span(model.rest) : position);
  return bound > 0.0 ? 2.0 / bound : 0.0;
}

}  // namespace trocar::tissue
