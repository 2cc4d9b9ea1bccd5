// SPDX-License-Identifier: Apache-2.0
#include "newton_multigrid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "newton_range.h"
#include "node_vectors.h"

namespace trocar::tissue {
namespace {

/// The part of the tolerated error that the linear solution may leave [-]: conjugate gradients that go so far have met a
/// mode that turns soft. The loose one is for ticks that do not follow folds.
constexpr double kLinearShare = 0.1;
constexpr double kLooseLinearShare = 0.3;
/// The part of the error that the preconditioned residual shows [-]: in the built-in patient a thirtieth to a
/// fifth, and less next to a fold, where conjugate gradients meet the mode that turns soft: their smallest Ritz
/// value then bounds it. Below the least one the springs let go: what they would do is not near.
constexpr double kSeenShare = 0.03;
constexpr double kLeastSeenShare = 1e-3;
/// A step is solved until the preconditioned residual is this part of what it was, or the error small enough
/// [-]: what is of second order is left over anyway.
constexpr double kForcing = 0.03;
/// Coarser levels are computed again when a node may have gone so far, in mean spring lengths [-]: they follow
/// the springs' directions, which have hardly turned before.
constexpr double kStaleMove = 0.2;
/// A soft mode that an earlier step met is forgotten when a node goes so far in one step, in mean spring lengths [-]:
/// a fold has snapped, and is stiff now.
constexpr double kSnapMove = 0.02;
/// A tick that follows folds does not end after a step that left more than this part of the error that it saw [-]: Newton's
/// method falls short like that where rest has just ceased to exist, and takes large steps again once it is past. Errors
/// below kSmallError of the tolerated one are rounding.
constexpr double kContraction = 0.3;
constexpr double kSmallError = 0.1;
/// A step that led uphill at all its lengths is tried no more where the range has come down to this, in mean spring
/// lengths [-]: what is left is rounding.
constexpr double kLeastRadius = 1e-5;
/// What the smallest Ritz value of a patch, whose nodes are few and held all around, says of the whole's [-].
constexpr double kPatchRitz = 2.0;
/// A lead in which no node goes farther than this is not tried, in mean spring lengths [-]: it saves nothing.
constexpr double kLeastLead = 3e-4;

double CalcSeenShare(double smallest_ritz) noexcept {
  return std::clamp(smallest_ritz, kLeastSeenShare, kSeenShare);
}

}  // namespace

NewtonMultigrid::NewtonMultigrid(const TissueModel& model)
    : model_(MakeOrderedModel(model)),
      hierarchy_(model_.graph, model_.graph_stiffness),
      linearisation_(model_),
      pressure_(model_),
      patch_(model_) {
  const std::size_t n = model_.Size(), padded = model_.layout.PaddedNodes();
  load_.constant.resize(n);
  load_.is_free.resize(n);
  load_.contacts.reserve(kMaxContacts);
  position_.resize(padded), start_.resize(padded);
  balance_.residual.resize(padded);
  balance_.is_pressing.resize(kMaxContacts);
  for (auto* vector : {&step_, &r_, &z_, &p_, &q_}) vector->resize(padded);
  for (Constraint& c : constraints_room_) c.gradient.resize(padded), c.answer.resize(padded);
  SetEdgeLength();
}

void NewtonMultigrid::SetModel(const TissueModel& model) {
  SetOrderedModel(model, model_);
  hierarchy_.SetGraph(model_.graph, model_.graph_stiffness);
  linearisation_.SetModel();
  pressure_.SetModel();
  has_answers_ = false;
  SetEdgeLength();
}

void NewtonMultigrid::Reserve(double share) {
  model_.Reserve(share);
  hierarchy_.Reserve(share);
  linearisation_.Reserve(share);
  pressure_.Reserve(share);
}

void NewtonMultigrid::SetEdgeLength() noexcept {
  double sum = 0;
  std::size_t count = 0;
  for (const double rest : model_.rest_length) sum += rest, count += rest > 0.0;
  edge_length_ = count > 0 ? sum / static_cast<double>(count) : 0.0;
}

void NewtonMultigrid::Multiply(const Kernels& kernels, Workers& workers, const Float4* x,
                               Float4* out) noexcept {
  RunPass(kernels, workers, hierarchy_.Finest(), LinkPass::kProduct, x, nullptr, 0.0f, out,
          has_turns_ ? pressure_.Turns() : nullptr);
  AddContactLinks(load_, balance_, x, out);
}

void NewtonMultigrid::TakeSurfaces(const SolveHook& hook) noexcept {
  std::array<PressedSurface, kMaxHookConstraints> surfaces;
  for (std::size_t c = 0; c < hook.constraints.size(); ++c)
    surfaces[c] = {hook.constraints[c].first_node, hook.surface(hook.self, c)};
  pressure_.SetSurfaces(std::span(surfaces).first(hook.constraints.size()));
}

void NewtonMultigrid::UpdatePressure(const Kernels& kernels, Workers& workers,
                                     const SolveHook& hook) noexcept {
  std::array<double, kMaxHookConstraints> pressure{};
  for (std::size_t c = 0; c < hook.constraints.size(); ++c) pressure[c] = hook.multiplier(hook.self, c);
  pressure_.Update(kernels, workers, std::span(pressure).first(hook.constraints.size()), position_);
}

double NewtonMultigrid::CalcTurning(const Kernels& kernels, Workers& workers) noexcept {
  if (!has_turns_ || pressure_.Turns() == nullptr) return 0.0;
  RunPass(kernels, workers, hierarchy_.Finest(), LinkPass::kTurn, step_.data(), nullptr, 0.0f, q_.data(),
          pressure_.Turns());
  return 0.5 * CalcDot(kernels, workers, step_, q_);
}

void NewtonMultigrid::BeginStep(Workers& workers, const SolveHook* hook) noexcept {
  const std::size_t count_before = constraints_.size();
  std::size_t count = 0;
  if (hook != nullptr) {
    for (std::size_t index = 0; index < hook->constraints.size(); ++index) {
      if (!hook->is_active(hook->self, index)) continue;
      Constraint& c = constraints_room_[count++];
      has_answers_ = has_answers_ && c.index == index;
      c.index = index;
    }
  }
  constraints_ = std::span(constraints_room_).first(count);
  has_answers_ = has_answers_ && count == count_before;
  multipliers_.fill(0.0);
  workers.Run(2 + static_cast<std::uint32_t>(count), [&](std::uint32_t part) {
    if (part == 0) return hierarchy_.UpdateChains(linearisation_.Slack());
    if (part == 1) {
      std::copy(balance_.residual.begin(), balance_.residual.end(), r_.begin());
      return;
    }
    Constraint& c = constraints_[part - 2];
    std::fill(c.gradient.begin(), c.gradient.end(), Float4{});
    const SolveHook::Constraint& nodes = hook->constraints[c.index];
    for (std::uint32_t k = 0; k < nodes.node_count; ++k) {
      const std::uint32_t i = model_.new_of_old[nodes.first_node + k];
      if (load_.is_free[i]) c.gradient[i] = ToFloat(hook->gradient[nodes.first_node + k]);
    }
  });
}

void NewtonMultigrid::SetAnswers(const Kernels& kernels, Workers& workers) noexcept {
  if (!has_answers_) {
    for (Constraint& c : constraints_) hierarchy_.Apply(kernels, workers, c.gradient.data(), c.answer.data());
    has_answers_ = true;
  }
  for (std::size_t row = 0; row < constraints_.size(); ++row)
    gram_[row] = CalcDots(kernels, workers, &Constraint::answer, constraints_[row].gradient);
}

NewtonMultigrid::SmallVector NewtonMultigrid::CalcDots(const Kernels& kernels, Workers& workers,
                                                       AlignedVector<Float4> Constraint::*part,
                                                       const AlignedVector<Float4>& v) const noexcept {
  std::array<SmallVector, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, v.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        for (std::size_t c = 0; c < constraints_.size(); ++c)
          parts[chunk][c] = kernels.vectors.dot((constraints_[c].*part).data(), v.data(), first, last);
      });
  SmallVector sums{};
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    for (std::size_t c = 0; c < constraints_.size(); ++c) sums[c] += parts[chunk][c];
  }
  return sums;
}

