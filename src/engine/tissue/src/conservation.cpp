// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/conservation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/math/small_solver.h"
#include "trocar/math/state_fields.h"
#include "volume_constraint_set.h"

namespace trocar::tissue {

using math::Pose;
using math::Vec3;

namespace {

/// Relative volume error at which the projection ends [-]; a thousandth of what is promised.
constexpr double kVolumeTolerance = 1e-7;
constexpr int kMaxProjections = 8;
/// No projection changes a volume by more than this share [-]: what is farther off comes home over several
/// ticks.
constexpr double kMaxVolumeStep = 0.1;
/// Nor does one move any node farther than this [m]: the responses are those of the organ at rest, and one that hangs by a
/// few strands, turned and folded, may respond otherwise.
constexpr double kMaxShift = 0.002;
/// The responses need no more accuracy than this: they steer the search, the constraint itself is exact [-].
constexpr double kResponseTolerance = 0.02;
constexpr double kFirstResponseTolerance = 1e-4;
constexpr int kFirstResponseIterations = 10000;
/// Iterations a tick, of all organs together, while the responses follow a change of topology or of the stiffness scales.
constexpr int kResponseIterationsPerTick = 6;

using SmallVector = math::SmallVector<kMaxClosedOrgans>;

std::uint64_t CountIntact(const TissueState& tissue) noexcept {
  std::uint64_t count = 0;
  for (const auto is_intact : tissue.strand_is_intact) count += is_intact;
  for (const double factor : tissue.spring_factor) count += factor > 0.0;
  return count;
}

}  // namespace

// --- state

void VisitState(base::StateArchive& archive, FreeRegions& regions) {
  archive.FixedField("of_node", regions.of_node);
  if (!archive.IsRestoring()) return;
  regions.count = 0;
  for (const std::uint32_t region : regions.of_node) {
    if (region == kPinnedRegion) continue;
    if (region >= kMaxFreeRegions) return archive.Fail("has a node of a region beyond the last");
    regions.count = std::max(regions.count, region + 1);
  }
}

void VisitState(base::StateArchive& archive, OrganVolume& organ) {
  archive.Field("target", organ.target);
  archive.Field("pressure", organ.pressure);
  archive.Field("opening_area", organ.opening_area);
  archive.Field("leaked", organ.leaked);
}

void VisitState(base::StateArchive& archive, VolumeResponses& responses) {
  archive.FixedField("displacement", responses.displacement);
  archive.Field("stiffness_scale", responses.stiffness_scale);
  archive.Field("shape_scale", responses.shape_scale);
  archive.Field("is_settled", responses.is_settled);
  archive.Field("has_new_topology", responses.has_new_topology);
  archive.Field("ticks_waited", responses.ticks_waited);
}

void VisitState(base::StateArchive& archive, ConservationTick& state) {
  archive.FixedField("organs", state.organs);
  archive.Field("regions", state.regions);
  archive.Field("X_world_rest", state.X_world_rest);
  archive.Field("intact_links", state.intact_links);
  archive.FixedField("last_position", state.last_position);
  archive.FixedField("last_motion", state.last_motion);
}

void VisitState(base::StateArchive& archive, ConservationState& state) {
  VisitState(archive, static_cast<ConservationTick&>(state));
  archive.Field("responses", state.responses);
}

// --- creation

Conservation::Conservation(const TissueModel& model, ConservationSettings settings)
    : model_(&model), settings_(std::move(settings)), linear_(model), rest_(MakeRestState(model)) {
  const std::size_t n = model.Size();
  SetOrgans(std::move(settings_.organs));
  gradient_.resize(n), ahead_gradient_.resize(n);
  base_force_.resize(n);
  force_.resize(n);
  next_regions_.of_node.resize(n);
  shifts_.assign(settings_.organs.size(), std::vector<Vec3>(n));
}

void Conservation::SetOrgans(std::vector<ClosedOrgan> organs) {
  TROCAR_ASSERT(organs.size() <= kMaxClosedOrgans);
  static_assert(kMaxClosedOrgans <= kMaxConstraints);
  settings_.organs = std::move(organs);
  organ_nodes_.clear();
  for (const ClosedOrgan& organ : settings_.organs)
    organ_nodes_.push_back({organ.first_node, organ.node_count});
}

void Conservation::UpdateTopology(const TissueModel& model, std::vector<ClosedOrgan> organs,
                                  ConservationState& state) {
  TROCAR_ASSERT(model.Size() == model_->Size() && organs.size() == settings_.organs.size());
  model_ = &model;
  SetOrgans(std::move(organs));
  linear_.SetModel(model);
  rest_ = MakeRestState(model);
  has_stiffness_ = false;
  state.responses.is_settled = false;
  state.responses.has_new_topology = true;
  state.intact_links = std::numeric_limits<std::uint64_t>::max();
  std::fill(state.last_motion.begin(), state.last_motion.end(), Vec3{});
}

ConservationState Conservation::MakeState(const TissueState& rest_state) {
  ConservationState state;
  for (const ClosedOrgan& organ : settings_.organs) {
    TROCAR_ASSERT(std::size_t{organ.first_node} + organ.node_count <= model_->Size());
    OrganVolume volume;
    volume.target = volume.volume = CalcClosedVolume(
        std::span(rest_state.position).subspan(organ.first_node, organ.node_count), organ.triangles);
    TROCAR_ASSERT(volume.target > 0.0);
    state.organs.push_back(volume);
  }
  state.regions.of_node.resize(model_->Size());
  FindFreeRegions(*model_, rest_state.strand_is_intact, settings_.strand_binds, rest_state.spring_factor,
                  state.regions);
  state.intact_links = CountIntact(rest_state);
  state.last_position = rest_state.position;
  state.last_motion.resize(model_->Size());
  state.responses.displacement.assign(settings_.organs.size(), std::vector<Vec3>(model_->Size()));
  (void)UpdateResponses(MakeRestState(*model_), {}, kFirstResponseIterations, kFirstResponseTolerance,
                        state.responses);
  state.responses.is_settled = state.intact_links == model_->strand_count + model_->SpringCount();
  return state;
}

std::span<Vec3> Conservation::OrganPart(std::size_t organ, std::span<Vec3> nodes) const noexcept {
  return nodes.subspan(settings_.organs[organ].first_node, settings_.organs[organ].node_count);
}

/// Gives linear_ the stiffness of the tissue at rest with the strands, springs and scales of now.
void Conservation::SetRestStiffness(const TissueState& tissue, const TissueLoad& load) noexcept {
  rest_.strand_is_intact = tissue.strand_is_intact;
  const bool have_springs_held = has_stiffness_ && load.stiffness_scale == linear_stiffness_scale_ &&
                                 load.shape_scale == linear_shape_scale_ &&
                                 tissue.spring_factor == rest_.spring_factor;
  if (have_springs_held) return linear_.FollowStrands(rest_, load);
  rest_.spring_factor = tissue.spring_factor;
  linear_.SetStiffness(rest_, load);
  linear_stiffness_scale_ = load.stiffness_scale;
  linear_shape_scale_ = load.shape_scale;
  has_stiffness_ = true;
}

/// Goes on with the responses for the strands, springs and scales of now.
///
/// \param max_iterations  of all organs together
/// \return whether all have come to the tolerance
bool Conservation::UpdateResponses(const TissueState& tissue, const TissueLoad& load, int max_iterations,
                                   double tolerance, VolumeResponses& responses) noexcept {
  SetRestStiffness(tissue, load);
  bool is_settled = true;
  for (std::size_t organ = 0; organ < settings_.organs.size(); ++organ) {
    std::fill(gradient_.begin(), gradient_.end(), Vec3{});
    const ClosedOrgan& surface = settings_.organs[organ];
    (void)CalcVolumeGradient(std::span(model_->rest).subspan(surface.first_node, surface.node_count),
                             surface.triangles, OrganPart(organ, gradient_));
    const auto report = linear_.Solve(gradient_, max_iterations, tolerance, responses.displacement[organ]);
    max_iterations -= report.iterations;
    is_settled = is_settled && report.residual <= tolerance;
  }
  responses.stiffness_scale = load.stiffness_scale;
  responses.shape_scale = load.shape_scale;
  return is_settled;
}

void Conservation::Perforate(std::size_t organ, double area, ConservationState& state) const {
  TROCAR_ASSERT(organ < state.organs.size() && area >= 0.0);
  state.organs[organ].opening_area += area;
}

// --- before a solve

void Conservation::UpdateRegions(const TissueState& tissue, ConservationState& state) noexcept {
  const std::uint64_t intact = CountIntact(tissue);
  if (intact == state.intact_links) return;
  FindFreeRegions(*model_, tissue.strand_is_intact, settings_.strand_binds, tissue.spring_factor,
                  next_regions_);
  // a piece that splits goes on from where it was
  std::array<Pose, kMaxFreeRegions> poses;
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < next_regions_.of_node.size() && next < next_regions_.count; ++i) {
    if (next_regions_.of_node[i] != next) continue;
    const std::uint32_t before = state.regions.of_node[i];
    poses[next++] = before == kPinnedRegion ? Pose{} : state.X_world_rest[before];
  }
  state.X_world_rest = poses;
  std::swap(state.regions, next_regions_);
  state.intact_links = intact;
  state.responses.is_settled = false;  // the same pressure moves other links
}

