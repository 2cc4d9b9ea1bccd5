// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "band_matrix.h"
#include "rod_elements.h"
#include "trocar/base/assert.h"
#include "trocar/rod/rod.h"

namespace trocar::rod {

using math::Vec3;

namespace {

/// Where the stiffness is not positive definite, so much of its largest diagonal entry is added to the diagonal at first [-], then
/// kMoreShift times more until it is.
constexpr double kFirstShift = 1e-11;
constexpr double kMoreShift = 10.0;
constexpr int kMaxShifts = 13;
/// A step is taken where the potential falls by this part of what its slope promises [-] (Armijo); else it is halved.
constexpr double kArmijo = 1e-4;
constexpr int kMaxHalvings = 12;
/// What is lost of a coordinate as it is rounded [-]; a segment answers with a force that nothing can balance.
constexpr double kPositionRounding = 1e-15;
/// Corrections of the lengths a step: each leaves the square of what was wrong.
constexpr int kLengthPasses = 3;
/// Of a chain that is held at both ends and straight no segment can give way [-].
constexpr double kLeastFreedom = 1e-3;
/// Differences of the potential below this part of its terms are rounding [-].
constexpr double kRounding = 1e-13;

std::size_t PositionAt(std::size_t node) {
  return kNodeUnknowns * node;
}
std::size_t AngleAt(std::size_t segment) {
  return kNodeUnknowns * segment + 3;
}

}  // namespace

RodSolver::RodSolver(const RodModel& model) : model_(&model) {
  const std::size_t n = model.NodeCount(), segments = model.SegmentCount(), unknowns = kNodeUnknowns * n;
  shortest_ = *std::min_element(model.length.begin(), model.length.end());
  for (const double length : model.length) mean_length_ += length / static_cast<double>(segments);
  for (Shape* shape : {&here_, &trial_}) {
    shape->position.resize(n), shape->reference_twist.resize(n);
    shape->direction.resize(segments), shape->reference.resize(segments), shape->angle.resize(segments);
  }
  start_.resize(n);
  for (auto* list : {&tension_, &elongation_, &foreseen_, &diagonal_, &beside_, &pull_}) list->resize(segments);
  gradient_.resize(unknowns), step_.resize(unknowns), is_fixed_.resize(unknowns);
  band_.resize(unknowns * kBandWidth), factor_.resize(unknowns * kBandWidth);
}

void RodSolver::Take(const RodState& state) noexcept {
  here_.position = state.position, here_.direction = state.direction, here_.reference = state.reference;
  here_.angle = state.angle, here_.reference_twist = state.reference_twist;
  start_ = state.position;
  for (std::size_t i = 0; i < model_->NodeCount(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) is_fixed_[PositionAt(i) + axis] = state.is_held[i];
    const bool has_angle = i < model_->SegmentCount() && model_->material.twisting > 0.0;
    is_fixed_[AngleAt(i)] = !has_angle || state.is_angle_held[i];
  }
  // what holds nodes may have moved them since
  FollowFrames(here_, here_);
}

/// Reference frames at the positions of `to`: each is carried from its segment's old direction to the new one, so that it does
/// not turn about it; the twist between two of them follows without a jump.
void RodSolver::FollowFrames(const Shape& from, Shape& to) const noexcept {
  for (std::size_t s = 0; s < model_->SegmentCount(); ++s) {
    const Vec3 direction = math::Normalized(to.position[s + 1] - to.position[s], from.direction[s]);
    to.reference[s] = Transport(from.reference[s], from.direction[s], direction);
    to.direction[s] = direction;
    if (s == 0) continue;
    const Vec3 carried = Transport(to.reference[s - 1], to.direction[s - 1], direction);
    const double before = from.reference_twist[s];
    to.reference_twist[s] =
        before + CalcSignedAngle(Turn(carried, direction, before), to.reference[s], direction);
  }
}

void RodSolver::AddSegment(const Shape& at, std::size_t segment, bool has_stiffness, Sums& sums) noexcept {
  const Vec3 along = at.position[segment + 1] - at.position[segment];
  const double length = math::Norm(along), rest = model_->length[segment], elongation = length - rest;
  const double stiffness = model_->material.stretching / rest;
  const double tension = stiffness * elongation;
  tension_[segment] = tension;
  sums.potential += 0.5 * tension * elongation;
  sums.length_error = math::Max(sums.length_error, std::fabs(elongation) / rest);
  sums.force_scale = math::Max(sums.force_scale, std::fabs(tension));
  if (!(length > 0.0)) return;
  const Vec3 u = along / length;
  const std::size_t a = PositionAt(segment), b = PositionAt(segment + 1);
  const double across = tension / length;
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    gradient_[a + row] -= tension * u[i], gradient_[b + row] += tension * u[i];
    if (!has_stiffness) continue;
    for (int j = 0; j < 3; ++j) {
      const auto column = static_cast<std::size_t>(j);
      const double entry = (stiffness - across) * u[i] * u[j] + (i == j ? across : 0.0);
      band_[BandAt(b + row, a + column)] -= entry;
      if (j > i) continue;
      band_[BandAt(a + row, a + column)] += entry;
      band_[BandAt(b + row, b + column)] += entry;
    }
  }
}