void NewtonMultigrid::Subtract(const Kernels& kernels, const SmallVector& shares,
                               AlignedVector<Float4> Constraint::*part, AlignedVector<Float4>& from,
                               std::uint32_t first, std::uint32_t last) const noexcept {
  for (std::size_t c = 0; c < constraints_.size(); ++c) {
    kernels.vectors.add_scaled(static_cast<float>(-shares[c]), (constraints_[c].*part).data(), from.data(),
                               first, last);
  }
}

void NewtonMultigrid::ProjectResidual(const Kernels& kernels, Workers& workers) noexcept {
  if (constraints_.empty()) return;
  SmallMatrix transposed = gram_;
  for (std::size_t row = 0; row < constraints_.size(); ++row) {
    for (std::size_t column = 0; column < constraints_.size(); ++column)
      transposed[row][column] = gram_[column][row];
  }
  SmallVector share{};
  math::SolveSmall<math::Pivots::kNone>(transposed, CalcDots(kernels, workers, &Constraint::answer, r_),
                                        constraints_.size(), share);
  ForEachNodeChunk(workers, r_.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    Subtract(kernels, share, &Constraint::gradient, r_, first, last);
  });
  for (std::size_t c = 0; c < constraints_.size(); ++c) multipliers_[c] += share[c];
}