bool Conservation::IsHeld(std::uint32_t region, const TissueState& tissue,
                          const ConservationState& state) const noexcept {
  for (std::size_t i = 0; i < state.regions.of_node.size(); ++i) {
    if (state.regions.of_node[i] == region && tissue.condition[i] == NodeCondition::kPrescribed) return true;
  }
  return false;
}

void Conservation::PredictRigidMotion(TissueState& tissue, ConservationState& state) noexcept {
  UpdateRegions(tissue, state);
  for (std::uint32_t region = 0; region < state.regions.count; ++region) {
    MotionMoments moments;
    for (std::size_t i = 0; i < state.regions.of_node.size(); ++i) {
      if (state.regions.of_node[i] != region || tissue.condition[i] != NodeCondition::kPrescribed) continue;
      moments.AddPoint(1.0, state.last_position[i], tissue.position[i]);
    }
    const Pose motion = FitRigidMotion(moments, {});
    if (!(moments.weight > 0.0) || !math::IsFinite(motion.translation)) continue;
    for (std::size_t i = 0; i < state.regions.of_node.size(); ++i) {
      if (state.regions.of_node[i] != region || tissue.condition[i] == NodeCondition::kPrescribed) continue;
      tissue.position[i] = motion * tissue.position[i];
    }
    state.X_world_rest[region] = motion * state.X_world_rest[region];
  }
  std::copy(tissue.position.begin(), tissue.position.end(), state.last_position.begin());
}

