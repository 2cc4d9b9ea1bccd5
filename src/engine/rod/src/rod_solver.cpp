// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "crossing_points.h"
#include "rod_elements.h"
#include "rod_stiffness.h"
#include "trocar/base/assert.h"
#include "trocar/rod/rod.h"

namespace trocar::rod {

using math::Vec3;

namespace {

/// A step is taken where the potential falls by this part of what its slope promises [-] (Armijo); else it is halved.
constexpr double kArmijo = 1e-4;
constexpr int kMaxHalvings = 12;
/// What is lost of a coordinate as it is rounded [-]; a segment answers with a force that nothing can balance.
constexpr double kPositionRounding = 1e-15;
/// Corrections of the lengths a step: each leaves the square of what was wrong.
constexpr int kLengthPasses = 3;
/// Of a chain that is held at both ends and straight no segment can give way [-].
constexpr double kLeastFreedom = 1e-3;
/// How deep a step may let the rod sink in, and how much deeper where it is deeper already, over its radius [-].
constexpr double kMostDepth = 0.3;
constexpr double kMoreDepth = 0.1;
/// A solve ends where so little of a step is allowed [-].
constexpr double kLeastShare = 1e-3;
/// Differences of the potential below this part of its terms are rounding [-].
constexpr double kRounding = 1e-13;

/// Huber's function of how far what sticks is drawn: it pulls with its stiffness up to the limit, and with the limit beyond.
struct Friction {
  double potential = 0;  // [J]
  double across = 0;     // force over the way [N/m]
  Vec3 slips;            // direction, zero where it sticks
};
Friction CalcFriction(const Vec3& drawn, double limit, double stiffness) noexcept {
  const double length = math::Norm(drawn);
  if (!(stiffness * length > limit)) return {0.5 * stiffness * length * length, stiffness, {}};
  return {limit * (length - 0.5 * limit / stiffness), limit / length, drawn / length};
}

/// Of a vector what is square to a unit vector.
Vec3 Across(const Vec3& v, const Vec3& normal) noexcept {
  return v - math::Dot(v, normal) * normal;
}

/// What is left of a stretch when what is beyond the limit has slipped.
Vec3 LimitStretch(const Vec3& drawn, double limit, double stiffness) noexcept {
  const double length = math::Norm(drawn), most = limit / stiffness;
  return length > most ? most / length * drawn : drawn;
}

}  // namespace

RodSolver::RodSolver(const RodModel& model)
    : model_(&model), stiffness_(std::make_unique<RodStiffness>(model.NodeCount())) {
  const std::size_t n = model.NodeCount(), segments = model.SegmentCount(), unknowns = kNodeUnknowns * n;
  shortest_ = *std::min_element(model.length.begin(), model.length.end());
  for (const double length : model.length) mean_length_ += length / static_cast<double>(segments);
  for (Shape* shape : {&here_, &trial_}) {
    shape->position.resize(n), shape->reference_twist.resize(n);
    shape->direction.resize(segments), shape->reference.resize(segments), shape->angle.resize(segments);
  }
  start_.resize(n);
  for (auto* list : {&tension_, &wanted_, &elongation_, &foreseen_, &diagonal_, &beside_, &pull_})
    list->resize(segments);
  gradient_.resize(unknowns), step_.resize(unknowns), is_fixed_.resize(unknowns);
}
RodSolver::~RodSolver() = default;
RodSolver::RodSolver(RodSolver&&) noexcept = default;
RodSolver& RodSolver::operator=(RodSolver&&) noexcept = default;

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
      stiffness_->At(b + row, a + column) -= entry;
      if (j > i) continue;
      stiffness_->At(a + row, a + column) += entry;
      stiffness_->At(b + row, b + column) += entry;
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
    for (std::size_t j = 0; j <= i; ++j) stiffness_->At(first + i, first + j) += joint.stiffness[i][j];
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
    if (has_stiffness) stiffness_->At(row, row) += load.drag;
  }
}

/// Adds the gradient of a potential at a place on a segment.
void RodSolver::AddPointForce(std::size_t segment, double at, const Vec3& force) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<std::size_t>(axis);
    gradient_[PositionAt(segment) + row] += (1.0 - at) * force[axis];
    gradient_[PositionAt(segment + 1) + row] += at * force[axis];
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
      const double entry = (along - across) * contact.normal[i] * contact.normal[j] +
                           across * ((i == j ? 1.0 : 0.0) - slips[i] * slips[j]);
      stiffness_->At(b + row, a + column) += of_a * of_b * entry;
      if (j > i) continue;
      stiffness_->At(a + row, a + column) += of_a * of_a * entry;
      stiffness_->At(b + row, b + column) += of_b * of_b * entry;
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
  const Vec3 drawn = Across(point - contact.anchor, contact.normal);
  const Friction friction = CalcFriction(drawn, contact.friction * contact.pressure, settings.across);
  sums.potential += friction.potential;
  AddPointForce(contact.segment, contact.at, friction.across * drawn - pressure * contact.normal);
  if (has_stiffness) AddPointStiffness(contact, settings.normal, friction.across, friction.slips);
}

