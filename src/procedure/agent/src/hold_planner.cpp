// SPDX-License-Identifier: Apache-2.0
#include "hold_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trocar::agent {

using math::Vec3;

namespace {

/// A hold lies this far from where the work is, clear of the organ that is spared.
constexpr double kHoldAway = 0.020, kLeastAway = 0.010, kMostAway = 0.060, kHoldClear = 0.008;  // [m]
constexpr double kJawsBeyond = 0.005;                    // of a grasper's tip beyond the hold [m]
constexpr double kFacing = 0.006;                        // worth of wall that faces the port [m]
constexpr double kLeastFacing = 0.1;                     // cosine
constexpr double kShaftClear = 0.006, kShaftWay = 0.10;  // of the shaft, and the length that is looked at [m]
constexpr double kSameHold = 0.004;                      // [m]
constexpr double kEndPart = 0.012;  // of the organ, from the neck or from the fundus on [m]
constexpr double kLeastFlap = 0.012,
                 kMostFlap = 0.035;  // of a hold from where it peels off, along what is free [m]

/// (nodes of the organ) sums of the normals of their triangles.
std::vector<Vec3> CalcNormals(const HoldField& field) {
  const scene::SurfaceInfo& organ = *field.organ;
  std::vector<Vec3> normals(organ.node_count);
  for (const auto& triangle : organ.triangles) {
    const Vec3 &a = field.positions[organ.first_node + triangle[0]],
               &b = field.positions[organ.first_node + triangle[1]],
               &c = field.positions[organ.first_node + triangle[2]];
    for (const auto corner : triangle) normals[corner] += math::Cross(b - a, c - a);
  }
  return normals;
}

}  // namespace

bool HoldFilter::Allows(double along, double length) const noexcept {
  switch (kind) {
    case Kind::kAny:
      return true;
    case Kind::kNeck:
      return along < kEndPart;
    case Kind::kFundus: {
      const double beyond = along - peels;
      return along > length - kEndPart || (beyond > kLeastFlap && beyond < kMostFlap);
    }
    case Kind::kFree:
      break;
  }
  const double before = peels - along;
  return before > kLeastFlap && before < kMostFlap;
}

void HoldFilter::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("peels", peels);
}

std::optional<std::uint32_t> FindHold(const HoldField& field, const Vec3& near,
                                      std::span<const std::uint32_t> avoid) {
  const scene::SurfaceInfo& organ = *field.organ;
  const std::vector<Vec3> normals = CalcNormals(field);
  const double length = field.jaw_length;
  std::optional<std::uint32_t> best;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < organ.node_count; ++i) {
    const std::uint32_t node = organ.first_node + i;
    if (!field.may(node)) continue;
    const Vec3& p = field.positions[node];
    const double away = math::Distance(p, near);
    if (away < kLeastAway || away > kMostAway) continue;
    if (std::any_of(avoid.begin(), avoid.end(), [&](std::uint32_t other) {
          return math::Distance(field.positions[other], p) < kSameHold;
        }))
      continue;
    const Vec3 out = math::Normalized(field.port - p);
    const double facing = math::Dot(math::Normalized(normals[i]), out);
    if (facing < kLeastFacing) continue;
    const double clear =
        field.spared_clearance({p - kJawsBeyond * out, p + (length - kJawsBeyond) * out}, kHoldClear);
    // the shaft has to come there past the organ's own body
    const double way = std::min(kShaftClear, field.clearance({p + 0.4 * length * out, p + kShaftWay * out}));
    const double worth = 3.0 * clear + 2.0 * way + kFacing * facing - 0.3 * std::fabs(away - kHoldAway);
    if (worth <= best_worth) continue;
    best_worth = worth;
    best = node;
  }
  return best;
}

}  // namespace trocar::agent