std::span<const Vec3> Conservation::CalcForce(const TissueState& tissue, const TissueLoad& load,
                                              ConservationState& state) noexcept {
  TROCAR_ASSERT(load.external_force.empty() || load.external_force.data() != force_.data());
  if (load.external_force.empty()) {
    std::fill(base_force_.begin(), base_force_.end(), Vec3{});
  } else {
    std::copy(load.external_force.begin(), load.external_force.end(), base_force_.begin());
  }
  AddFrameForce(tissue, load, state);
  has_compliance_ = CalcCompliance(tissue, state);
  SetPressureForce(state);
  return force_;
}

void Conservation::SetPressureForce(const ConservationState& state) noexcept {
  std::copy(base_force_.begin(), base_force_.end(), force_.begin());
  for (std::size_t organ = 0; organ < settings_.organs.size(); ++organ) {
    const auto gradient = OrganPart(organ, gradient_), force = OrganPart(organ, force_);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] += state.organs[organ].pressure * gradient[i];
  }
}

/// The springs of a free piece pull towards its rest shape where that is now.
void Conservation::AddFrameForce(const TissueState& tissue, const TissueLoad& load,
                                 const ConservationState& state) noexcept {
  const TissueModel& model = *model_;
  if (state.regions.count == 0) return;
  std::array<bool, kMaxFreeRegions> is_held{};
  for (std::uint32_t region = 0; region < state.regions.count; ++region) {
    is_held[region] = IsHeld(region, tissue, state);
  }
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    const std::uint32_t region = state.regions.of_node[i];
    if (region == kPinnedRegion) continue;
    const Pose& X = state.X_world_rest[region];
    base_force_[i] += load.shape_scale * model.shape_stiffness[i] * (X * model.rest[i] - model.rest[i]);
    if (is_held[region]) base_force_[i] += model.mass[i] * settings_.imaging_gravity;
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      const auto& strand = model.half_strands[h];
      if (!tissue.strand_is_intact[strand.strand]) continue;
      // a strand between two pieces turns with the lower one; both ends must agree
      const std::uint32_t other = state.regions.of_node[strand.other];
      if (other < region) continue;
      const Vec3 offset = model.rest[strand.other] - model.rest[i];
      const Vec3 change =
          load.stiffness_scale * strand.stiffness * (math::Rotate(X.rotation, offset) - offset);
      base_force_[i] -= change;
      if (other != region) base_force_[strand.other] += change;
    }
  }
}

