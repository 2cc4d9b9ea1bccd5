// SPDX-License-Identifier: Apache-2.0
#include "newton_multigrid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "node_vectors.h"
#include "trocar/base/spare_capacity.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Part of the tolerated error that the linear solution may leave [-]. The tight one makes conjugate gradients go so far
/// that they meet a mode that turns soft; the loose one is for ticks that do not follow snap-through.
constexpr double kLinearShare = 0.1;
constexpr double kLooseLinearShare = 0.3;
/// Part of the error that the preconditioned residual shows [-]. Measured in the built-in patient: a thirtieth to a fifth.
/// Next to a snap-through it is less; conjugate gradients then meet the soft mode, and their smallest Ritz value bounds
/// the part from below. Under the least value the springs let go, and the linear model says nothing of where they go.
constexpr double kVisibleShare = 0.03;
constexpr double kLeastVisibleShare = 1e-3;
/// A linear solve ends when the preconditioned residual has fallen to this part of its start, or the error is small enough
/// [-]: the step leaves errors of second order anyway (forcing term of an inexact Newton method).
constexpr double kForcing = 0.03;
/// The coarse levels are computed again when a node may have moved so far, in mean spring lengths [-]: they depend on the
/// directions of the springs, which have hardly turned before.
constexpr double kStaleMove = 0.2;
/// A step in which a node moves farther than this, in mean spring lengths, is taken for a snap-through [-]: the soft mode
/// that earlier steps met is stiff afterwards, and its Ritz value is forgotten.
constexpr double kSnapMove = 0.02;
/// A tick that follows snap-through does not end after a step that left more than this part of the error before [-].
/// Newton's method falls short like that where the equilibrium has just ceased to exist, and takes large steps once it is
/// past. Errors below kSmallError of the tolerated one are rounding [-].
constexpr double kContraction = 0.3;
constexpr double kSmallError = 0.1;
/// After a step that raised the energy at all its lengths no other is tried once the trust region has come down to this,
/// in mean spring lengths [-]: what is left is rounding.
constexpr double kLeastRadius = 1e-5;
/// The whole's smallest Ritz value, over that of a local solve, whose nodes are few and held all around [-].
constexpr double kLocalRitzFactor = 2.0;
/// An extrapolation in which no node moves farther than this, in mean spring lengths, is not tried [-]: it saves nothing.
constexpr double kLeastExtrapolation = 3e-4;

double CalcVisibleShare(double smallest_ritz) noexcept {
  return std::clamp(smallest_ritz, kLeastVisibleShare, kVisibleShare);
}

/// Whether a constraint of the set keeps the volume of a surface, whose pressure adds to the stiffness.
bool HasSurfaces(const ConstraintSet& constraints) noexcept {
  for (std::size_t c = 0; c < constraints.Nodes().size(); ++c) {
    if (!constraints.Surface(c).empty()) return true;
  }
  return false;
}

}  // namespace

// --- memory

NewtonMultigrid::NewtonMultigrid(const SolverModel& made, const OrderedSprings& springs, double spare_share)
    : model_(&made.ordered),
      springs_(&springs),
      spare_share_(spare_share),
      hierarchy_(made.hierarchy, made.ordered.graph, spare_share),
      linearisation_(springs),
      pressure_(made.ordered),
      preconditioner_(made.ordered, hierarchy_) {
  const OrderedModel& model = *model_;
  const std::size_t n = model.Size(), padded = model.layout.PaddedNodes();
  linearisation_.Reserve(padded, base::AddSpare(model.strands.size(), spare_share));
  linearisation_.SetModel(model);
  load_.constant.resize(n);
  load_.is_free.resize(n);
  load_.contacts.reserve(kMaxContacts);
  load_.elements.Reserve();
  position_.resize(padded), start_.resize(padded);
  balance_.residual.resize(padded);
  balance_.is_pressing.resize(kMaxContacts);
  for (auto* vector : {&step_, &r_, &z_, &p_, &q_}) vector->resize(padded);
}