void RodSolver::AddCrossing(const RodContactSettings& settings, const RodCrossing& crossing, const Shape& at,
                            bool has_stiffness, Sums& sums) noexcept {
  const Vec3 apart = CalcApart(at.position, crossing);
  const double depth = 2.0 * model_->material.radius - math::Dot(crossing.normal, apart);
  if (!(depth > 0.0)) return;
  const double pressure = settings.normal * depth;
  sums.potential += 0.5 * pressure * depth;
  sums.force_scale = math::Max(sums.force_scale, pressure);
  const Vec3 drawn = Across(apart - crossing.anchor, crossing.normal);
  const Friction friction = CalcFriction(drawn, settings.self_friction * crossing.pressure, settings.across);
  sums.potential += friction.potential;
  const Vec3 force = friction.across * drawn - pressure * crossing.normal;
  AddPointForce(crossing.a, crossing.at_a, force);
  AddPointForce(crossing.b, crossing.at_b, -force);
  if (!has_stiffness) return;
  const RodPoint a{crossing.a, crossing.at_a}, b{crossing.b, crossing.at_b};
  stiffness_->AddPull(a, b, crossing.normal, settings.normal);
  // two directions square to the normal; what slips resists only square to its way
  const bool slips = math::SquaredNorm(friction.slips) > 0.0;
  const Vec3 first = slips ? friction.slips : math::AnyPerpendicular(crossing.normal);
  if (!slips) stiffness_->AddPull(a, b, first, friction.across);
  stiffness_->AddPull(a, b, math::Cross(crossing.normal, first), friction.across);
}

/// Takes over what presses, which is the friction's limit in the next step, and where crossings are nearest now.
void RodSolver::UpdateContacts(const RodLoad& load) const noexcept {
  for (RodContact& contact : load.contacts) {
    const Vec3 point =
        math::Lerp(here_.position[contact.segment], here_.position[contact.segment + 1], contact.at);
    contact.pressure =
        math::Max(0.0, load.contact.normal * (contact.offset - math::Dot(contact.normal, point)));
  }
  for (RodCrossing& crossing : load.crossings) {
    MoveCrossing(here_.position, crossing);
    const double between = math::Dot(crossing.normal, CalcApart(here_.position, crossing));
    crossing.pressure = math::Max(0.0, load.contact.normal * (2.0 * model_->material.radius - between));
  }
}

/// What has slipped sticks where it has come to.
void RodSolver::LetSlip(const RodLoad& load) const noexcept {
  const double stiffness = load.contact.across;
  for (RodContact& contact : load.contacts) {
    const Vec3 point =
        math::Lerp(here_.position[contact.segment], here_.position[contact.segment + 1], contact.at);
    contact.anchor = point - LimitStretch(Across(point - contact.anchor, contact.normal),
                                          contact.friction * contact.pressure, stiffness);
  }
  for (RodCrossing& crossing : load.crossings) {
    const Vec3 apart = CalcApart(here_.position, crossing);
    crossing.anchor = apart - LimitStretch(Across(apart - crossing.anchor, crossing.normal),
                                           load.contact.self_friction * crossing.pressure, stiffness);
  }
}

RodSolver::Sums RodSolver::Assemble(const RodLoad& load, const Shape& at, bool has_stiffness) noexcept {
  Sums sums;
  std::fill(gradient_.begin(), gradient_.end(), 0.0);
  if (has_stiffness) stiffness_->Clear();
  for (std::size_t s = 0; s < model_->SegmentCount(); ++s) AddSegment(at, s, has_stiffness, sums);
  for (std::size_t i = 1; i + 1 < model_->NodeCount(); ++i) AddBend(at, i, has_stiffness, sums);
  for (std::size_t i = 0; i < model_->NodeCount(); ++i) AddLoad(load, at, i, has_stiffness, sums);
  for (const RodContact& contact : load.contacts) AddContact(load.contact, contact, at, has_stiffness, sums);
  for (const RodCrossing& crossing : load.crossings)
    AddCrossing(load.contact, crossing, at, has_stiffness, sums);
  return sums;
}

