// SPDX-License-Identifier: Apache-2.0
#include "find_place.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tool_alignment.h"
#include "trocar/instrument/camera.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;

namespace {

constexpr double kWellInside = 0.85;                         // of the picture's width
constexpr double kWaiting[] = {0.045, 0.038, 0.031, 0.024};  // of a tool over the field [m]
constexpr double kUnderSurface = 0.006;                      // of the liver [m]
constexpr double kBesideHold = 0.015, kBesideWeight = 4.0;   // of a place in the wall from the hold [m], [-]

/// In the gallbladder's wall, near what the left hand holds, so that it does not give way; towards the right hand's trocar.
Vec3 FindWallBesideHold(const SurgeonView& view) {
  const scene::SurfaceInfo& wall = view.known.surfaces[static_cast<std::size_t>(view.known.gallbladder)];
  const auto positions = std::span(view.seen.positions).subspan(wall.first_node, wall.node_count);
  const auto cost = [&](const Vec3& p) {
    const double away = math::Distance(p, view.Hand(kLeft).Tip());
    return math::Distance(p, view.Hand(kRight).Port()) + kBesideWeight * std::fabs(away - kBesideHold);
  };
  return *std::min_element(positions.begin(), positions.end(),
                           [&](const Vec3& a, const Vec3& b) { return cost(a) < cost(b); });
}

Vec3 FindMiddleOfGallbladder(const SurgeonView& view) {
  const scene::SurfaceInfo& surface = view.known.surfaces[static_cast<std::size_t>(view.known.gallbladder)];
  Vec3 centre;
  for (std::uint32_t i = 0; i < surface.node_count; ++i)
    centre += view.seen.positions[surface.first_node + i] / static_cast<double>(surface.node_count);
  return centre;
}

Vec3 FindMiddleOf(const SurgeonView& view, const std::vector<std::uint32_t>& strands) {
  Vec3 sum;
  for (const std::uint32_t i : strands) sum += view.seen.positions[view.known.strands[i].a];
  return sum / static_cast<double>(strands.size());
}

/// Towards the hand's trocar from what the picture is about, as far off as is well inside the picture.
Vec3 FindOverField(const SurgeonView& view, const Vec3& port, const Vec3& field) {
  const Vec3 back = math::Normalized(port - field);
  for (const double away : kWaiting) {
    if (instrument::IsInView(view.seen.X_world_laparoscope,
                             kWellInside * view.scene.laparoscope.field_of_view, field + away * back))
      return field + away * back;
  }
  return field + kWaiting[3] * back;
}

/// Of the tip, without regard to a hook's toe.
Vec3 FindTipPlace(const SurgeonView& view, const Place& place, const PlaceContext& context) {
  const HandMotion& hand = view.Hand(place.hand);
  const HandMotion& right = view.Hand(kRight);
  switch (place.kind) {
    case Place::Kind::kNone:
    case Place::Kind::kPoint:
      return place.p;
    case Place::Kind::kNode: {
      const Vec3& p = view.seen.positions[place.node];
      return place.back == 0.0 ? p : p + place.back * math::Normalized(hand.Port() - p);
    }
    case Place::Kind::kAboveNode: {
      const Vec3& p = view.seen.positions[place.node];
      return p + place.back * math::Normalized(0.5 * (view.Hand(kLeft).Port() + right.Port()) - p);
    }
    case Place::Kind::kTube:
      return view.TubePoint(place.tube, place.share);
    case Place::Kind::kAim:
      return PointBeyond(right.Port(), view.TubePoint(place.tube, place.share), -place.back);
    case Place::Kind::kBetweenJaws:
      return context.aim.FindTip(right.Port(), view.LineOf(place.tube).At(place.share), place.back);
    case Place::Kind::kStrands:
      return FindMiddleOf(view, place.strands);
    case Place::Kind::kGallbladder:
      return FindMiddleOfGallbladder(view);
    case Place::Kind::kBesideHold:
      return FindWallBesideHold(view);
    case Place::Kind::kInLiver: {
      const Vec3 p = view.seen.positions[view.known.liver_node];
      const Vec3 in = math::Normalized(p - right.Port());
      return p + kUnderSurface * in + place.back * math::Normalized(math::Cross(in, {0, 1, 0}));
    }
    case Place::Kind::kRightTip:
      return view.Tool(kRight).X_world_tool.translation;
    case Place::Kind::kBehindTip:
      return hand.BehindTip(place.back);
    case Place::Kind::kFromTip:
      return hand.Tip() + place.p;
    case Place::Kind::kPool: {
      const Vec3& p = view.seen.operation.flow.p_world_pool;
      return p + place.back * math::Normalized(hand.Port() - p);
    }
    case Place::Kind::kOverField:
      break;
  }
  return FindOverField(view, hand.Port(), FindPlace(view, context.field, context));
}

}  // namespace

Vec3 FindPlace(const SurgeonView& view, const Place& place, const PlaceContext& context) {
  const Vec3 p = FindTipPlace(view, place, context);
  if (!place.is_for_hook) return p;
  const HandMotion& hook = view.Hand(kRight);
  return HookTip(p, HookToe(hook.Port(), p, hook.Spin()));
}

}  // namespace trocar::agent