// --- after a solve

void Conservation::FitFrames(const TissueLoad& load, const TissueState& tissue,
                             ConservationState& state) const noexcept {
  const TissueModel& model = *model_;
  for (std::uint32_t region = 0; region < state.regions.count; ++region) {
    // what no hand holds lies still: nothing else in the model would carry it
    if (!IsHeld(region, tissue, state)) continue;
    MotionMoments moments;
    for (std::uint32_t i = 0; i < model.Size(); ++i) {
      if (state.regions.of_node[i] != region) continue;
      // weighted by the springs' stiffness: the fit then lowers the very energy that the solver lowers
      moments.AddPoint(load.shape_scale * model.shape_stiffness[i], model.rest[i], tissue.position[i]);
      for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
        const auto& strand = model.half_strands[h];
        const std::uint32_t other = state.regions.of_node[strand.other];
        if (!tissue.strand_is_intact[strand.strand] || other < region) continue;
        const double share = other == region ? 0.5 : 1.0;  // met from both ends
        moments.AddOffset(share * load.stiffness_scale * strand.stiffness,
                          model.rest[strand.other] - model.rest[i],
                          tissue.position[strand.other] - tissue.position[i]);
      }
    }
    const Pose fit = FitRigidMotion(moments, state.X_world_rest[region].rotation);
    if (moments.weight > 0.0 && math::IsFinite(fit.translation)) state.X_world_rest[region] = fit;
  }
}

double Conservation::MeasureVolume(std::size_t organ, const TissueState& tissue) const noexcept {
  const ClosedOrgan& surface = settings_.organs[organ];
  return CalcClosedVolume(std::span(tissue.position).subspan(surface.first_node, surface.node_count),
                          surface.triangles);
}

double Conservation::MeasureGradient(std::size_t organ, const TissueState& tissue,
                                     std::span<Vec3> gradient) const noexcept {
  const ClosedOrgan& surface = settings_.organs[organ];
  return CalcVolumeGradient(std::span(tissue.position).subspan(surface.first_node, surface.node_count),
                            surface.triangles, OrganPart(organ, gradient));
}

/// Volumes and their gradients; false when the state is not finite.
bool Conservation::MeasureVolumes(const TissueState& tissue, ConservationState& state) noexcept {
  has_ahead_ = false;
  bool is_good = true;
  for (std::size_t i = 0; i < settings_.organs.size(); ++i) {
    state.organs[i].volume = MeasureGradient(i, tissue, gradient_);
    is_good = is_good && std::isfinite(state.organs[i].volume);
  }
  return is_good;
}

/// The same where AreVolumesInReach() has just measured these positions.
bool Conservation::TakeMeasuredAhead(ConservationState& state) noexcept {
  has_ahead_ = false;
  bool is_good = true;
  for (std::size_t i = 0; i < settings_.organs.size(); ++i) {
    const auto ahead = OrganPart(i, ahead_gradient_);
    std::copy(ahead.begin(), ahead.end(), OrganPart(i, gradient_).begin());
    state.organs[i].volume = ahead_volume_[i];
    is_good = is_good && std::isfinite(ahead_volume_[i]);
  }
  return is_good;
}

/// The compliance dV_i / dP_j of the volumes, with the nodes that are held now.
bool Conservation::CalcCompliance(const TissueState& tissue, ConservationState& state) noexcept {
  if (!MeasureVolumes(tissue, state)) return false;
  const std::size_t count = settings_.organs.size();
  for (std::size_t organ = 0; organ < count; ++organ) {
    for (std::size_t i = 0; i < model_->Size(); ++i) {
      const std::uint32_t region = state.regions.of_node[i];
      const Vec3& u = state.responses.displacement[organ][i];
      shifts_[organ][i] = tissue.condition[i] == NodeCondition::kPrescribed ? Vec3{}
                          : region == kPinnedRegion                         ? u
                                                    : math::Rotate(state.X_world_rest[region].rotation, u);
    }
  }
  bool is_good = true;
  for (std::size_t i = 0; i < count; ++i) {
    const auto gradient = OrganPart(i, gradient_);
    for (std::size_t j = 0; j < count; ++j) {
      const auto shift = OrganPart(i, shifts_[j]);
      compliance_[i][j] = 0;
      for (std::size_t k = 0; k < gradient.size(); ++k) compliance_[i][j] += math::Dot(gradient[k], shift[k]);
    }
    is_good = is_good && compliance_[i][i] > 0.0;
    state.organs[i].compliance = compliance_[i][i];
  }
  return is_good;
}