void RodSolver::AddBend(const Shape& at, std::size_t node, bool has_stiffness, Sums& sums) noexcept {
  const double reach = model_->reach[node];
  ElementDerivatives joint;
  AddJoint({at.position[node] - at.position[node - 1], at.position[node + 1] - at.position[node],
            model_->material.bending / reach, model_->material.twisting / reach,
            at.angle[node] - at.angle[node - 1] + at.reference_twist[node]},
           has_stiffness, joint);
  sums.elastic += joint.energy, sums.potential += joint.energy;
  const std::size_t first = PositionAt(node - 1);
  for (std::size_t i = 0; i < kElementUnknowns; ++i) {
    gradient_[first + i] += joint.gradient[i];
    const double of_force = i % kNodeUnknowns == 3 ? 1.0 / mean_length_ : 1.0;
    sums.force_scale = math::Max(sums.force_scale, of_force * std::fabs(joint.gradient[i]));
    if (!has_stiffness) continue;
    for (std::size_t j = 0; j <= i; ++j) band_[BandAt(first + i, first + j)] += joint.stiffness[i][j];
  }
}

void RodSolver::AddLoad(const RodLoad& load, const Shape& at, std::size_t node, bool has_stiffness,
                        Sums& sums) noexcept {
  Vec3 force = model_->material.mass_per_length * model_->reach[node] * load.gravity;
  if (!load.force.empty()) force += load.force[node];
  const Vec3 moved = at.position[node] - start_[node];
  sums.potential += 0.5 * load.drag * math::SquaredNorm(moved) - math::Dot(force, moved);
  sums.force_scale = math::Max(sums.force_scale, math::Norm(force));
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t row = PositionAt(node) + static_cast<std::size_t>(axis);
    gradient_[row] += load.drag * moved[axis] - force[axis];
    if (has_stiffness) band_[BandAt(row, row)] += load.drag;
  }
}

/// Adds the gradient of a potential at a contact's point.
void RodSolver::AddPointForce(const RodContact& contact, const Vec3& force) noexcept {
  const std::size_t a = PositionAt(contact.segment), b = PositionAt(contact.segment + 1);
  for (int axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<std::size_t>(axis);
    gradient_[a + row] += (1.0 - contact.at) * force[axis];
    gradient_[b + row] += contact.at * force[axis];
  }
}

/// Adds `along` in the normal's direction and `across` square to it [N/m], but nothing in the direction in which it `slips`: a unit
/// vector, or zero.
void RodSolver::AddPointStiffness(const RodContact& contact, double along, double across,
                                  const Vec3& slips) noexcept {
  const std::size_t a = PositionAt(contact.segment), b = PositionAt(contact.segment + 1);
  const double of_a = 1.0 - contact.at, of_b = contact.at;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
      const double entry =
          (along - across) * contact.normal[i] * contact.normal[j] +
          across * ((i == j ? 1.0 : 0.0) - slips[i] * slips[j]);
      band_[BandAt(b + row, a + column)] += of_a * of_b * entry;
      if (j > i) continue;
      band_[BandAt(a + row, a + column)] += of_a * of_a * entry;
      band_[BandAt(b + row, b + column)] += of_b * of_b * entry;
    }
  }
}

