// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/hand_motion.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/math/state_fields.h"

namespace trocar::agent {

using math::Vec3;

namespace {

using math::Atan2;
using math::Cos;
using math::Sin;

/// Peak over mean speed of a minimum-jerk reach.
constexpr double kPeakOverMean = 1.875;
/// Shorter reaches are too near their end to stray [m].
constexpr double kShortReach = 0.015;
constexpr double kMostOvershoot = 0.006;  // [m]

/// Across `along`, at an angle of `turn`, and never down: below lies what is operated on.
Vec3 PickSide(const Vec3& along, double turn) {
  const Vec3 level = math::Normalized(math::Cross(along, {0, 0, 1}), {1, 0, 0});
  const Vec3 up = math::Cross(level, along);
  return Cos(turn) * level + Sin(turn) * (up.z < 0 ? -1.0 : 1.0) * up;
}

double StepTowards(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

HandMotion::HandMotion(const Vec3& p_world_port, const instrument::TrocarJoints& start,
                       const HandSkill& skill, std::uint64_t seed)
    : p_world_port_(p_world_port),
      skill_(skill),
      random_(seed),
      spin_(start.spin),
      spin_goal_(start.spin),
      jaw_(start.jaw),
      jaw_goal_(start.jaw) {
  math::Random random(seed);
  for (auto& axis : tremor_) {
    for (Sine& sine : axis) sine = {random.Uniform(8.0, 12.0), random.Uniform(0.0, 2.0 * M_PI)};
  }
  random_ = random.NextWord();
  from_ = to_ = tip_ = instrument::CalcToolPose(p_world_port, start).translation;
}

void HandMotion::VisitState(base::StateArchive& archive) {
  archive.Field("random", random_);
  archive.Field("time", time_);
  archive.Field("from", from_);
  archive.Field("to", to_);
  archive.Field("tip", tip_);
  if (skill_.wander > 0) archive.Field("bulge", bulge_);
  if (skill_.overshoot > 0) {
    archive.Field("aim", aim_);
    archive.Field("speed", speed_);
    archive.Field("is_past", is_past_);
  }
  archive.Field("reach_time", reach_time_);
  archive.Field("reach_duration", reach_duration_);
  archive.Field("spin", spin_);
  archive.Field("spin_goal", spin_goal_);
  archive.Field("jaw", jaw_);
  archive.Field("jaw_goal", jaw_goal_);
}

void HandMotion::MoveTo(const Vec3& p_world_tip, double hurry) {
  math::Random random(random_);
  const double e = skill_.aim_error;
  const Vec3 miss{random.Uniform(-e, e), random.Uniform(-e, e), random.Uniform(-e, e)};
  const Vec3 way = p_world_tip + miss - tip_;
  const double length = math::Norm(way);
  const bool strays = length > kShortReach;
  bulge_ = {};
  if (skill_.wander > 0 && strays)
    bulge_ = skill_.wander * length * PickSide((1 / length) * way, random.Uniform(0.0, M_PI));
  random_ = random.NextWord();
  aim_ = p_world_tip + miss;
  is_past_ = skill_.overshoot > 0 && strays;
  Vec3 to = aim_;
  if (is_past_) to = aim_ + std::min(skill_.overshoot, kMostOvershoot / length) * way;
  BeginReach(to, skill_.speed * hurry);
}

void HandMotion::BeginReach(const Vec3& to, double speed) {
  from_ = tip_;
  to_ = to;
  speed_ = speed;
  reach_time_ = 0;
  const double way = math::Distance(from_, to_) + math::Norm(bulge_);
  reach_duration_ = std::max(skill_.shortest, kPeakOverMean * way / speed_);
}

void HandMotion::Turn(double spin) {
  spin_goal_ = spin_ + std::remainder(spin - spin_, 2 * M_PI);
}

void HandMotion::SetJaw(double jaw) {
  jaw_goal_ = jaw;
}

Vec3 HandMotion::BehindTip(double way) const {
  return tip_ + way * math::Normalized(p_world_port_ - tip_);
}

bool HandMotion::IsMoving() const {
  return reach_time_ < reach_duration_;
}

bool HandMotion::IsTurning() const {
  return spin_ != spin_goal_ || jaw_ != jaw_goal_;
}

Vec3 HandMotion::CalcTremor() const {
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis) {
    for (const Sine& sine : tremor_[static_cast<std::size_t>(axis)])
      offset[axis] += skill_.tremor / kSines * Sin(2 * M_PI * sine.frequency * time_ + sine.phase);
  }
  return offset;
}

instrument::TrocarJoints HandMotion::Step(double dt) {
  time_ += dt;
  if (IsMoving()) {
    reach_time_ = std::min(reach_time_ + dt, reach_duration_);
    const double t = reach_time_ / reach_duration_;
    const double s = t * t * t * (10 + t * (-15 + 6 * t));
    tip_ = math::Lerp(from_, to_, s);
    if (skill_.wander > 0) {
      const double bend = Sin(M_PI * s);
      tip_ = tip_ + bend * bend * bulge_;
    }
    if (is_past_ && !IsMoving()) {
      is_past_ = false;
      bulge_ = {};
      BeginReach(aim_, speed_);
    }
  }
  spin_ = StepTowards(spin_, spin_goal_, skill_.spin_rate * dt);
  jaw_ = StepTowards(jaw_, jaw_goal_, skill_.jaw_rate * dt);
  return instrument::FindJoints(p_world_port_, tip_ + CalcTremor(), spin_, jaw_);
}

double FindSpin(const Vec3& p_world_port, const Vec3& p_world_tip, const Vec3& across) noexcept {
  const math::Pose X =
      instrument::CalcToolPose(p_world_port, instrument::FindJoints(p_world_port, p_world_tip, 0.0, 0.0));
  const Vec3 in_tool = math::Rotate(math::Inverse(X.rotation), across);
  // spin turns the opening direction +y towards -x; both senses open alike, so the smaller turn
  const double spin = Atan2(-in_tool.x, in_tool.y);
  return spin > M_PI / 2 ? spin - M_PI : spin < -M_PI / 2 ? spin + M_PI : spin;
}

double FindRoll(const Vec3& p_world_port, const Vec3& p_world_tip, const Vec3& axis, double angle) noexcept {
  // spin turns about the tool's z, which points back to the port
  return angle * math::Dot(axis, math::Normalized(p_world_port - p_world_tip));
}

}  // namespace trocar::agent