/// One Newton step on all volumes, as last measured, with the compliance at hand.
Conservation::Projection Conservation::ProjectOnce(TissueState& tissue, std::span<Vec3> before,
                                                   ConservationState& state) noexcept {
  const std::size_t count = settings_.organs.size();
  SmallVector error{}, lambda{};
  bool is_done = true;
  for (std::size_t i = 0; i < count; ++i) {
    const OrganVolume& organ = state.organs[i];
    const bool is_open = !IsSealed(organ);
    const double limit = kMaxVolumeStep * organ.target;
    error[i] = is_open ? 0.0 : std::clamp(organ.target - organ.volume, -limit, limit);
    is_done = is_done && std::fabs(error[i]) <= kVolumeTolerance * organ.target;
  }
  if (is_done || !math::SolveSmall<math::Pivots::kRows>(compliance_, error, count, lambda))
    return Projection::kNone;
  for (std::size_t i = 0; i < count; ++i) {
    const OrganVolume& organ = state.organs[i];
    // through a hole gas enters before the sac is sucked in
    if (organ.opening_area > 0.0) lambda[i] = math::Max(lambda[i], -organ.pressure);
  }
  const auto shift_of = [&](std::size_t k) {
    Vec3 shift;
    for (std::size_t j = 0; j < count; ++j) shift += lambda[j] * shifts_[j][k];
    return shift;
  };
  double longest2 = 0;
  for (std::size_t k = 0; k < tissue.position.size(); ++k)
    longest2 = math::Max(longest2, math::SquaredNorm(shift_of(k)));
  const double part = longest2 > kMaxShift * kMaxShift ? kMaxShift / std::sqrt(longest2) : 1.0;
  const auto move_by = [&](double share) {
    for (std::size_t k = 0; k < tissue.position.size(); ++k) {
      const Vec3 shift = share * shift_of(k);
      tissue.position[k] += shift;
      if (!before.empty()) before[k] += shift;
    }
    for (std::size_t i = 0; i < count; ++i) state.organs[i].pressure += share * lambda[i];
  };
  move_by(part);
  double worst_before = 0, worst_after = 0;  // of the volumes that are kept, as parts of their targets
  SmallVector volume{};
  for (std::size_t i = 0; i < count; ++i) {
    const OrganVolume& organ = state.organs[i];
    volume[i] = MeasureVolume(i, tissue);
    if (error[i] == 0.0) continue;
    worst_before = math::Max(worst_before, std::fabs(organ.volume / organ.target - 1.0));
    worst_after = math::Max(worst_after, std::fabs(volume[i] / organ.target - 1.0));
  }
  if (worst_after <= worst_before) {
    for (std::size_t i = 0; i < count; ++i) state.organs[i].volume = volume[i];
    return Projection::kDone;
  }
  // the compliance is that of another shape, as where a cut left a loose flap: the step is taken back
  move_by(-part);
  return Projection::kTakenBack;
}

void Conservation::KeepVolumes(TissueState& tissue, std::span<Vec3> before,
                               ConservationState& state) noexcept {
  if (has_compliance_ && (has_ahead_ ? TakeMeasuredAhead(state) : MeasureVolumes(tissue, state)))
    (void)ProjectOnce(tissue, before, state);
  SetPressureForce(state);
}

bool Conservation::AreVolumesInReach(const TissueState& tissue, const ConservationState& state) noexcept {
  has_ahead_ = false;
  for (std::size_t i = 0; i < settings_.organs.size(); ++i) {
    const OrganVolume& organ = state.organs[i];
    ahead_volume_[i] = MeasureGradient(i, tissue, ahead_gradient_);
    const double reach = math::Max(kMaxVolumeStep * organ.target, std::fabs(organ.volume - organ.target));
    if (IsSealed(organ) && !(std::fabs(ahead_volume_[i] - organ.target) <= reach)) return false;
  }
  has_ahead_ = true;
  return true;
}

void Conservation::AddPressure(std::size_t organ, double change, ConservationState& state) const noexcept {
  double& pressure = state.organs[organ].pressure;
  pressure += change;
  if (state.organs[organ].opening_area > 0.0) pressure = math::Max(pressure, 0.0);
}