DotAndLongest NewtonMultigrid::Precondition(const Kernels& kernels, Workers& workers) noexcept {
  ProjectResidual(kernels, workers);
  hierarchy_.Apply(kernels, workers, r_.data(), z_.data());
  if (constraints_.empty()) return CalcDotAndLongest(kernels, workers, r_, z_);
  SmallVector share{};
  math::SolveSmall<math::Pivots::kNone>(gram_, CalcDots(kernels, workers, &Constraint::gradient, z_),
                                        constraints_.size(), share);
  return CalcDotAndLongest(kernels, workers, r_, z_, [&](std::uint32_t first, std::uint32_t last) {
    Subtract(kernels, share, &Constraint::answer, z_, first, last);
  });
}

TruncatedReport NewtonMultigrid::SolveLinear(const Kernels& kernels, Workers& workers, int max_iterations,
                                             double loose, double tolerance, double softest,
                                             double radius) noexcept {
  const TruncatedReport report = SolveTruncated(
      kernels, workers, max_iterations, radius, {step_, r_, z_, p_, q_},
      [&] { Multiply(kernels, workers, p_.data(), q_.data()); },
      [&] { return Precondition(kernels, workers); },
      [&](double left, double ritz) {
        return left <= loose || left <= tolerance * CalcSeenShare(std::fmin(softest, ritz));
      });
  if (report.reached_radius) ProjectResidual(kernels, workers);  // what the constraints carry is asked for
  return report;
}

NewtonPatch::Report NewtonMultigrid::SolvePatch(const Kernels& kernels, Workers& workers,
                                                std::span<const std::uint8_t> strand_is_intact,
                                                double longest, double tolerance,
                                                const SmallVector& multipliers) noexcept {
  if (!patch_.Gather(load_, strand_is_intact, step_, longest)) return {};
  for (std::size_t c = 0; c < constraints_.size(); ++c)
    patch_.AddForce(constraints_[c].gradient, -multipliers[c]);
  return patch_.Solve(kernels, workers, tolerance, edge_length_, position_);
}

void NewtonMultigrid::ReadPositions(const TissueState& state, std::uint32_t first,
                                    std::uint32_t last) noexcept {
  for (std::uint32_t i = first; i < last; ++i) {
    const Vec3& p = state.position[model_.old_of_new[i]];
    position_[i] = {p.x, p.y, p.z, 0.0};
  }
}

void NewtonMultigrid::WriteBack(Workers& workers, TissueState& state) const noexcept {
  ForEachNodeChunk(workers, model_.Size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    for (std::uint32_t i = first; i < last; ++i) {
      if (load_.is_free[i])
        state.position[model_.old_of_new[i]] = {position_[i].x, position_[i].y, position_[i].z};
    }
  });
}

