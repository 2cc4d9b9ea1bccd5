// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {

using instrument::IsInView;
using instrument::kRight;
using math::Vec3;

namespace {

/// Open jaws wait so far before a hold, and close so far past it [m].
constexpr double kBeforeHold = 0.015, kPastHold = 0.005;
constexpr double kWellInside = 0.85;  // of the picture's width

}  // namespace

SurgeonAct& CholecystectomySurgeon::Add(SurgeonAct::Kind kind, std::string doing, double time_limit) {
  SurgeonAct act;
  act.kind = kind;
  act.doing = std::move(doing);
  act.time_limit = time_limit;
  acts_.push_back(std::move(act));
  return acts_.back();
}

void CholecystectomySurgeon::Reach(int hand, const Place& tip, double hurry) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kReach, "reach", 5.0);
  act.hand = hand;
  act.place = tip;
  act.hurry = hurry;
}

void CholecystectomySurgeon::Jaw(int hand, double share) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kJaw, share > 0.5 ? "open" : "close", 2.0);
  act.hand = hand;
  act.amount = share;
}

/// Of the right hand's tool, in the time that jaws need to close.
void CholecystectomySurgeon::SetJaw(std::string doing, double jaw) {
  Add(SurgeonAct::Kind::kSetJaw, std::move(doing), 2.0).amount = jaw;
}

void CholecystectomySurgeon::Wait(double seconds) {
  Add(SurgeonAct::Kind::kWait, "wait", seconds + 1.0).seconds = seconds;
}

void CholecystectomySurgeon::Exchange(int hand, instrument::ToolKind kind, bool over_field) {
  const auto& tray = scene_->instruments[static_cast<std::size_t>(hand)].tray;
  const auto found =
      std::find_if(tray.begin(), tray.end(), [&](const instrument::Tool& tool) { return tool.kind == kind; });
  // a tool goes in over the field, in the picture
  if (over_field) {
    Place waiting = Place::Of(Place::Kind::kOverField);
    waiting.hand = hand;
    Reach(hand, waiting);
  }
  SurgeonAct& act = Add(SurgeonAct::Kind::kExchange,
                        "exchange " + (found != tray.end() ? found->name : std::string("nothing")), 6.0);
  act.hand = hand;
  act.tool = static_cast<std::uint8_t>(found - tray.begin());
  // what comes in comes in closed; an open clip applier that closes would lose its clip
  Jaw(hand, 0.0);
}

/// \param at  a node of the tissue
void CholecystectomySurgeon::Grasp(int hand, const Place& at, double squeeze) {
  Place before = at, in = at;
  before.hand = in.hand = hand;
  before.back = kBeforeHold;
  in.back = -kPastHold;
  Jaw(hand, 0.8);
  Reach(hand, before);
  // deep enough that the jaws close over what lies there
  Reach(hand, in, 0.5);
  Jaw(hand, squeeze);
  Wait(0.2);
}

void CholecystectomySurgeon::Draw(int hand, const Vec3& by) {
  Place drawn = Place::Of(Place::Kind::kFromTip);
  drawn.hand = hand;
  drawn.p = by;
  Reach(hand, drawn, 0.25);
  Wait(0.3);
}

/// Draws until the pull is felt.
/// \param roll  of the tool about its shaft meanwhile [rad]
void CholecystectomySurgeon::DrawGently(int hand, const Vec3& by, double roll) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kDraw, "draw", 5.0);
  act.hand = hand;
  act.by = by;
  act.amount = roll;
  Wait(0.2);
}

/// Gives way to what it holds until hardly a pull is felt: what is let go under a pull springs back.
void CholecystectomySurgeon::Ease(int hand) {
  Add(SurgeonAct::Kind::kEase, "ease", 3.0).hand = hand;
}

void CholecystectomySurgeon::LetGo(int hand) {
  Ease(hand);
  Jaw(hand, 0.8);
  Reach(hand, Place::BehindTip(hand, 0.025));
  // not closed: that would take what lies there
  Jaw(hand, 0.3);
}

void CholecystectomySurgeon::Burn(int hand, const Place& at, double seconds) {
  Reach(hand, at, 0.5);
  SurgeonAct& act = Add(SurgeonAct::Kind::kBurn, "burn", seconds + 1.0);
  act.hand = hand;
  act.seconds = seconds;
}

