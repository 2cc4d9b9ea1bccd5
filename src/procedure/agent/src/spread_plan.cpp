// SPDX-License-Identifier: Apache-2.0
#include "spread_plan.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "trocar/agent/hand_motion.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using math::Vec3;

namespace {

using math::Atan2;
using math::Cos;
using math::Hypot;
using math::Pose;
using math::Sin;

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

/// Shares of a fibre at which blades take it, how far their tips go beyond it [m], and how wide they stand [-].
constexpr double kSnipShares[] = {0.5, 0.3, 0.7, 0.15, 0.85}, kSnipBeyond[] = {0.0008, 0.0016},
                 kSnipOpenings[] = {0.15, 0.3};
constexpr int kSnipSpins = 12;         // over half a turn
constexpr double kSnipRoom = 0.0004;   // at least, from blades to the skin of a duct and to an organ [m]
constexpr double kAmpleRoom = 0.0020;  // more than that is no better [m]
constexpr double kSnipInside =
    0.7;  // of the opening, within which the fibre has to cross the blades' plane [-]
constexpr std::size_t kMostSnipsLooked = 200;  // poses, the roomiest first, of which organs are kept off
constexpr double kSnipNear = 0.020;            // of the fibre, what ducts are looked at [m]

/// Distance from a point in the opening plane's half y >= 0 to the sector that a jaw sweeps, hinge at the origin.
double SectorDistance(double along, double aside, double length, double wide) {
  const double angle = Atan2(aside, along);
  if (angle <= wide) return std::max(0.0, Hypot(along, aside) - length);
  const double on = std::clamp(along * Cos(wide) + aside * Sin(wide), 0.0, length);
  return Hypot(along - on * Cos(wide), aside - on * Sin(wide));
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
    if (along <= 0.0 || Hypot(along, aside) > length) continue;
    const double angle = Atan2(aside, along);
    if (angle > narrow && angle < wide) worth += field.weights[i];
  }
  for (const SpreadField::Round& tube : field.tubes) {
    const Vec3 p = X_tool_world * tube.p;
    const double wanted = tube.radius + kBesideTube;
    if (std::fabs(p.x) > wanted) continue;
    const double distance = Hypot(p.x, SectorDistance(length - p.z, std::fabs(p.y), length, wide));
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

/// Whether blades of this opening have the fibre between them.
bool IsBetween(const instrument::Tool& tool, const collision::Segment& fibre, const Pose& X_world_tool,
               double opening) {
  const Pose X_tool_world = math::Inverse(X_world_tool);
  const Vec3 a = X_tool_world * fibre.start, b = X_tool_world * fibre.end;
  if ((a.x > 0.0) == (b.x > 0.0)) return false;
  const Vec3 p = math::Lerp(a, b, a.x / (a.x - b.x));
  const double along = tool.jaw_length - p.z;
  return along > 0.0 && Hypot(along, p.y) < tool.jaw_length &&
         Atan2(std::fabs(p.y), along) < kSnipInside * opening * 0.5 * tool.max_jaw;
}

double FindTubeRoom(const instrument::Tool& tool, std::span<const SpreadField::Round> tubes,
                    const Pose& X_world_tool, double opening) {
  const Pose X_tool_world = math::Inverse(X_world_tool);
  const double wide = opening * 0.5 * tool.max_jaw;
  double room = kAmpleRoom;
  for (const SpreadField::Round& tube : tubes) {
    const Vec3 p = X_tool_world * tube.p;
    const double off = SectorDistance(tool.jaw_length - p.z, std::fabs(p.y), tool.jaw_length, wide);
    room = std::min(room, Hypot(p.x, off) - tube.radius);
  }
  return room;
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

std::optional<double> FindSnipRoom(const SpreadField& field, std::size_t fibre, const Pose& X_world_tool,
                                   double opening) {
  if (!IsBetween(*field.tool, field.fibres[fibre], X_world_tool, opening)) return std::nullopt;
  double room = FindTubeRoom(*field.tool, field.tubes, X_world_tool, opening);
  if (room >= kSnipRoom) room = std::min(room, FindClearance(field, X_world_tool, opening));
  return room >= kSnipRoom ? std::optional(room) : std::nullopt;
}

std::optional<SpreadPose> FindSnip(const SpreadField& field, std::span<const std::uint8_t> tries) {
  std::vector<SpreadPose> poses;
  for (std::size_t i = 0; i < field.fibres.size(); ++i) {
    if (tries[i] >= kMostTries) continue;
    const collision::Segment& fibre = field.fibres[i];
    std::vector<SpreadField::Round> near;
    std::copy_if(
        field.tubes.begin(), field.tubes.end(), std::back_inserter(near),
        [&](const SpreadField::Round& tube) { return math::Distance(tube.p, fibre.start) < kSnipNear; });
    for (const double share : kSnipShares) {
      const Vec3 p = math::Lerp(fibre.start, fibre.end, share);
      for (const double beyond : kSnipBeyond) {
        SpreadPose pose;
        pose.tip = p + beyond * math::Normalized(p - field.port, {0, 0, -1});
        pose.aim = i;
        for (int turn = 0; turn < kSnipSpins; ++turn) {
          pose.spin = M_PI * turn / kSnipSpins - 0.5 * M_PI;
          const Pose X = instrument::CalcToolPose(
              field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0));
          for (const double opening : kSnipOpenings) {
            if (!IsBetween(*field.tool, fibre, X, opening)) continue;
            pose.opening = opening;
            pose.worth = FindTubeRoom(*field.tool, near, X, opening);
            if (pose.worth >= kSnipRoom) poses.push_back(pose);
          }
        }
      }
    }
  }
  std::stable_sort(poses.begin(), poses.end(), [&](const SpreadPose& a, const SpreadPose& b) {
    return std::pair(tries[a.aim], -a.worth) < std::pair(tries[b.aim], -b.worth);
  });
  poses.resize(std::min(poses.size(), kMostSnipsLooked));
  std::optional<SpreadPose> best;
  for (SpreadPose pose : poses) {
    const Pose X =
        instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, pose.tip, pose.spin, 0.0));
    const auto room = FindSnipRoom(field, pose.aim, X, pose.opening);
    if (!room || (best && *room <= best->worth)) continue;
    pose.worth = *room;
    best = pose;
  }
  return best;
}

}  // namespace trocar::agent