void NewtonMultigrid::SetModel(const SolverModel& made) {
  model_ = &made.ordered;
  hierarchy_.SetTopology(made.hierarchy, made.ordered.graph);
  linearisation_.SetModel(made.ordered);
  pressure_.SetModel(made.ordered);
  if (local_solve_ != nullptr) local_solve_->SetModel(made.ordered);
  preconditioner_.SetModel(made.ordered);
}

void NewtonMultigrid::Prepare(std::size_t constraints, bool follows_snap_through) {
  preconditioner_.Prepare(constraints);
  if (!follows_snap_through || local_solve_ != nullptr) return;
  const SliceLayout& layout = model_->layout;
  pressure_.Reserve(layout.PaddedNodes(), base::AddSpare(layout.Steps() * kSliceNodes, spare_share_));
  local_solve_ = std::make_unique<LocalSolve>(*model_, *springs_);
}

// --- positions and constraints

void NewtonMultigrid::ReadPositions(const TissueState& state, std::uint32_t first,
                                    std::uint32_t last) noexcept {
  for (std::uint32_t i = first; i < last; ++i) {
    const Vec3& p = state.position[model_->old_of_new[i]];
    position_[i] = {p.x, p.y, p.z, 0.0};
  }
}

void NewtonMultigrid::WriteBack(Workers& workers, TissueState& state) const noexcept {
  ForEachNodeChunk(workers, model_->Size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    for (std::uint32_t i = first; i < last; ++i) {
      if (load_.is_free[i])
        state.position[model_->old_of_new[i]] = {position_[i].x, position_[i].y, position_[i].z};
    }
  });
}

bool NewtonMultigrid::AreConstraintsInReach(Context& c) noexcept {
  if (c.constraints == nullptr || preconditioner_.Count() == 0) return true;
  WriteBack(c.workers, c.state);
  return c.constraints->AreInReach(c.state);
}

/// Hands the multipliers to the constraints, lets them correct positions and forces, and takes both over.
void NewtonMultigrid::ProjectConstraints(Context& c) noexcept {
  WriteBack(c.workers, c.state);
  for (std::size_t active = 0; active < preconditioner_.Count(); ++active)
    c.constraints->AddMultiplier(preconditioner_.IndexOf(active), -preconditioner_.Multipliers()[active]);
  c.constraints->Project(c.state, {});
  ForEachNodeChunk(c.workers, model_->Size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    ReadPositions(c.state, first, last);
    SetOrderedForce(*model_, c.load, first, last, load_);
    linearisation_.SetForce(first, last);
  });
}

void NewtonMultigrid::TakeSurfaces(const ConstraintSet& constraints) noexcept {
  std::array<PressedSurface, kMaxConstraints> surfaces;
  const std::size_t count = constraints.Nodes().size();
  for (std::size_t c = 0; c < count; ++c)
    surfaces[c] = {constraints.Nodes()[c].first_node, constraints.Surface(c)};
  pressure_.SetSurfaces(std::span(surfaces).first(count));
}

void NewtonMultigrid::UpdatePressure(Context& c) noexcept {
  std::array<double, kMaxConstraints> pressure{};
  const std::size_t count = c.constraints->Nodes().size();
  for (std::size_t at = 0; at < count; ++at) pressure[at] = c.constraints->Multiplier(at);
  pressure_.Update(c.kernels, c.workers, std::span(pressure).first(count), position_);
}

/// 1/2 step_ . K step_ of the follower stiffness [J].
double NewtonMultigrid::CalcFollowerEnergy(Context& c) noexcept {
  if (!has_follower_stiffness_ || pressure_.FollowerStiffness() == nullptr) return 0.0;
  RunPass(c.kernels, c.workers, hierarchy_.Finest(), LinkPass::kFollower, step_.data(), nullptr, 0.0f,
          q_.data(), pressure_.FollowerStiffness());
  return 0.5 * CalcDot(c.kernels, c.workers, step_, q_);
}

