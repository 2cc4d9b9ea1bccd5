// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

constexpr double kStandOff = -0.012;    // of a tool's tip from the vessel while it is lined up [m]
constexpr double kFromTips = 0.0018;    // of a vessel's axis, so that the clip reaches around it [m]
constexpr double kAnother = 0.05;       // of a vessel's length, to another place for a clip
constexpr double kPull = 12.0;          // at which a hand stops to draw [N]
constexpr double kWellInside = 0.85;    // of the picture's width
constexpr double kBetweenLegs = 0.003;  // of a clip applier's middle line, where a vessel is to be [m]

}  // namespace

void CholecystectomySurgeon::Add(std::string doing, std::function<void(const Snapshot&)> begin,
                                 std::function<bool(const Snapshot&)> is_done, double patience) {
  acts_.push_back({std::move(doing), std::move(begin), std::move(is_done), patience});
}

void CholecystectomySurgeon::Decide(std::string doing, std::function<void(const Snapshot&)> plan) {
  Add(
      std::move(doing),
      [this, plan = std::move(plan)](const Snapshot& seen) {
        std::swap(acts_, inserted_);
        plan(seen);
        std::swap(acts_, inserted_);
      },
      [](const Snapshot&) { return true; }, 1.0);
}

void CholecystectomySurgeon::Reach(int hand, Place tip, double hurry) {
  Add(
      "reach", [this, hand, tip, hurry](const Snapshot& seen) { HandOf(hand).MoveTo(tip(seen), hurry); },
      [this, hand](const Snapshot&) { return !HandOf(hand).IsMoving() && !HandOf(hand).IsTurning(); }, 5.0);
}

void CholecystectomySurgeon::Jaw(int hand, double share) {
  Add(
      share > 0.5 ? "open" : "close",
      [this, hand, share](const Snapshot& seen) {
        const auto& tray = scene_->instruments[static_cast<std::size_t>(hand)].tray;
        HandOf(hand).SetJaw(share * tray[seen.operation.tools[static_cast<std::size_t>(hand)]].max_jaw);
      },
      [this](const Snapshot&) { return act_seconds_ > 0.6; }, 2.0);
}

void CholecystectomySurgeon::Wait(double seconds) {
  Add(
      "wait", [](const Snapshot&) {}, [this, seconds](const Snapshot&) { return act_seconds_ >= seconds; },
      seconds + 1.0);
}

void CholecystectomySurgeon::Exchange(int hand, instrument::ToolKind kind, bool over_field) {
  const auto& tray = scene_->instruments[static_cast<std::size_t>(hand)].tray;
  const auto found =
      std::find_if(tray.begin(), tray.end(), [&](const instrument::Tool& tool) { return tool.kind == kind; });
  const auto index = static_cast<std::uint8_t>(found - tray.begin());
  // a tool goes in over the field, in the picture
  if (over_field) {
    Reach(hand, [this, hand](const Snapshot& seen) {
      const Vec3 field = field_(seen);
      const Vec3 back = math::Normalized(HandOf(hand).Port() - field);
      constexpr double kWaiting[] = {0.045, 0.038, 0.031, 0.024};  // [m]
      for (const double away : kWaiting) {
        if (IsInView(seen.X_world_laparoscope, kWellInside * scene_->laparoscope.field_of_view,
                     field + away * back))
          return field + away * back;
      }
      return field + kWaiting[3] * back;
    });
  }
  Add(
      "exchange " + (found != tray.end() ? found->name : std::string("nothing")),
      [this, hand, index](const Snapshot&) { controls_[static_cast<std::size_t>(hand)].tool = index; },
      [hand, index](const Snapshot& seen) {
        return seen.operation.tools[static_cast<std::size_t>(hand)] == index;
      },
      6.0);
  // what comes in comes in closed; an open clip applier that closes would lose its clip
  Jaw(hand, 0.0);
}

void CholecystectomySurgeon::Grasp(int hand, const Place& at, double squeeze) {
  Jaw(hand, 0.8);
  Reach(hand, [this, hand, at](const Snapshot& seen) {
    const Vec3 p = at(seen);
    return p + 0.015 * math::Normalized(HandOf(hand).Port() - p);
  });
  // deep enough that the jaws close over what lies there
  Reach(
      hand,
      [this, hand, at](const Snapshot& seen) {
        const Vec3 p = at(seen);
        return p - 0.005 * math::Normalized(HandOf(hand).Port() - p);
      },
      0.5);
  Jaw(hand, squeeze);
  Wait(0.2);
}

void CholecystectomySurgeon::Draw(int hand, const Vec3& by) {
  Reach(
      hand, [this, hand, by](const Snapshot&) { return HandOf(hand).Tip() + by; }, 0.25);
  Wait(0.3);
}

/// Draws until the pull is felt.
void CholecystectomySurgeon::DrawGently(int hand, const Vec3& by) {
  Add(
      "draw", [this, hand, by](const Snapshot&) { HandOf(hand).MoveTo(HandOf(hand).Tip() + by, 0.25); },
      [this, hand](const Snapshot& seen) {
        const bool is_tight = math::Norm(seen.instruments[static_cast<std::size_t>(hand)].force) > kPull;
        if (is_tight) HandOf(hand).MoveTo(HandOf(hand).Tip());
        return is_tight || !HandOf(hand).IsMoving();
      },
      5.0);
  Wait(0.2);
}

