// SPDX-License-Identifier: Apache-2.0
// Clips and cuts: each is planned from what lies there now, looked at before it is closed, and done anew where it failed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "trocar/collision/segment_distance.h"

namespace trocar::session {
namespace {

using instrument::ToolKind;

constexpr int kRounds = 3;               // with another hold each
constexpr int kMostActs = 16;            // clips, cuts and vain tries at one time
constexpr int kTries = 4;                // to bring a vessel between the legs
constexpr double kStandOff = 0.012;      // of a tool's tip from the vessel while it is lined up [m]
constexpr double kWithdrawn = 0.020;     // [m]
constexpr double kFromTips = 0.0004;     // of a flattened vessel's edge from the ends of the legs [m]
constexpr double kBetweenLegs = 0.0012;  // of a vessel's axis from the legs' middle line [m]
constexpr double kBurnClear = 0.008;     // of an electrode from what must stay [m]
constexpr double kBurnSeconds = 1.2;     // that shut a small vessel [s]
constexpr double kMostOff = 0.004;       // by which a hand aims beside what it wants to meet [m]

}  // namespace

/// Divides tubes; where nothing more fits, the gallbladder is held and drawn otherwise, and tools may come nearer to the rest.
void CholecystectomySurgeon::Divide(std::vector<std::size_t> tubes, int rounds) {
  Decide("plan the clips", [this, tubes = std::move(tubes), rounds](const Snapshot& seen) {
    auto work = std::make_shared<Division>();
    for (const std::size_t tube : tubes) {
      if (!IsDivided(seen, tube)) work->tubes.push_back(tube);
    }
    if (work->tubes.empty() || rounds <= 0) return;
    if (rounds < kRounds) {
      const Vec3 aside = math::Normalized(math::Cross(bed_normal_, rest_[fundus_] - rest_[neck_]));
      HoldOn([this](const Snapshot& now) { return now.positions[neck_]; });
      DrawGently(kLeft, 0.008 * bed_normal_ + (rounds % 2 == 0 ? 0.012 : -0.012) * aside);
    }
    work->avoid.resize(work->tubes.size());
    work->acts_left = kMostActs;
    work->care = rounds == kRounds ? 1.0 : rounds == kRounds - 1 ? 0.7 : 0.4;
    Decide("plan the clips", [this, work](const Snapshot& now) { GoOnDividing(work, now); });
    Divide(tubes, rounds - 1);
  });
}

/// Every clip first, then the cuts: each tool is taken once.
void CholecystectomySurgeon::GoOnDividing(const std::shared_ptr<Division>& work, const Snapshot& seen) {
  if (work->acts_left-- <= 0) return;
  const std::vector<TubeLine> lines = LinesOf(seen);
  const auto next = [&](std::size_t which) {
    const std::size_t tube = work->tubes[which];
    if (IsDivided(seen, tube)) return DivisionStep{};
    return FindNextStep(FieldOf(seen, tube, lines, work->care), ClipsOn(seen, tube), work->avoid[which]);
  };
  std::vector<DivisionStep> steps;
  for (std::size_t which = 0; which < work->tubes.size(); ++which) steps.push_back(next(which));
  for (const auto kind : {DivisionStep::Kind::kClip, DivisionStep::Kind::kCut}) {
    for (std::size_t which = 0; which < steps.size(); ++which) {
      if (steps[which].kind != kind) continue;
      if (kind == DivisionStep::Kind::kClip) {
        ClipAt(work, which, steps[which].arc);
      } else {
        CutAt(work, which, steps[which].arc);
      }
      Decide("plan the clips", [this, work](const Snapshot& now) { GoOnDividing(work, now); });
      return;
    }
  }
}

void CholecystectomySurgeon::ClipAt(const std::shared_ptr<Division>& work, std::size_t which, double arc) {
  const std::size_t tube = work->tubes[which];
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  Take(ToolKind::kClipApplier);
  Add(
      "line up the clip",
      [this, work, tube, arc, &applier](const Snapshot& seen) {
        offset_ = {};
        const std::vector<TubeLine> lines = LinesOf(seen);
        const TubeLine& line = lines[tube];
        beyond_ = FindClip(FieldOf(seen, tube, lines, work->care), arc).value_or(0.5);
        const Vec3 p = line.At(arc), in = math::Normalized(p - HandOf(kRight).Port());
        HandOf(kRight).Turn(FindSpin(HandOf(kRight).Port(), p, math::Cross(in, line.DirectionAt(arc))));
        HandOf(kRight).SetJaw(applier.max_jaw);
        HandOf(kRight).MoveTo(p - kStandOff * in);
      },
      [this](const Snapshot&) { return !HandOf(kRight).IsMoving() && !HandOf(kRight).IsTurning(); }, 5.0);
  CloseWhenBetween(work, which, arc, kTries);
}

/// Brings the vessel between the legs, looks, and closes the clip or aims anew.
void CholecystectomySurgeon::CloseWhenBetween(const std::shared_ptr<Division>& work, std::size_t which,
                                              double arc, int tries) {
  const std::size_t tube = work->tubes[which];
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  const double length = applier.jaw_length;
  const Place aim = [this, tube, arc, length](const Snapshot& seen) {
    const Vec3 p = LineOf(seen, tube).At(arc);
    return p + beyond_ * length * math::Normalized(p - HandOf(kRight).Port()) + offset_;
  };
  Reach(kRight, aim, 0.4);
  Wait(0.2);
  Decide("look at the clip's tips", [=, this](const Snapshot& seen) {
    const Pose& X = seen.instruments[kRight].X_world_tool;
    const collision::Segment legs{X.translation, X * Vec3{0, 0, length}};
    const std::vector<TubeLine> lines = LinesOf(seen);
    const TubeLine::Near near = lines[tube].FindNearest(legs);
    const Vec3 in = math::Inverse(X) * lines[tube].At(near.arc);
    // closed, it is half its girth wide
    const double half = 0.5 * M_PI * lines[tube].RadiusAt(near.arc) + kFromTips;
    bool is_good = near.distance < kBetweenLegs && in.z > half && in.z < length - half;
    for (std::size_t other = 0; other < lines.size(); ++other) {
      if (work->care < 1.0 && IsDivided(seen, other)) continue;
      if (other != tube &&
          lines[other].FindNearest(legs).distance < near.distance + work->care * kBetweenLegs)
        is_good = false;
    }
    for (const double clip : ClipsOn(seen, tube))
      if (std::fabs(clip - near.arc) < kLeastGap) is_good = false;
    if (is_good) {
      Add(
          "close the clip", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
          [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
      // open enough to leave the clip, not so far that the next one comes
      Jaw(kRight, 0.4);
    } else if (tries > 0) {
      const Vec3 middle = X * Vec3{0, 0, beyond_ * length};
      const Vec3 off = offset_ + lines[tube].At(arc) - middle;
      offset_ = math::Norm(off) > kMostOff ? kMostOff * math::Normalized(off) : off;
      CloseWhenBetween(work, which, arc, tries - 1);
      return;
    } else {
      work->avoid[which].push_back(arc);
    }
    Withdraw();
  });
}

void CholecystectomySurgeon::CutAt(const std::shared_ptr<Division>& work, std::size_t which, double arc) {
  const std::size_t tube = work->tubes[which];
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  Take(ToolKind::kScissors);
  const Place aim = [this, tube, arc, &scissors](const Snapshot& seen) {
    const Vec3 p = LineOf(seen, tube).At(arc);
    return p + beyond_ * scissors.jaw_length * math::Normalized(p - HandOf(kRight).Port()) + offset_;
  };
  Add(
      "line up the scissors",
      [this, work, tube, arc](const Snapshot& seen) {
        offset_ = {};
        const std::vector<TubeLine> lines = LinesOf(seen);
        const auto pose = FindCut(FieldOf(seen, tube, lines, work->care), arc);
        if (!pose) return;
        beyond_ = pose->beyond;
        const Vec3 p = lines[tube].At(arc);
        HandOf(kRight).Turn(pose->spin);
        HandOf(kRight).SetJaw(pose->jaw);
        HandOf(kRight).MoveTo(p - kStandOff * math::Normalized(p - HandOf(kRight).Port()));
      },
      [this](const Snapshot&) { return !HandOf(kRight).IsMoving() && !HandOf(kRight).IsTurning(); }, 5.0);
  for (int round = 0; round < 2; ++round) {
    Reach(kRight, aim, 0.4);
    Wait(0.15);
    // the tool may have been pushed aside
    Decide("look at the blades", [=, this, &scissors](const Snapshot& seen) {
      const Pose& X = seen.instruments[kRight].X_world_tool;
      const Vec3 off = offset_ + LineOf(seen, tube).At(arc) - X * Vec3{0, 0, beyond_ * scissors.jaw_length};
      offset_ = math::Norm(off) > kMostOff ? kMostOff * math::Normalized(off) : off;
    });
  }
  Decide("look before the cut", [=, this](const Snapshot& seen) {
    // between the clips, and with no other vessel between the blades
    const std::vector<TubeLine> lines = LinesOf(seen);
    const auto clips = ClipsOn(seen, tube);
    const Pose& X = seen.instruments[kRight].X_world_tool;
    const double length = instrument::FindTool("scissors")->jaw_length;
    const double here =
        lines[tube].FindNearest(collision::Segment{X.translation, X * Vec3{0, 0, length}}).arc;
    const auto distal = std::count_if(clips.begin(), clips.end(), [&](double clip) { return clip < here; });
    const bool is_safe = distal >= 1 && static_cast<std::ptrdiff_t>(clips.size()) - distal >= 2;
    if (is_safe) {
      Add(
          "cut", [this](const Snapshot&) { HandOf(kRight).SetJaw(0.0); },
          [this](const Snapshot&) { return act_seconds_ > 0.7; }, 2.0);
    }
    Withdraw();
    Decide("look at the cut", [=, this](const Snapshot& now) {
      if (!IsDivided(now, tube)) work->avoid[which].push_back(arc);
    });
  });
}

/// A small vessel that still bleeds is shut by heat, where nothing that must stay is near.
void CholecystectomySurgeon::StopBleeding(int rounds) {
  Decide("look for blood", [this, rounds](const Snapshot& seen) {
    if (rounds <= 0) return;
    const auto& leaks = seen.operation.leaks;
    const auto end = leaks.begin() + static_cast<std::ptrdiff_t>(seen.operation.leak_count);
    const auto leak = std::find_if(leaks.begin(), end, [&](const LeakSnapshot& found) {
      const bool is_near_main = std::any_of(main_nodes_.begin(), main_nodes_.end(), [&](std::uint32_t node) {
        return math::Distance(seen.positions[node], found.position) < kBurnClear;
      });
      return found.fluid == surgery::Fluid::kBlood && !is_near_main;
    });
    if (leak == end) return;
    Take(ToolKind::kHook);
    Decide("coagulate", [this, p = leak->position](const Snapshot&) {
      Burn(
          kRight, [this, p](const Snapshot&) { return HookTip(p); }, kBurnSeconds);
      Withdraw();
    });
    StopBleeding(rounds - 1);
  });
}

void CholecystectomySurgeon::Withdraw() {
  Reach(
      kRight, [this](const Snapshot&) { return HandOf(kRight).BehindTip(kWithdrawn); }, 0.6);
}

void CholecystectomySurgeon::Take(instrument::ToolKind kind) {
  Decide("take a tool", [this, kind](const Snapshot& seen) {
    if (scene_->instruments[kRight].tray[seen.operation.tools[kRight]].kind != kind) Exchange(kRight, kind);
  });
}

}  // namespace trocar::session