void NewtonMultigrid::Multiply(Context& c, const Float4* x, Float4* out) noexcept {
  RunPass(c.kernels, c.workers, hierarchy_.Finest(), LinkPass::kProduct, x, nullptr, 0.0f, out,
          has_follower_stiffness_ ? pressure_.FollowerStiffness() : nullptr);
  AddContactLinks(load_, balance_, x, out);
  linearisation_.CompleteProduct(hierarchy_.Finest(), x, out);
}

// --- phases of a solve

void NewtonMultigrid::Begin(Context& c) noexcept {
  SetOrderedLoad(*model_, c.load, c.state, load_);
  linearisation_.SetLoad(load_, c.state.strand_is_intact, hierarchy_.Finest());
  ReadPositions(c.state, 0, model_->Size());
  has_follower_stiffness_ = c.follows_snap_through && HasSurfaces(*c.constraints);
  if (has_follower_stiffness_) TakeSurfaces(*c.constraints);
  preconditioner_.Clear();
}

/// Begins at the extrapolated initial guess if the energy is lower there and the constraints are in reach.
void NewtonMultigrid::Predict(Context& c, std::span<const Vec3> extrapolation) noexcept {
  if (c.constraints == nullptr) return;
  const double least = kLeastExtrapolation * springs_->mean_length;
  double longest2 = 0;
  for (const Vec3& move : extrapolation) longest2 = math::Max(longest2, math::SquaredNorm(move));
  if (!(longest2 > least * least)) return;
  linearisation_.CalcBalance(c.kernels, c.workers, position_, balance_);
  const double before = balance_.energy;
  std::copy(position_.begin(), position_.end(), start_.begin());
  for (std::uint32_t i = 0; i < model_->Size(); ++i) {
    if (!load_.is_free[i]) continue;
    const Vec3& move = extrapolation[model_->old_of_new[i]];
    position_[i] = {start_[i].x + move.x, start_[i].y + move.y, start_[i].z + move.z, 0.0};
  }
  linearisation_.CalcBalance(c.kernels, c.workers, position_, balance_);
  bool is_better = balance_.is_finite && balance_.energy < before;
  if (is_better) {
    WriteBack(c.workers, c.state);
    is_better = c.constraints->AreInReach(c.state);
  }
  if (is_better) {
    ProjectConstraints(c);
  } else {
    std::copy(start_.begin(), start_.end(), position_.begin());
  }
}

/// Residual, energy and stiffness at position_.
void NewtonMultigrid::Linearise(Context& c) noexcept {
  linearisation_.Linearise(c.kernels, c.workers, position_, hierarchy_.Finest(), balance_);
  if (has_follower_stiffness_) UpdatePressure(c);
}

void NewtonMultigrid::UpdateCoarseLevels(Context& c) noexcept {
  hierarchy_.UpdateCoarse(c.kernels, c.workers);
  preconditioner_.Invalidate();
  c.moved = 0;
}

/// The distance to the equilibrium, from the preconditioned residual, which stays in z_ for the next step.
void NewtonMultigrid::Estimate(Context& c) noexcept {
  preconditioner_.SetActive(c.constraints);
  c.workers.Run(2 + static_cast<std::uint32_t>(preconditioner_.Count()), [&](std::uint32_t part) {
    if (part == 0) return hierarchy_.UpdateLineSmoother();
    if (part == 1) {
      std::copy(balance_.residual.begin(), balance_.residual.end(), r_.begin());
      return;
    }
    preconditioner_.TakeGradient(part - 2, *c.constraints, load_);
  });
  preconditioner_.PreconditionGradients(c.kernels, c.workers);
  c.visible_error = preconditioner_.Apply(c.kernels, c.workers, r_, z_).longest;
  c.displacement_scale = balance_.largest_distance;
  c.report.error = c.displacement_scale > 0.0
                       ? c.visible_error / (CalcVisibleShare(c.smallest_ritz) * c.displacement_scale)
                   : c.visible_error > 0.0 ? INFINITY
                                           : 0.0;
  c.report.converged = c.report.error <= c.max_error;
}