void RodSolver::AddContact(const RodContactSettings& settings, const RodContact& contact, const Shape& at,
                           bool has_stiffness, Sums& sums) noexcept {
  const Vec3 point = math::Lerp(at.position[contact.segment], at.position[contact.segment + 1], contact.at);
  const double depth = contact.offset - math::Dot(contact.normal, point);
  if (!(depth > 0.0)) return;
  const double pressure = settings.normal * depth;
  sums.potential += 0.5 * pressure * depth;
  sums.force_scale = math::Max(sums.force_scale, pressure);
  AddPointForce(contact, -pressure * contact.normal);
  // what sticks pulls with its stiffness up to the limit, and with the limit beyond: Huber's function
  const double limit = contact.friction * contact.pressure;
  Vec3 drawn = point - contact.anchor;
  drawn -= math::Dot(drawn, contact.normal) * contact.normal;
  const double length = math::Norm(drawn);
  const bool slips = settings.across * length > limit;
  const double across = slips ? (length > 0.0 ? limit / length : 0.0) : settings.across;
  sums.potential += slips ? limit * (length - 0.5 * limit / settings.across) : 0.5 * across * length * length;
  AddPointForce(contact, across * drawn);
  if (has_stiffness) {
    AddPointStiffness(contact, settings.normal, across, slips && length > 0.0 ? drawn / length : Vec3{});
  }
}

/// How far a contact's point is inside, at here_ [m].
double RodSolver::CalcDepth(const RodContact& contact) const noexcept {
  return contact.offset - math::Dot(contact.normal, math::Lerp(here_.position[contact.segment],
                                                               here_.position[contact.segment + 1], contact.at));
}

/// Takes over what presses, which is the friction's limit in the next step.
void RodSolver::UpdatePressures(const RodLoad& load) const noexcept {
  for (RodContact& contact : load.contacts)
    contact.pressure = math::Max(0.0, load.contact.normal * CalcDepth(contact));
}

/// What has slipped sticks where it has come to.
void RodSolver::LetSlip(const RodLoad& load) const noexcept {
  for (RodContact& contact : load.contacts) {
    const Vec3 point =
        math::Lerp(here_.position[contact.segment], here_.position[contact.segment + 1], contact.at);
    Vec3 drawn = point - contact.anchor;
    drawn -= math::Dot(drawn, contact.normal) * contact.normal;
    const double length = math::Norm(drawn), most = contact.friction * contact.pressure / load.contact.across;
    contact.anchor = point - (length > most ? most / length : 1.0) * drawn;
  }
}

RodSolver::Sums RodSolver::Assemble(const RodLoad& load, const Shape& at, bool has_stiffness) noexcept {
  Sums sums;
  std::fill(gradient_.begin(), gradient_.end(), 0.0);
  if (has_stiffness) std::fill(band_.begin(), band_.end(), 0.0);
  for (std::size_t s = 0; s < model_->SegmentCount(); ++s) AddSegment(at, s, has_stiffness, sums);
  for (std::size_t i = 1; i + 1 < model_->NodeCount(); ++i) AddBend(at, i, has_stiffness, sums);
  for (std::size_t i = 0; i < model_->NodeCount(); ++i) AddLoad(load, at, i, has_stiffness, sums);
  for (const RodContact& contact : load.contacts) AddContact(load.contact, contact, at, has_stiffness, sums);
  return sums;
}

/// Takes what is fixed out of the system: its row and column become the identity's.
void RodSolver::HoldFixed() noexcept {
  for (std::size_t row = 0; row < is_fixed_.size(); ++row) {
    const std::size_t first = row - std::min(row, kBandWidth - 1);
    for (std::size_t column = first; column < row; ++column) {
      if (is_fixed_[row] || is_fixed_[column]) band_[BandAt(row, column)] = 0.0;
    }
    if (is_fixed_[row]) band_[BandAt(row, row)] = 1.0;
  }
}