/// Washes a place from a little before it, and takes up what has gathered.
void CholecystectomySurgeon::Rinse(const Place& at, double rinse_seconds, double aspirate_seconds) {
  constexpr double kInPool = 0.003;  // [m]
  Place pool = Place::Of(Place::Kind::kPool);
  Reach(kRight, at, 0.5);
  Add(SurgeonAct::Kind::kRinse, "rinse", rinse_seconds + 1.0).seconds = rinse_seconds;
  pool.back = kInPool;
  Reach(kRight, pool, 0.5);
  Add(SurgeonAct::Kind::kAspirate, "aspirate", aspirate_seconds + 1.0).seconds = aspirate_seconds;
}

/// Turns the laparoscope so that it looks at a place from aside: by `turn` about the cystic duct.
void CholecystectomySurgeon::LookAt(const Place& target, double turn, double distance) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kLook, "look", 8.0);
  act.place = target;
  act.amount = turn;
  act.distance = distance;
}

Vec3 CholecystectomySurgeon::Find(const Place& place, const simulation::Snapshot& seen) const {
  const Vec3 p = FindUnhooked(place, seen);
  return place.is_for_hook ? HookTip(p) : p;
}

Vec3 CholecystectomySurgeon::FindUnhooked(const Place& place, const simulation::Snapshot& seen) const {
  const HandMotion& hand = hands_[static_cast<std::size_t>(place.hand)];
  const HandMotion& right = hands_[kRight];
  switch (place.kind) {
    case Place::Kind::kNone:
    case Place::Kind::kPoint:
      return place.p;
    case Place::Kind::kNode: {
      const Vec3& p = seen.positions[place.node];
      return place.back == 0.0 ? p : p + place.back * math::Normalized(hand.Port() - p);
    }
    case Place::Kind::kAboveNode: {
      const Vec3& p = seen.positions[place.node];
      return p + place.back * math::Normalized(0.5 * (hands_[instrument::kLeft].Port() + right.Port()) - p);
    }
    case Place::Kind::kTube:
      return TubePoint(seen, place.tube, place.share);
    case Place::Kind::kAim:
      return Aim(seen, place.tube, place.share, -place.back);
    case Place::Kind::kBetweenJaws: {
      const Vec3 p = LineOf(seen, place.tube).At(place.share);
      return p + beyond_ * place.back * math::Normalized(p - right.Port()) + offset_;
    }
    case Place::Kind::kStrands: {
      Vec3 sum;
      for (const std::uint32_t i : place.strands) sum += seen.positions[known_.strands[i].a];
      return sum / static_cast<double>(place.strands.size());
    }
    case Place::Kind::kGallbladder: {
      const scene::SurfaceInfo& surface = known_.surfaces[static_cast<std::size_t>(known_.gallbladder)];
      Vec3 centre;
      for (std::uint32_t i = 0; i < surface.node_count; ++i)
        centre += seen.positions[surface.first_node + i] / static_cast<double>(surface.node_count);
      return centre;
    }
    case Place::Kind::kBesideHold:
      return WallBesideHold(seen);
    case Place::Kind::kInLiver: {
      const Vec3 p = seen.positions[known_.liver_node];
      const Vec3 in = math::Normalized(p - right.Port());
      return p + 0.006 * in + place.back * math::Normalized(math::Cross(in, {0, 1, 0}));
    }
    case Place::Kind::kRightTip:
      return HookPoint(seen);
    case Place::Kind::kBehindTip:
      return hand.BehindTip(place.back);
    case Place::Kind::kFromTip:
      return hand.Tip() + place.p;
    case Place::Kind::kPool: {
      const Vec3& p = seen.operation.flow.p_world_pool;
      return p + place.back * math::Normalized(hand.Port() - p);
    }
    case Place::Kind::kOverField:
      break;
  }
  const Vec3 field = Find(picture_.field, seen);
  const Vec3 back = math::Normalized(hand.Port() - field);
  constexpr double kWaiting[] = {0.045, 0.038, 0.031, 0.024};  // [m]
  for (const double away : kWaiting) {
    if (IsInView(seen.X_world_laparoscope, kWellInside * scene_->laparoscope.field_of_view,
                 field + away * back))
      return field + away * back;
  }
  return field + kWaiting[3] * back;
}

}  // namespace trocar::agent