/// Solves K step_ = residual until the error left in the step is small enough or the trust region ends.
NewtonMultigrid::Step NewtonMultigrid::SolveStep(Context& c) noexcept {
  Step step;
  step.energy_before = balance_.energy;
  step.multipliers_before = preconditioner_.Multipliers();
  const double loose = kForcing * c.visible_error;
  const double tolerance =
      (c.follows_snap_through ? kLinearShare : kLooseLinearShare) * c.max_error * c.displacement_scale;
  step.linear = SolveTruncated(
      c.kernels, c.workers, std::min(c.settings.max_linear_iterations, CountLeft(c)), c.region.Radius(),
      {step_, r_, z_, p_, q_}, [&] { Multiply(c, p_.data(), q_.data()); },
      [&] { return preconditioner_.Apply(c.kernels, c.workers, r_, z_); },
      [&](double left, double ritz) {
        return left <= loose || left <= tolerance * CalcVisibleShare(math::Min(c.smallest_ritz, ritz));
      });
  // what the constraints carry is asked for
  if (step.linear.reached_radius) preconditioner_.ProjectResidual(c.kernels, c.workers, r_);
  c.smallest_ritz = math::Min(c.smallest_ritz, step.linear.smallest_ritz);
  c.report.linear_iterations += step.linear.iterations;
  c.report.negative_curvatures += step.linear.met_negative_curvature;
  step.length = FindLongest(c.kernels, c.workers, step_);
  if (!step.IsUsable()) return step;
  step.slope = -CalcDot(c.kernels, c.workers, balance_.residual, step_);
  step.follower_energy = CalcFollowerEnergy(c);
  return step;
}

/// Halves the step until the energy falls as it should (Armijo) and the constraints are in reach.
NewtonMultigrid::Advancement NewtonMultigrid::SearchLine(Context& c, const Step& step) noexcept {
  Advancement advancement;
  advancement.share = 1.0;
  std::copy(position_.begin(), position_.end(), start_.begin());
  for (int halvings = 0;; ++halvings, advancement.share *= 0.5) {
    TryShare(c, step, advancement);
    c.report.restarts += !advancement.is_lower;
    if (advancement.is_lower || halvings == TrustRegion::kMaxHalvings) return advancement;
  }
}

void NewtonMultigrid::TryShare(Context& c, const Step& step, Advancement& advancement) noexcept {
  const double share = advancement.share;
  ForEachNodeChunk(c.workers, model_->Size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    for (std::uint32_t i = first; i < last; ++i) position_[i] = Advance(start_[i], share, step_[i]);
  });
  // constraints will change the balance again: their stiffness is computed after that
  if (c.constraints == nullptr) {
    Linearise(c);
  } else {
    linearisation_.CalcBalance(c.kernels, c.workers, position_, balance_);
  }
  advancement.is_lower =
      balance_.is_finite &&
      TrustRegion::IsLower(step.energy_before, balance_.energy + share * share * step.follower_energy,
                           step.slope, share);
  if (!advancement.is_lower) return;
  for (std::size_t active = 0; active < preconditioner_.Count(); ++active) {
    advancement.multipliers[active] =
        share * preconditioner_.Multipliers()[active] + (1.0 - share) * step.multipliers_before[active];
  }
  advancement.local = SolveLocally(c, step, advancement);
  c.report.local_solves += advancement.local.steps > 0;
  advancement.is_lower = AreConstraintsInReach(c);
  if (advancement.is_lower || advancement.local.steps == 0) return;
  local_solve_->TakeBack(position_);
  advancement.local = {};
  advancement.is_lower = AreConstraintsInReach(c);
}

/// Brings the nodes that the step moved farthest to rest on their own, the constraints carrying what they do.
LocalSolve::Report NewtonMultigrid::SolveLocally(Context& c, const Step& step,
                                                 const Advancement& advancement) noexcept {
  if (!c.follows_snap_through) return {};
  if (!local_solve_->Gather(load_, c.state.strand_is_intact, step_, step.length)) return {};
  for (std::size_t active = 0; active < preconditioner_.Count(); ++active)
    local_solve_->AddForce(preconditioner_.Gradient(active), -advancement.multipliers[active]);
  return local_solve_->Solve(c.kernels, c.workers, c.max_error * c.displacement_scale, springs_->mean_length,
                             position_);
}