bool NewtonMultigrid::TakeLead(const Kernels& kernels, Workers& workers, const SolveHook& hook,
                               TissueState& state) noexcept {
  const double least = kLeastLead * edge_length_;
  double longest2 = 0;
  for (const Vec3& move : hook.lead) longest2 = std::fmax(longest2, math::SquaredNorm(move));
  if (!(longest2 > least * least)) return false;
  linearisation_.CalcBalance(kernels, workers, position_, balance_);
  const double before = balance_.energy;
  std::copy(position_.begin(), position_.end(), start_.begin());
  for (std::uint32_t i = 0; i < model_.Size(); ++i) {
    if (!load_.is_free[i]) continue;
    const Vec3& move = hook.lead[model_.old_of_new[i]];
    position_[i] = {start_[i].x + move.x, start_[i].y + move.y, start_[i].z + move.z, 0.0};
  }
  linearisation_.CalcBalance(kernels, workers, position_, balance_);
  bool is_better = balance_.is_finite && balance_.energy < before;
  if (is_better && hook.is_in_reach != nullptr) {
    WriteBack(workers, state);
    is_better = hook.is_in_reach(hook.self, state);
  }
  if (!is_better) std::copy(start_.begin(), start_.end(), position_.begin());
  return is_better;
}

SolveReport NewtonMultigrid::Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                                   const TissueLoad& load, TissueState& state,
                                   const SolveHook* hook) noexcept {
  const std::uint32_t n = model_.Size();
  SetOrderedLoad(model_, load, state, load_);
  linearisation_.SetLoad(load_, state.strand_is_intact, hierarchy_.Finest());
  ReadPositions(state, 0, n);

  SolveReport report;
  const bool follows_folds = settings.follows_folds && hook != nullptr;
  has_turns_ = follows_folds && hook->surface != nullptr;
  if (has_turns_) TakeSurfaces(*hook);
  const auto linearise = [&] {
    linearisation_.Linearise(kernels, workers, position_, hierarchy_.Finest(), balance_);
    if (has_turns_) UpdatePressure(kernels, workers, *hook);
  };
  const auto call_hook = [&] {
    if (hook == nullptr) return;
    WriteBack(workers, state);
    for (std::size_t c = 0; c < constraints_.size(); ++c)
      hook->add_multiplier(hook->self, constraints_[c].index, -multipliers_[c]);
    hook->act(hook->self, state, {});
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      ReadPositions(state, first, last);
      SetOrderedForce(model_, load, first, last, load_);
      linearisation_.SetForce(first, last);
    });
  };
  const double linear_share = follows_folds ? kLinearShare : kLooseLinearShare;
  double scale = 0;                 // largest distance from rest [m]
  double preconditioned = 0;        // longest of z_ [m]
  double smallest_ritz = INFINITY;  // of all steps
  // estimate of the distance to the equilibrium; leaves the preconditioned residual in z_
  const auto estimate = [&] {
    BeginStep(workers, hook);
    SetAnswers(kernels, workers);
    preconditioned = Precondition(kernels, workers).longest;
    scale = balance_.largest_distance;
    report.error = scale > 0.0            ? preconditioned / (CalcSeenShare(smallest_ritz) * scale)
                   : preconditioned > 0.0 ? INFINITY
                                          : 0.0;
    report.converged = report.error <= settings.max_error;
  };
  const auto report_residual = [&] {
    report.residual = balance_.force_scale > 0.0 ? balance_.largest_residual / balance_.force_scale : 0.0;
    report.force_scale = balance_.force_scale;
  };

  double moved = 0;  // bound of how far any node went since the coarser levels were computed [m]
  const auto update_coarse = [&] {
    hierarchy_.UpdateCoarse(kernels, workers, linearisation_.Slack());
    has_answers_ = false;
    moved = 0;
  };
  constraints_ = {};  // those of the last solve
  if (hook != nullptr && TakeLead(kernels, workers, *hook, state)) call_hook();
  NewtonRange range(edge_length_);
  linearise();
  update_coarse();
  estimate();
  // to halve a step costs as much as an iteration
  const auto count_left = [&] {
    return settings.max_linear_total - report.linear_iterations - report.restarts;
  };
  const auto is_at_bound = [&] {
    return report.iterations >= settings.max_newton_steps || count_left() <= 0;
  };
  while (!report.converged && !is_at_bound() && balance_.is_finite) {
    const double before = balance_.energy;
    const auto first_multipliers = multipliers_;
    const TruncatedReport linear = SolveLinear(
        kernels, workers, std::min(settings.max_linear_iterations, count_left()), kForcing * preconditioned,
        linear_share * settings.max_error * scale, smallest_ritz, range.Radius());
    smallest_ritz = std::fmin(smallest_ritz, linear.smallest_ritz);
    report.linear_iterations += linear.iterations;
    report.negative_curvatures += linear.met_negative_curvature;
    const double length = FindLongest(kernels, workers, step_);
    if (!(length > 0.0 && length < INFINITY)) break;
    const double slope = -CalcDot(kernels, workers, balance_.residual, step_);
    const double turning = CalcTurning(kernels, workers);
    double share = 1.0;
    std::copy(position_.begin(), position_.end(), start_.begin());
    bool is_lower = false;
    SmallVector carried{};  // of the residual, by the constraints, after the part of the step that is taken
    NewtonPatch::Report patch;
    const auto keeps_reach = [&] {
      if (constraints_.empty() || hook->is_in_reach == nullptr) return true;
      WriteBack(workers, state);
      return hook->is_in_reach(hook->self, state);
    };
    for (int halving = 0; halving <= NewtonRange::kMaxHalvings && !is_lower; ++halving, share *= 0.5) {
      ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
        for (std::uint32_t i = first; i < last; ++i) position_[i] = Advance(start_[i], share, step_[i]);
      });
      // a hook will change the balance again
      if (hook == nullptr) {
        linearise();
      } else {
        linearisation_.CalcBalance(kernels, workers, position_, balance_);
      }
      is_lower = balance_.is_finite &&
                 NewtonRange::IsLower(before, balance_.energy + share * share * turning, slope, share);
      if (is_lower) {
        for (std::size_t c = 0; c < constraints_.size(); ++c)
          carried[c] = share * multipliers_[c] + (1.0 - share) * first_multipliers[c];
        // without a hook the stiffness has been computed where the step ends
        patch = follows_folds ? SolvePatch(kernels, workers, state.strand_is_intact, length,
                                           settings.max_error * scale, carried)
                              : NewtonPatch::Report{};
        report.patches += patch.steps > 0;
        is_lower = keeps_reach();
        if (!is_lower && patch.steps > 0) {
          patch_.TakeBack(position_);
          patch = {};
          is_lower = keeps_reach();
        }
      }
      report.restarts += !is_lower;
    }
    ++report.iterations;
    share *= 2.0;  // the one that was tried last
    range.Follow(share, length, linear.reached_radius);
    if (!is_lower) {
      std::copy(start_.begin(), start_.end(), position_.begin());
      linearise();
      estimate();
      // a contact that does not press yet, or springs that stiffen as they turn, do not show in the stiffness: shorter
      // steps find them, where there is time for such
      const bool has_time = count_left() >= settings.max_linear_iterations;
      if (has_time && range.Radius() > kLeastRadius * edge_length_) continue;
      break;
    }
    multipliers_ = carried;
    // a constraint is kept after every step, whatever the hook's interval: a step here is worth many
    // iterations
    if (hook != nullptr) call_hook();
    if (is_at_bound()) {
      // nobody goes on from here: the stiffness and the estimate are as dear as two iterations
      if (hook != nullptr) linearisation_.CalcBalance(kernels, workers, position_, balance_);
      report.error = NAN;
      break;
    }
    if (hook != nullptr) linearise();
    moved += share * length + patch.longest;
    if (moved > kStaleMove * edge_length_) update_coarse();
    if (share * length > kSnapMove * edge_length_) smallest_ritz = INFINITY;
    smallest_ritz = std::fmin(smallest_ritz, kPatchRitz * patch.smallest_ritz);
    const double seen_before = preconditioned;
    // rest that negative curvature was met next to is a saddle, and not the end
    if (follows_folds && linear.met_negative_curvature) smallest_ritz = 0.0;
    estimate();
    if (follows_folds && (linear.met_negative_curvature || (preconditioned > kContraction * seen_before &&
                                                            report.error > kSmallError * settings.max_error)))
      report.converged = false;
  }
  report_residual();
  WriteBack(workers, state);
  return report;
}

}  // namespace trocar::tissue