/// Factors band_, with as much added to its diagonal as makes it positive definite.
///
/// \return whether nothing had to be
bool RodSolver::Factor() noexcept {
  double largest = 0;
  for (std::size_t row = 0; row < is_fixed_.size(); ++row) {
    if (!is_fixed_[row]) largest = math::Max(largest, band_[BandAt(row, row)]);
  }
  if (!(largest > 0.0)) largest = 1.0;
  double shift = 0;
  for (int tries = 0; tries <= kMaxShifts; ++tries) {
    factor_ = band_;
    for (std::size_t row = 0; row < is_fixed_.size(); ++row) {
      if (is_fixed_[row]) continue;
      const bool is_angle = row % kNodeUnknowns == 3;
      factor_[BandAt(row, row)] += is_angle ? shift * mean_length_ * mean_length_ : shift;
    }
    if (FactorBand(factor_)) return tries == 0;
    shift = tries == 0 ? kFirstShift * largest : kMoreShift * shift;
  }
  return false;
}

/// Newton's step, in step_, no node farther than `max_move` [m].
bool RodSolver::CalcStep(double max_move) noexcept {
  for (std::size_t i = 0; i < step_.size(); ++i) step_[i] = is_fixed_[i] ? 0.0 : -gradient_[i];
  SolveBand(factor_, step_);
  double longest2 = 0, sum = 0;
  for (std::size_t i = 0; i < model_->NodeCount(); ++i) {
    const double* const move = &step_[PositionAt(i)];
    longest2 = math::Max(longest2, move[0] * move[0] + move[1] * move[1] + move[2] * move[2]);
  }
  for (const double each : step_) sum += each;
  if (!std::isfinite(sum) || !std::isfinite(longest2)) return false;
  const double share = longest2 > max_move * max_move ? max_move / std::sqrt(longest2) : 1.0;
  for (double& each : step_) each *= share;
  return true;
}

/// Moves trial_'s free nodes along their segments until these are as long as the linear system foresaw after this share of the
/// step: what a turn adds to a length is of second order, and a stiff segment would answer it with a force of first.
void RodSolver::RestoreLengths(double share) noexcept {
  const std::size_t segments = model_->SegmentCount();
  const auto is_free = [this](std::size_t node) { return is_fixed_[PositionAt(node)] ? 0.0 : 1.0; };
  for (int pass = 0; pass < kLengthPasses; ++pass) {
    for (std::size_t s = 0; s < segments; ++s) {
      const Vec3 along = trial_.position[s + 1] - trial_.position[s];
      const double length = math::Norm(along);
      trial_.direction[s] = math::Normalized(along, here_.direction[s]);
      const double freedom = is_free(s) + is_free(s + 1);
      diagonal_[s] = freedom > 0.0 ? freedom : 1.0;
      pull_[s] = freedom > 0.0 ? length - model_->length[s] - (elongation_[s] + share * foreseen_[s]) : 0.0;
      beside_[s] = s > 0 ? -is_free(s) * math::Dot(trial_.direction[s - 1], trial_.direction[s]) : 0.0;
    }
    // a tridiagonal system in the segments
    for (std::size_t s = 1; s < segments; ++s) {
      const double ratio = beside_[s] / diagonal_[s - 1];
      diagonal_[s] = math::Max(diagonal_[s] - ratio * beside_[s], kLeastFreedom);
      pull_[s] -= ratio * pull_[s - 1];
    }
    for (std::size_t s = segments; s-- > 0;) {
      const double behind = s + 1 < segments ? beside_[s + 1] * pull_[s + 1] : 0.0;
      pull_[s] = (pull_[s] - behind) / diagonal_[s];
      trial_.position[s] += is_free(s) * pull_[s] * trial_.direction[s];
      trial_.position[s + 1] -= is_free(s + 1) * pull_[s] * trial_.direction[s];
    }
  }
}

