// SPDX-License-Identifier: Apache-2.0
#include "spread_plan.h"

#include <algorithm>
#include <cmath>

#include "trocar/agent/hand_motion.h"

namespace trocar::agent {
namespace {

using math::Pose;

constexpr std::size_t kMostAims = 60;    // fibres at which jaws are thought of
constexpr std::size_t kMostLooked = 24;  // poses, the best first, whose way to the organs is looked at
constexpr int kSpins = 6;                // over half a turn; jaws open alike to both sides
constexpr std::uint8_t kMostTries = 3;
constexpr double kBeyond = 0.15;  // of the jaws, how far their tips go beyond the fibre
constexpr double kOpenings[] = {1.0, 0.65, 0.45};
constexpr double kBesideTube =
    0.0006;                         // of a jaw's middle line, from the skin of a duct, which gives way [m]
constexpr double kPushed = 5000.0;  // cost of pushing a duct or an organ, in fibres by metre [1/m]
constexpr double kBesideOrgan = 0.0012;  // likewise from an organ [m]
constexpr double kLeastWorth = 0.8;
/// A spread takes a second, and longer after a way or a turn [1/m], [1/rad].
constexpr double kSlowerByWay = 8.0, kSlowerByTurn = 0.3;

/// Distance from a point in the opening plane's half y >= 0 to the sector that a jaw sweeps, hinge at the origin.
double SectorDistance(double along, double aside, double length, double wide) {
  const double angle = std::atan2(aside, along);
  if (angle <= wide) return std::max(0.0, std::hypot(along, aside) - length);
  const double on = std::clamp(along * std::cos(wide) + aside * std::sin(wide), 0.0, length);
  return std::hypot(along - on * std::cos(wide), aside - on * std::sin(wide));
}

/// Worth of opening jaws so far at a pose.
double CalcWorth(const SpreadField& field, const Pose& X_world_tool, double opening) {
  const double length = field.tool->jaw_length, widest = 0.5 * field.tool->max_jaw;
  const double wide = opening * widest, narrow = kNarrow * widest;
  const Pose X_tool_world = math::Inverse(X_world_tool);
  double worth = 0;
  for (std::size_t i = 0; i < field.fibres.size(); ++i) {
    const Vec3 a = X_tool_world * field.fibres[i].start, b = X_tool_world * field.fibres[i].end;
    if ((a.x > 0.0) == (b.x > 0.0)) continue;
    const Vec3 p = math::Lerp(a, b, a.x / (a.x - b.x));
    const double along = length - p.z, aside = std::fabs(p.y);
    if (along <= 0.0 || std::hypot(along, aside) > length) continue;
    const double angle = std::atan2(aside, along);
    if (angle > narrow && angle < wide) worth += field.weights[i];
  }
  for (const SpreadField::Round& tube : field.tubes) {
    const Vec3 p = X_tool_world * tube.p;
    const double wanted = tube.radius + kBesideTube;
    if (std::fabs(p.x) > wanted) continue;
    const double distance = std::hypot(p.x, SectorDistance(length - p.z, std::fabs(p.y), length, wide));
    worth -= kPushed * std::max(0.0, wanted - distance);
  }
  return worth;
}

double FindClearance(const SpreadField& field, const Pose& X, double opening) {
  const Vec3 hinge = X * instrument::JawHinge(*field.tool);
  double least = field.clearance({hinge, X.translation});
  for (const int side : {+1, -1})
    least = std::min(
        least,
        field.clearance({hinge, X * instrument::JawTip(*field.tool, opening * field.tool->max_jaw, side)}));
  return least;
}

}  // namespace

std::optional<SpreadPose> FindSpread(const SpreadField& field, std::span<const std::uint8_t> tries) {
  std::vector<SpreadPose> poses;
  std::vector<std::size_t> aims;
  for (std::size_t i = 0; i < field.fibres.size(); ++i) {
    if (tries[i] < kMostTries) aims.push_back(i);
  }
  const std::size_t stride = std::max<std::size_t>(1, aims.size() / kMostAims);
  for (std::size_t k = 0; k < aims.size(); k += stride) {
    const std::size_t i = aims[k];
    const Vec3 middle = 0.5 * (field.fibres[i].start + field.fibres[i].end);
    const Vec3 in = math::Normalized(middle - field.port, {0, 0, -1});
    SpreadPose pose;
    pose.tip = middle + kBeyond * field.tool->jaw_length * in;
    pose.aim = i;
    for (int turn = 0; turn < kSpins; ++turn) {
      pose.spin = M_PI * turn / kSpins - 0.5 * M_PI;
      const Pose X =
          instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0));
      for (const double opening : kOpenings) {
        pose.opening = opening;
        pose.worth = CalcWorth(field, X, opening) - 0.3 * tries[i];
        if (pose.worth > kLeastWorth) poses.push_back(pose);
      }
    }
  }
  const auto rate = [&](const SpreadPose& pose) {
    return pose.worth / (1.0 + kSlowerByWay * math::Distance(pose.tip, field.tip) +
                         kSlowerByTurn * std::fabs(std::remainder(pose.spin - field.spin, 2.0 * M_PI)));
  };
  std::stable_sort(poses.begin(), poses.end(),
                   [&](const SpreadPose& a, const SpreadPose& b) { return rate(a) > rate(b); });
  poses.resize(std::min(poses.size(), kMostLooked));
  std::optional<SpreadPose> best;
  for (SpreadPose pose : poses) {
    const Pose X =
        instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0));
    pose.worth -= kPushed * std::max(0.0, kBesideOrgan - FindClearance(field, X, pose.opening));
    if (pose.worth > kLeastWorth && (!best || rate(pose) > rate(*best))) best = pose;
  }
  return best;
}

}  // namespace trocar::agent