void Conservation::Leak(double dt, ConservationState& state) const noexcept {
  for (std::size_t i = 0; i < settings_.organs.size(); ++i) {
    OrganVolume& organ = state.organs[i];
    // just after a cut the compliance may not be known: the pressure is then taken as constant during the tick
    const double compliance =
        organ.compliance > 0.0 ? organ.compliance : std::numeric_limits<double>::infinity();
    const double flow =
        CalcOutflow(organ.pressure, compliance, organ.opening_area, settings_.organs[i].fluid_density, dt);
    const double outflow = math::Min(flow, math::Max(organ.target, 0.0));  // no more than is inside
    organ.target -= outflow;
    organ.leaked += outflow;
  }
}

void Conservation::Enforce(const TissueLoad& load, double dt, TissueState& tissue, ConservationState& state,
                           bool has_time) noexcept {
  VolumeResponses& responses = state.responses;
  if (load.stiffness_scale != responses.stiffness_scale || load.shape_scale != responses.shape_scale)
    responses.is_settled = false;
  // the old responses steer well enough for a while, and a tick that cuts has no time for new ones
  const bool is_late = std::exchange(responses.has_new_topology, false);
  if (!responses.is_settled && (is_late || (!has_time && responses.ticks_waited < kMaxTicksWaited))) {
    ++responses.ticks_waited;
  } else if (!responses.is_settled) {
    responses.ticks_waited = 0;
    responses.is_settled =
        UpdateResponses(tissue, load, kResponseIterationsPerTick, kResponseTolerance, responses);
  }
  if (!MeasureVolumes(tissue, state)) return;
  Leak(dt, state);
  auto last = has_compliance_ ? Projection::kDone : Projection::kNone;
  bool has_moved = false;
  for (int i = 0; i < kMaxProjections && last == Projection::kDone; ++i) {
    last = ProjectOnce(tissue, {}, state);
    has_moved = has_moved || last != Projection::kNone;
  }
  // the forces that load.external_force views become those of the state that is left: reactions and judges
  // read them
  if (has_moved) (void)MeasureVolumes(tissue, state);
  SetPressureForce(state);
  FitFrames(load, tissue, state);
  std::transform(tissue.position.begin(), tissue.position.end(), state.last_position.begin(),
                 state.last_motion.begin(), std::minus{});
  std::copy(tissue.position.begin(), tissue.position.end(), state.last_position.begin());
}

SolveReport SolveConserving(EquilibriumSolver& solver, const SolverSettings& settings, double dt,
                            Conservation& conservation, TissueLoad& load, TissueState& tissue,
                            ConservationState& state) noexcept {
  conservation.PredictRigidMotion(tissue, state);
  load.external_force = conservation.CalcForce(tissue, load, state);
  VolumeConstraintSet constraints(conservation, state);
  const SolveReport report = solver.Solve(settings, load, tissue, &constraints, state.last_motion);
  // a solve that went to its bounds has taken the tick's time
  conservation.Enforce(load, dt, tissue, state, report.converged);
  return report;
}

double FillToPressure(EquilibriumSolver& solver, std::size_t organ, double pressure, const TissueLoad& load,
                      Conservation& conservation, TissueState& tissue, ConservationState& state) {
  TROCAR_ASSERT(organ < state.organs.size() && std::fabs(pressure) <= 20e3);
  constexpr int kMaxFillings = 400;
  constexpr double kStill = 1e-6;
  const SolverSettings exact{
      .kind = SolverKind::kChebyshevJacobi2015, .max_iterations = 2000, .tolerance = 1e-6};
  const ClosedOrgan& surface = conservation.Settings().organs[organ];
  OrganVolume& filled = state.organs[organ];
  double change = 1;
  int still = 0;
  for (int filling = 0; filling < kMaxFillings && still < 3; ++filling) {
    // a pressure acts along normals that turn as the sac swells: step by step it stays near its equilibrium
    filled.pressure = pressure * math::Min(1.0, (filling + 1) / 8.0);
    conservation.PredictRigidMotion(tissue, state);
    TissueLoad loaded = load;
    loaded.external_force = conservation.CalcForce(tissue, load, state);
    (void)solver.Solve(exact, loaded, tissue);
    const double volume = CalcClosedVolume(
        std::span(tissue.position).subspan(surface.first_node, surface.node_count), surface.triangles);
    change = std::fabs(volume / filled.volume - 1.0);
    filled.volume = volume;
    still = filling >= 8 && change < kStill ? still + 1 : 0;
  }
  filled.target = filled.volume;
  return change;
}

}  // namespace trocar::tissue