/// Halves the step until the potential falls; here_ is where it ends.
bool RodSolver::SearchLine(const RodLoad& load, const Sums& before) noexcept {
  double slope = 0;
  for (std::size_t i = 0; i < step_.size(); ++i) slope += gradient_[i] * step_[i];
  for (std::size_t s = 0; s < model_->SegmentCount(); ++s) {
    const double *const a = &step_[PositionAt(s)], *const b = &step_[PositionAt(s + 1)];
    elongation_[s] = math::Distance(here_.position[s], here_.position[s + 1]) - model_->length[s];
    foreseen_[s] = math::Dot(here_.direction[s], {b[0] - a[0], b[1] - a[1], b[2] - a[2]});
  }
  const double rounding = kRounding * (std::fabs(before.potential) + before.elastic);
  double share = 1.0;
  for (int halvings = 0; halvings <= kMaxHalvings; ++halvings, share *= 0.5) {
    for (std::size_t i = 0; i < model_->NodeCount(); ++i) {
      const double* const move = &step_[PositionAt(i)];
      trial_.position[i] = here_.position[i] + share * Vec3{move[0], move[1], move[2]};
      if (i < model_->SegmentCount()) trial_.angle[i] = here_.angle[i] + share * step_[AngleAt(i)];
    }
    RestoreLengths(share);
    FollowFrames(here_, trial_);
    const Sums sums = Assemble(load, trial_, false);
    if (!(sums.potential <= before.potential + kArmijo * share * slope + rounding)) continue;
    std::swap(here_, trial_);
    return true;
  }
  return false;
}

bool RodSolver::Judge(const RodSettings& settings, const Sums& sums, RodReport& report) const noexcept {
  double largest = 0;
  for (std::size_t row = 0; row < gradient_.size(); ++row) {
    if (is_fixed_[row]) continue;
    const double of_force = row % kNodeUnknowns == 3 ? 1.0 / mean_length_ : 1.0;
    largest = math::Max(largest, of_force * std::fabs(gradient_[row]));
  }
  double farthest = 0;
  for (const Vec3& p : here_.position) {
    farthest = math::Max(farthest, math::Max(std::fabs(p.x), math::Max(std::fabs(p.y), std::fabs(p.z))));
  }
  const double rounding = kPositionRounding * farthest * model_->material.stretching / shortest_;
  report.force_scale = sums.force_scale;
  report.residual = sums.force_scale > 0.0 ? largest / sums.force_scale : 0.0;
  report.length_error = sums.length_error;
  report.energy = sums.elastic;
  return largest <= math::Max(settings.tolerance * sums.force_scale, rounding);
}

RodReport RodSolver::Solve(const RodSettings& settings, const RodLoad& load, RodState& state) noexcept {
  TROCAR_ASSERT(state.position.size() == model_->NodeCount());
  TROCAR_ASSERT(load.force.empty() || load.force.size() == model_->NodeCount());
  RodReport report;
  Take(state);
  UpdatePressures(load);
  for (;;) {
    const Sums sums = Assemble(load, here_, true);
    report.is_finite = std::isfinite(sums.potential);
    if (!report.is_finite) return report;
    report.converged = Judge(settings, sums, report);
    HoldFixed();
    report.is_stable = Factor();
    // a saddle is no end: the step from it goes where the energy falls, if a force shows the way
    if (report.converged || report.steps >= settings.max_steps) break;
    if (!CalcStep(settings.max_move * mean_length_) || !SearchLine(load, sums)) break;
    ++report.steps;
    UpdatePressures(load);
  }
  state.position = here_.position, state.direction = here_.direction, state.reference = here_.reference;
  state.angle = here_.angle, state.reference_twist = here_.reference_twist;
  LetSlip(load);
  return report;
}

Vec3 RodSolver::Reaction(std::size_t node) const noexcept {
  const std::size_t at = PositionAt(node);
  return is_fixed_[at] ? Vec3{gradient_[at], gradient_[at + 1], gradient_[at + 2]} : Vec3{};
}

double RodSolver::TwistReaction(std::size_t segment) const noexcept {
  return is_fixed_[AngleAt(segment)] ? gradient_[AngleAt(segment)] : 0.0;
}

}  // namespace trocar::rod
