// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

constexpr double kPull = 12.0;        // at which a hand stops to draw [N]
constexpr double kNoPull = 0.8;       // [N]
constexpr double kEaseStep = 0.003;   // [m]
constexpr double kWellInside = 0.85;  // of the picture's width

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

/// Gives way to what it holds until hardly a pull is felt: what is let go under a pull springs back.
void CholecystectomySurgeon::Ease(int hand) {
  Add(
      "ease", [](const Snapshot&) {},
      [this, hand](const Snapshot& seen) {
        const Vec3& force = seen.instruments[static_cast<std::size_t>(hand)].force;
        if (math::Norm(force) < kNoPull) return true;
        if (!HandOf(hand).IsMoving())
          HandOf(hand).MoveTo(HandOf(hand).Tip() + kEaseStep * math::Normalized(force), 0.5);
        return false;
      },
      3.0);
}

void CholecystectomySurgeon::LetGo(int hand) {
  Ease(hand);
  Jaw(hand, 0.8);
  Reach(hand, [this, hand](const Snapshot&) { return HandOf(hand).BehindTip(0.025); });
  // not closed: that would take what lies there
  Jaw(hand, 0.3);
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
        AimCamera(p, math::Rotate(math::RotationAbout(TubeDirection(seen, duct, 0.5), turn), to_eye),
                  distance);
      },
      [this](const Snapshot&) { return camera_ == camera_to_; }, 8.0);
}

}  // namespace trocar::session