/// Share of step_ that lets nothing sink in by more than a part of the rod's radius. A crossing that does not press yet is not in
/// the stiffness, and the energy that a hand's move has put into one segment would hide what it costs to go through another.
double RodSolver::LimitByContacts(const RodLoad& load) const noexcept {
  const auto move_at = [this](std::size_t segment, double at, const Vec3& along) {
    const double *const a = &step_[PositionAt(segment)], *const b = &step_[PositionAt(segment + 1)];
    return math::Dot(along, math::Lerp(Vec3{a[0], a[1], a[2]}, Vec3{b[0], b[1], b[2]}, at));
  };
  const double radius = model_->material.radius;
  double share = 1.0;
  const auto limit = [&](double depth, double deeper) {
    const double most = math::Max(kMostDepth * radius, depth + kMoreDepth * radius);
    if (depth + share * deeper > most) share = (most - depth) / deeper;
  };
  for (const RodContact& c : load.contacts) {
    const Vec3 point = math::Lerp(here_.position[c.segment], here_.position[c.segment + 1], c.at);
    limit(c.offset - math::Dot(c.normal, point), -move_at(c.segment, c.at, c.normal));
  }
  for (const RodCrossing& c : load.crossings) {
    limit(2.0 * radius - math::Dot(c.normal, CalcApart(here_.position, c)),
          move_at(c.b, c.at_b, c.normal) - move_at(c.a, c.at_a, c.normal));
  }
  return share;
}

/// Newton's step, in step_, no longer than the settings and what presses allow.
///
/// \return false where there is no such step
bool RodSolver::CalcStep(const RodSettings& settings, const RodLoad& load) noexcept {
  for (std::size_t i = 0; i < step_.size(); ++i) step_[i] = is_fixed_[i] ? 0.0 : -gradient_[i];
  stiffness_->Solve(step_);
  double longest2 = 0, sum = 0;
  for (std::size_t i = 0; i < model_->NodeCount(); ++i) {
    const double* const move = &step_[PositionAt(i)];
    longest2 = math::Max(longest2, move[0] * move[0] + move[1] * move[1] + move[2] * move[2]);
  }
  for (const double each : step_) sum += each;
  if (!std::isfinite(sum) || !std::isfinite(longest2)) return false;
  const double max_move = settings.max_move * mean_length_;
  const double whole =
      math::Min(LimitByContacts(load), longest2 > max_move * max_move ? max_move / std::sqrt(longest2) : 1.0);
  // what a node has left of its way in this solve
  double share = whole;
  for (std::size_t i = 0; i < model_->NodeCount() && settings.max_way < INFINITY; ++i) {
    const double* const move = &step_[PositionAt(i)];
    const double length = math::Norm({move[0], move[1], move[2]});
    const double left = settings.max_way - math::Distance(here_.position[i], start_[i]);
    if (share * length > left) share = math::Max(0.0, left / length);
  }
  for (double& each : step_) each *= share;
  return share > kLeastShare * whole;
}

/// Moves trial_'s free nodes along their segments until these are as long as is wanted.
void RodSolver::RestoreLengths() noexcept {
  const std::size_t segments = model_->SegmentCount();
  const auto is_free = [this](std::size_t node) { return is_fixed_[PositionAt(node)] ? 0.0 : 1.0; };
  for (int pass = 0; pass < kLengthPasses; ++pass) {
    for (std::size_t s = 0; s < segments; ++s) {
      const Vec3 along = trial_.position[s + 1] - trial_.position[s];
      const double length = math::Norm(along);
      trial_.direction[s] = math::Normalized(along, here_.direction[s]);
      const double freedom = is_free(s) + is_free(s + 1);
      diagonal_[s] = freedom > 0.0 ? freedom : 1.0;
      pull_[s] = freedom > 0.0 ? length - model_->length[s] - wanted_[s] : 0.0;
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
    // what a turn adds to a length is of second order, and a stiff segment would answer it with a force of first
    for (std::size_t s = 0; s < model_->SegmentCount(); ++s)
      wanted_[s] = elongation_[s] + share * foreseen_[s];
    RestoreLengths();
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
  UpdateContacts(load);
  for (;;) {
    const Sums sums = Assemble(load, here_, true);
    report.is_finite = std::isfinite(sums.potential);
    if (!report.is_finite) return report;
    report.converged = Judge(settings, sums, report);
    report.is_stable = stiffness_->Factor(is_fixed_, mean_length_);
    // a saddle is no end: the step from it goes where the energy falls, if a force shows the way
    if (report.converged || report.steps >= settings.max_steps) break;
    if (!CalcStep(settings, load)) break;
    if (!SearchLine(load, sums)) {
      (void)Assemble(load, here_, false);  // forces where it stays, not where it was tried
      break;
    }
    ++report.steps;
    UpdateContacts(load);
  }
  state.position = here_.position, state.direction = here_.direction, state.reference = here_.reference;
  state.angle = here_.angle, state.reference_twist = here_.reference_twist;
  state.tension = tension_;
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
