// SPDX-License-Identifier: Apache-2.0
#include "hook_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "state_fields.h"
#include "tool_alignment.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

using math::Vec3;

namespace {

/// Shares of a fibre at which it is taken, the best first.
constexpr double kFibreShares[] = {0.5, 0.7, 0.3, 0.85, 0.15};

}  // namespace

void DissectionGoal::VisitState(base::StateArchive& archive) {
  archive.Field("what", what);
  archive.Field("strands", strands);
  archive.Field("order", order);
  archive.Field("enough", enough);
  archive.Field("until", until);
  archive.Field("traction", traction);
  archive.Field("way", way);
  archive.Field("may", may);
  archive.Field("left_before", left_before);
}

double HookField::EntryDistance(const collision::Segment& segment) const {
  double least = std::numeric_limits<double>::infinity();
  for (const collision::Segment& entry : entries)
    least = std::min(least, collision::FindNearestSegmentSegment(entry, segment).squared_distance);
  return std::sqrt(least);
}

collision::Segment HookField::Wire() const {
  return {X_world_hook * instrument::kHookToe.a, X_world_hook * instrument::kHookToe.b};
}

collision::SegmentSegmentPoints HookField::Gap(std::uint32_t strand) const {
  return collision::FindNearestSegmentSegment(Wire(),
                                              {positions[strands[strand].a], positions[strands[strand].b]});
}

Vec3 HookField::HookedPoint(std::uint32_t strand) const {
  const Vec3 &a = positions[strands[strand].a], &b = positions[strands[strand].b];
  for (const double share : kFibreShares) {
    const Vec3 p = math::Lerp(a, b, share);
    if (EntryDistance({p, p}) > kEntryFar) return p;
  }
  return math::Lerp(a, b, kFibreShares[0]);
}

Vec3 HookField::Stand(const HandMotion& hook, std::uint32_t strand, double spin) const {
  const Vec3 at = HookedPoint(strand);
  return at - kOnToe * HookToe(hook.Port(), at, spin);
}

}  // namespace trocar::agent