void CholecystectomySurgeon::LetGo(int hand) {
  Jaw(hand, 0.8);
  Reach(hand, [this, hand](const Snapshot&) {
    return HandOf(hand).Tip() + 0.025 * math::Normalized(HandOf(hand).Port() - HandOf(hand).Tip());
  });
  // not closed: that would take what lies there
  Jaw(hand, 0.3);
}

Vec3 CholecystectomySurgeon::Aim(const Snapshot& seen, std::size_t tube, double share, double ahead) const {
  const Vec3 p = TubePoint(seen, tube, share);
  return p + ahead * math::Normalized(p - hands_[kRight].Port());
}

void CholecystectomySurgeon::LineUp(const std::string& what, std::size_t tube, double share, double jaw) {
  Add(
      "line up the " + what,
      [this, tube, share, jaw](const Snapshot& seen) {
        const Vec3 p = TubePoint(seen, tube, share);
        const Vec3 shaft = math::Normalized(p - HandOf(kRight).Port());
        HandOf(kRight).Turn(
            FindSpin(HandOf(kRight).Port(), p, math::Cross(shaft, TubeDirection(seen, tube, share))));
        HandOf(kRight).SetJaw(jaw);
        HandOf(kRight).MoveTo(Aim(seen, tube, share, kStandOff));
      },
      [this](const Snapshot&) { return !HandOf(kRight).IsMoving() && !HandOf(kRight).IsTurning(); }, 5.0);
}

/// \param beyond  how far from the tips, as a share of the jaws, the vessel lies in them
/// \param tries   how often it is lined up anew when the vessel is not between the legs
void CholecystectomySurgeon::PlaceClip(std::size_t tube, double share, double beyond, int tries) {
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  LineUp("clip", tube, share, applier.max_jaw);
  Reach(
      kRight,
      [this, tube, share, ahead = beyond * applier.jaw_length](const Snapshot& seen) {
        return Aim(seen, tube, share, ahead);
      },
      0.4);
  Wait(0.2);
  Add(
      "look at the clip's tips",
      [this, tube, share, beyond, tries, &applier](const Snapshot& seen) {
        const Pose& X = seen.instruments[kRight].X_world_tool;
        const Vec3 in = math::Inverse(X) * TubePoint(seen, tube, share);
        const bool is_between = std::hypot(in.x, in.y) < kBetweenLegs && in.z > kFromTips &&
                                in.z < applier.jaw_length - kFromTips;
        std::swap(acts_, inserted_);
        if (is_between || tries == 0) {
          CloseClip(tube, share);
        } else {
          Reach(kRight,
                [this, tube, share](const Snapshot& now) { return Aim(now, tube, share, kStandOff); });
          // a little farther along, then a little nearer
          PlaceClip(tube, share + (tries % 2 == 0 ? kAnother : -2 * kAnother), beyond, tries - 1);
        }
        std::swap(acts_, inserted_);
      },
      [](const Snapshot&) { return true; }, 1.0);
}

void CholecystectomySurgeon::CloseClip(std::size_t tube, double share) {
  Add(
      "close the clip", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
      [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
  // open enough to leave the clip, not so far that the next one comes
  Jaw(kRight, 0.4);
  Reach(
      kRight, [this, tube, share](const Snapshot& seen) { return Aim(seen, tube, share, -0.020); }, 0.6);
}

void CholecystectomySurgeon::CutTube(std::size_t tube, double share) {
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  LineUp("scissors", tube, share, scissors.max_jaw);
  Reach(
      kRight,
      [this, tube, share, ahead = 0.4 * scissors.jaw_length](const Snapshot& seen) {
        return Aim(seen, tube, share, ahead);
      },
      0.4);
  Add(
      "cut", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
      [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
  Reach(
      kRight, [this, tube, share](const Snapshot& seen) { return Aim(seen, tube, share, -0.020); }, 0.6);
}

void CholecystectomySurgeon::Burn(int hand, const Place& at, double seconds) {
  Reach(hand, at, 0.5);
  Add(
      "burn", [this, hand](const Snapshot&) { controls_[static_cast<std::size_t>(hand)].coagulate = true; },
      [this, hand, seconds](const Snapshot&) {
        if (act_seconds_ < seconds) return false;
        controls_[static_cast<std::size_t>(hand)].coagulate = false;
        return true;
      },
      seconds + 1.0);
}

/// Turns the laparoscope so that it looks at a place from aside: by `turn` about the cystic duct.
void CholecystectomySurgeon::LookAt(Place target, double turn, double distance) {
  Add(
      "look",
      [this, target, turn, distance](const Snapshot& seen) {
        const std::size_t duct = FindTube("cystic_duct");
        field_ = target;
        const Vec3 p = target(seen);
        const Vec3 to_eye = math::Normalized(scene_->laparoscope.p_world_port - p);
        ViewWish wish;
        wish.p_world = p;
        wish.distance = distance;
        wish.facing = math::Rotate(math::RotationAbout(TubeDirection(seen, duct, 0.5), turn), to_eye);
        if (const auto view = FindView(scene_->laparoscope, wish)) camera_to_ = *view;
      },
      [this](const Snapshot&) { return camera_ == camera_to_; }, 8.0);
}

}  // namespace trocar::session