/// Keeps coarse levels and Ritz value in step with a move.
void NewtonMultigrid::FollowMove(Context& c, const Step& step, const Advancement& advancement) noexcept {
  c.moved += advancement.share * step.length + advancement.local.longest;
  if (c.moved > kStaleMove * springs_->mean_length || hierarchy_.HasNewElements()) UpdateCoarseLevels(c);
  if (advancement.share * step.length > kSnapMove * springs_->mean_length) c.smallest_ritz = INFINITY;
  c.smallest_ritz = math::Min(c.smallest_ritz, kLocalRitzFactor * advancement.local.smallest_ritz);
  // an equilibrium that negative curvature was met next to is a saddle, and not the end
  if (c.follows_snap_through && step.linear.met_negative_curvature) c.smallest_ritz = 0.0;
}

void NewtonMultigrid::EstimateAfter(Context& c, const Step& step) noexcept {
  const double before = c.visible_error;
  Estimate(c);
  if (!c.follows_snap_through) return;
  const bool falls_short =
      c.visible_error > kContraction * before && c.report.error > kSmallError * c.max_error;
  if (step.linear.met_negative_curvature || falls_short) c.report.converged = false;
}

int NewtonMultigrid::CountLeft(const Context& c) noexcept {
  return c.settings.max_linear_total - c.report.linear_iterations - c.report.restarts;
}

bool NewtonMultigrid::IsAtBound(const Context& c) noexcept {
  return c.report.iterations >= c.settings.max_steps || CountLeft(c) <= 0;
}

SolveReport NewtonMultigrid::Solve(const Kernels& kernels, Workers& workers, double max_error,
                                   const NewtonSettings& settings, const TissueLoad& load, TissueState& state,
                                   ConstraintSet* constraints, std::span<const Vec3> extrapolation) noexcept {
  if (constraints != nullptr) Prepare(constraints->Nodes().size(), settings.follows_snap_through);
  Context c{kernels,
            workers,
            max_error,
            settings,
            load,
            state,
            constraints,
            settings.follows_snap_through && constraints != nullptr,
            TrustRegion(springs_->mean_length),
            {}};
  Begin(c);
  Predict(c, extrapolation);
  Linearise(c);
  UpdateCoarseLevels(c);
  Estimate(c);
  while (!c.report.converged && !IsAtBound(c) && balance_.is_finite) {
    const Step step = SolveStep(c);
    if (!step.IsUsable()) break;
    const Advancement advancement = SearchLine(c, step);
    ++c.report.iterations;
    c.region.Update(advancement.share, step.length, step.linear.reached_radius);
    if (!advancement.is_lower) {
      std::copy(start_.begin(), start_.end(), position_.begin());
      Linearise(c);
      Estimate(c);
      // a contact that does not press yet, or springs that stiffen as they turn, do not show in the stiffness: shorter
      // steps find them, where there is time for such
      const bool has_time = CountLeft(c) >= settings.max_linear_iterations;
      if (has_time && c.region.Radius() > kLeastRadius * springs_->mean_length) continue;
      break;
    }
    preconditioner_.Multipliers() = advancement.multipliers;
    if (constraints != nullptr) ProjectConstraints(c);
    if (IsAtBound(c)) {
      // no step follows that would need stiffness and estimate, which are as dear as two iterations
      if (constraints != nullptr) linearisation_.CalcBalance(kernels, workers, position_, balance_);
      c.report.error = NAN;
      break;
    }
    if (constraints != nullptr) Linearise(c);
    FollowMove(c, step, advancement);
    EstimateAfter(c, step);
  }
  c.report.residual = balance_.force_scale > 0.0 ? balance_.largest_residual / balance_.force_scale : 0.0;
  c.report.force_scale = balance_.force_scale;
  WriteBack(workers, state);
  return c.report;
}

}  // namespace trocar::tissue
