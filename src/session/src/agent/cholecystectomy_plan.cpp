// SPDX-License-Identifier: Apache-2.0
// The operation, part by part; each part looks at what has come of it and goes on until it is enough.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::session {
namespace {

using instrument::ToolKind;

constexpr double kCleared = 0.91;     // of the triangle: a little more than the view asks
constexpr double kLowerShare = 0.44;  // of the bed that is freed before the view [-]
constexpr int kRounds = 4, kBedRounds = 12;
constexpr double kPedicleWeight = 3.0;  // of fibres on the cystic duct and artery, among others
constexpr double kGrip = 0.07;          // of the jaws: 14 N of pinch
constexpr double kTurnStep = 0.2;       // of the lens about the duct, to either side in turn [rad]
constexpr int kTurnSteps = 26;
constexpr double kTilts[] = {0.0, 0.5, -0.5};           // of the lens along the duct [rad]
constexpr double kAside = 0.4;                          // of a view from the front of the neck [rad]
constexpr double kDistances[] = {0.060, 0.072, 0.050};  // of the lens from the duct [m]
constexpr double kSkin = 0.004;      // sight ends at the skin of a duct, not at its axis [m]
constexpr double kNeckStep = 0.008;  // of the hold about the duct, to show the other side of the neck [m]
constexpr int kNeckTurns = 7;
constexpr double kPeelShare = 0.2;  // of the bed's fibres that are left: where the gallbladder peels off [-]
/// Of the hold from there, along what is free [m]; how far it is folded back at first [m], and how steeply [-].
constexpr double kLeastFlap = 0.012, kMostFlap = 0.035, kFold = 0.030, kFoldUp = 0.6;
constexpr double kOutOfTheWay = 0.080;   // of a tool that waits while the bag leaves [m]
constexpr double kInfundibulum = 0.012;  // of the gallbladder, from the neck on [m]
constexpr double kBedStep = 0.2;         // of the bed's fibres, after which the hold is chosen anew [-]

}  // namespace

void CholecystectomySurgeon::PlanOperation() {
  FreeGallbladder();
  Remove();
}

/// From the first look until the gallbladder hangs on nothing.
void CholecystectomySurgeon::FreeGallbladder() {
  const Place neck = [this](const Snapshot& seen) { return seen.positions[neck_]; };
  camera_follows_ = true;
  Add(
      "assistant: retract", [this](const Snapshot&) { assistant_ = AssistantCommand::kRetract; },
      [](const Snapshot& seen) {
        return seen.operation.is_assistant_holding || !seen.operation.has_assistant;
      },
      8.0);
  LookAt(neck, 0.0, 0.090);
  HoldOn(neck);
  const std::size_t duct = FindTube("cystic_duct");
  const Vec3 duct_way = math::Normalized(rest_[tube_nodes_[duct].front()] - rest_[tube_nodes_[duct].back()]);
  DrawGently(kLeft, 0.006 * duct_way + 0.003 * bed_normal_);
  ClearTriangle(kRounds);
  FreeLowerThird(kRounds);
  ShowCriticalView(kRounds);
  // without the view nothing is clipped; a gallbladder that is still tied is not taken off its bed
  Decide("time-out", [this](const Snapshot&) { stops_ = !has_view_; });
  Divide(entering_);
  StopBleeding();
  Decide("look at the stumps", [this](const Snapshot& seen) {
    stops_ = !std::all_of(entering_.begin(), entering_.end(),
                          [&](std::size_t tube) { return IsDivided(seen, tube); });
  });
  FreeFromBed(kBedRounds);
}

/// Takes the gallbladder with the left hand, clear of the liver, and again elsewhere when nothing was taken.
void CholecystectomySurgeon::HoldOn(const Place& near, int tries, const Nodes& may) {
  Decide("choose a hold", [this, near, tries, may](const Snapshot& seen) {
    if (tries <= 0) return;
    if (seen.instruments[kLeft].is_grasping) LetGo(kLeft);
    Decide("choose a hold", [this, near, tries, may](const Snapshot& now) {
      const std::uint32_t node = FindHold(now, near(now), missed_holds_, may);
      Grasp(
          kLeft, [node](const Snapshot& then) { return then.positions[node]; }, kGrip);
      Decide("look at the hold", [this, near, tries, may, node](const Snapshot& then) {
        const InstrumentSnapshot& hand = then.instruments[kLeft];
        if (hand.is_grasping && hand.organ == scene_->patient.FindOrgan("gallbladder")) return;
        missed_holds_.push_back(node);
        LetGo(kLeft);
        HoldOn(near, tries - 1, may);
      });
    });
  });
}

/// The hepatocystic triangle: bluntly, beside ducts too; what is left elsewhere, with the hook.
void CholecystectomySurgeon::ClearTriangle(int rounds) {
  Decide("look at the triangle", [this, rounds](const Snapshot& seen) {
    std::vector<std::uint32_t> fat = TriangleStrands();
    std::vector<std::uint32_t> covering;
    if (!AreTubesBare(seen)) covering = CoveringStrands();
    const bool is_clear = seen.operation.facts.cleared_share >= kCleared && covering.empty();
    if (is_clear || rounds <= 0) return;
    auto spread = std::make_shared<Spreading>();
    spread->what = "the hepatocystic triangle";
    spread->strands = covering;
    spread->weights.assign(covering.size(), kPedicleWeight);
    for (const std::uint32_t i : fat) {
      if (std::find(covering.begin(), covering.end(), i) != covering.end()) continue;
      spread->strands.push_back(i);
      spread->weights.push_back(1.0);
    }
    const auto is_enough = [this](const Snapshot& now) {
      return now.operation.facts.cleared_share >= kCleared && AreTubesBare(now);
    };
    spread->is_enough = is_enough;
    Take(ToolKind::kDissector);
    Spread(std::move(spread));
    Decide("look at the triangle", [this, rounds, fat = std::move(fat), is_enough](const Snapshot& now) {
      if (!is_enough(now)) {
        std::vector<std::uint32_t> left = fat;
        if (!AreTubesBare(now)) {
          const std::vector<std::uint32_t> over = CoveringStrands();
          left.insert(left.end(), over.begin(), over.end());
        }
        std::vector<double> order;
        // the front first
        for (const std::uint32_t i : left)
          order.push_back(-0.25 * (rest_[strands_[i].a] + rest_[strands_[i].b]).z);
        Take(ToolKind::kHook);
        Dissect({"the hepatocystic triangle", left, order, 1.0, is_enough});
      }
      ClearTriangle(rounds - 1);
    });
  });
}

void CholecystectomySurgeon::FreeLowerThird(int rounds) {
  Decide("look at the bed", [this, rounds](const Snapshot& seen) {
    const auto is_enough = [](const Snapshot& now) { return now.operation.critical_view.criteria[1] == 2; };
    const std::vector<std::uint32_t> lower = BedStrands(kLowerShare);
    if (is_enough(seen) || ShareLeft(seen, lower) == 0.0 || rounds <= 0) return;
    const Vec3 axis = math::Normalized(rest_[fundus_] - rest_[neck_]);
    std::vector<double> order;
    for (const std::uint32_t i : lower)
      order.push_back(0.5 * math::Dot(rest_[strands_[i].a] - rest_[neck_], axis));
    const Place peel = MiddleOf(PeelStrands(seen, lower));
    // by the infundibulum, which is drawn off the liver, to the sides and back over what is not free
    const Nodes is_infundibulum = [this, axis](std::uint32_t node) {
      return math::Dot(rest_[node] - rest_[neck_], axis) < kInfundibulum;
    };
    const Vec3 back = math::Normalized(axis - math::Dot(axis, bed_normal_) * bed_normal_);
    const Vec3 way = math::Normalized(bed_normal_ + back);
    Take(ToolKind::kHook);
    HoldOn(peel, kHoldTries, is_infundibulum);
    DrawGently(kLeft, 0.010 * way);
    Dissect({"the lower third of the bed", lower, order, 0.97, is_enough, 0.028, way});
    FreeLowerThird(rounds - 1);
  });
}

/// Both views; where something is missing, back to it first. A second cystic artery is divided before: only two structures
/// may be left.
void CholecystectomySurgeon::ShowCriticalView(int rounds) {
  Decide("look for what is missing", [this, rounds](const Snapshot& seen) {
    if (seen.operation.critical_view.IsAchieved() || rounds <= 0) return;
    ClearTriangle(2);
    FreeLowerThird(2);
    Decide("count what enters", [this](const Snapshot& now) {
      if (const auto extra = FindExtraArtery(now)) Divide({*extra});
    });
    Reach(kRight, [this](const Snapshot& now) {
      const Vec3 field = now.positions[neck_];
      return field + 0.05 * math::Normalized(HandOf(kRight).Port() - field);
    });
    Decide("look", [this](const Snapshot&) { camera_follows_ = false; });
    for (const int side : {+1, -1}) LookFromSide(side, kNeckTurns);
    LookAt([this](const Snapshot& now) { return TubePoint(now, FindTube("cystic_duct"), 0.4); }, 0.0, 0.080);
    Decide("look", [this](const Snapshot&) { camera_follows_ = true; });
    ShowCriticalView(rounds - 1);
  });
}

/// Where more than two structures enter, an artery that can be divided.
std::optional<std::size_t> CholecystectomySurgeon::FindExtraArtery(const Snapshot& seen) {
  std::vector<std::size_t> arteries;
  for (const std::size_t tube : entering_) {
    const bool is_artery = scene_->patient.tubes[tube].kind == anatomy::TubeKind::kArtery;
    if (is_artery && !IsDivided(seen, tube)) arteries.push_back(tube);
  }
  if (arteries.size() < 2) return std::nullopt;
  const std::vector<TubeLine> lines = LinesOf(seen);
  for (const double care : {1.0, 0.7, 0.4}) {
    for (const std::size_t tube : arteries) {
      const auto step = FindNextStep(FieldOf(seen, tube, lines, care), ClipsOn(seen, tube), {});
      if (step.kind != DivisionStep::Kind::kNone) return tube;
    }
  }
  return arteries.back();
}

/// A pose of the laparoscope that shows the triangle from one side of its front, with nothing before it.
std::optional<instrument::TrocarJoints> CholecystectomySurgeon::FindSideView(const Snapshot& seen, int side) {
  const std::size_t duct = FindTube("cystic_duct"), hepatic = FindTube("common_hepatic_duct");
  const std::array<Vec3, 3> points = {TubePoint(seen, duct, 0.3), TubePoint(seen, duct, 0.7),
                                      0.5 * (TubePoint(seen, duct, 0.5) + TubePoint(seen, hepatic, 0.5))};
  const Vec3 middle = (points[0] + points[1] + points[2]) * (1.0 / 3.0);
  const Vec3 to_eye = math::Normalized(scene_->laparoscope.p_world_port - middle);
  const Vec3 along = TubeDirection(seen, duct, 0.5);
  const Vec3 across = math::Normalized(math::Cross(along, to_eye), {1, 0, 0});
  for (int step = 0; step < kTurnSteps; ++step) {
    const double turn = (step % 2 == 0 ? 1 : -1) * kTurnStep * (1 + step / 2);
    for (const double tilt : kTilts) {
      const math::Quaternion turned = math::RotationAbout(along, turn) * math::RotationAbout(across, tilt);
      for (const double distance : kDistances) {
        ViewWish wish;
        wish.p_world = middle;
        wish.distance = distance;
        wish.facing = math::Rotate(turned, to_eye);
        const auto found = FindView(scene_->laparoscope, wish);
        if (!found) continue;
        const Pose X = CalcLaparoscopePose(scene_->laparoscope, *found);
        if (side * CalcAzimuth(seen, X.translation) < kAside) continue;
        const bool shows_all = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
          const Vec3 end = p + kSkin * math::Normalized(X.translation - p);
          return IsInView(X, scene_->laparoscope.field_of_view, p) &&
                 Clearance(seen, {X.translation, end}) > 0.0002;
        });
        if (shows_all) return found;
      }
    }
  }
  return std::nullopt;
}

/// Looks at the triangle from one side of its front; where the picture does not get there, the left hand turns the
/// neck towards it, farther with each try.
void CholecystectomySurgeon::LookFromSide(int side, int tries) {
  Decide("look from aside", [this, side, tries](const Snapshot& seen) {
    const auto& score = seen.operation.critical_view;
    if (score.IsAchieved() || score.Sum() < 6) return;
    const auto view = FindSideView(seen, side);
    if (view) {
      Add(
          "look from aside", [this, to = *view](const Snapshot&) { camera_to_ = to; },
          [this](const Snapshot&) { return camera_ == camera_to_; }, 8.0);
      Wait(1.3);
      return;
    }
    if (tries <= 0 || !seen.instruments[kLeft].is_grasping) return;
    const std::size_t duct = FindTube("cystic_duct");
    const Vec3 axis = math::Normalized(TubePoint(seen, duct, 0.0) - TubePoint(seen, duct, 1.0));
    const Vec3 arm = HandOf(kLeft).Tip() - TubePoint(seen, duct, 0.0);
    const Vec3 off_axis = math::Normalized(arm - math::Dot(arm, axis) * axis, bed_normal_);
    DrawGently(kLeft, -side * kNeckStep * math::Cross(axis, off_axis));
    LookFromSide(side, tries - 1);
  });
}

/// The first fibres of those that are left, from the neck on: there the gallbladder peels off. At least one.
/// \pre one is left
std::vector<std::uint32_t> CholecystectomySurgeon::PeelStrands(const Snapshot& seen,
                                                               const std::vector<std::uint32_t>& bed) const {
  const Vec3 axis = math::Normalized(rest_[fundus_] - rest_[neck_]);
  std::vector<std::pair<double, std::uint32_t>> along;
  for (const std::uint32_t i : bed) {
    if (seen.operation.strand_is_intact[i])
      along.emplace_back(math::Dot(rest_[strands_[i].a] - rest_[neck_], axis), i);
  }
  std::sort(along.begin(), along.end());
  along.resize(std::max<std::size_t>(1, static_cast<std::size_t>(kPeelShare * along.size())));
  std::vector<std::uint32_t> peel;
  for (const auto& [place, strand] : along) peel.push_back(strand);
  return peel;
}

/// The middle of the gallbladder's ends of fibres.
CholecystectomySurgeon::Place CholecystectomySurgeon::MiddleOf(std::vector<std::uint32_t> strands) const {
  return [this, strands = std::move(strands)](const Snapshot& now) {
    Vec3 sum;
    for (const std::uint32_t i : strands) sum += now.positions[strands_[i].a];
    return sum / static_cast<double>(strands.size());
  };
}

/// The gallbladder off its bed: holds change, because the old one may have slipped and what is free is drawn elsewhere.
void CholecystectomySurgeon::FreeFromBed(int rounds) {
  Decide("look at the bed", [this, rounds](const Snapshot& seen) {
    const std::vector<std::uint32_t> bed = BedStrands(1.0);
    if (ShareLeft(seen, bed) == 0.0 || rounds <= 0) return;
    const Vec3 axis = math::Normalized(rest_[fundus_] - rest_[neck_]);
    std::vector<double> order;
    for (const std::uint32_t i : bed)
      order.push_back(0.5 * math::Dot(rest_[strands_[i].a] - rest_[neck_], axis));
    const std::vector<std::uint32_t> peel = PeelStrands(seen, bed);
    const Place left = MiddleOf(peel);
    // what is free is folded back over what is not: there the fibres lie open
    const double peels = math::Dot(rest_[strands_[peel[peel.size() / 2]].a] - rest_[neck_], axis);
    const Nodes is_free = [this, axis, peels](std::uint32_t node) {
      const double before = peels - math::Dot(rest_[node] - rest_[neck_], axis);
      return before > kLeastFlap && before < kMostFlap;
    };
    const Vec3 back = math::Normalized(axis - math::Dot(axis, bed_normal_) * bed_normal_);
    const Vec3 fold = math::Normalized(kFoldUp * bed_normal_ + back);
    Take(ToolKind::kHook);
    LookAt(left, 0.0, 0.100);
    HoldOn(left, kHoldTries, is_free);
    DrawGently(kLeft, kFold * fold);
    const auto is_step = [this, bed, before = ShareLeft(seen, bed)](const Snapshot& now) {
      return ShareLeft(now, bed) < before - kBedStep;
    };
    Dissect({"the gallbladder from its bed", bed, order, 1.0, is_step, 0.070, fold, is_free});
    FreeFromBed(rounds - 1);
  });
}

void CholecystectomySurgeon::Remove() {
  Add(
      "assistant: release", [this](const Snapshot&) { assistant_ = AssistantCommand::kRelease; },
      [](const Snapshot& seen) { return !seen.operation.is_assistant_holding; }, 4.0);
  DrawGently(kLeft, 0.03 * bed_normal_);
  const Place middle = [this](const Snapshot& seen) {
    const SurfaceInfo& surface =
        surfaces_[static_cast<std::size_t>(scene_->patient.FindOrgan("gallbladder"))];
    Vec3 centre;
    for (std::uint32_t i = 0; i < surface.node_count; ++i)
      centre += seen.positions[surface.first_node + i] / static_cast<double>(surface.node_count);
    return centre;
  };
  LookAt(middle, 0.0, 0.100);
  Exchange(kRight, ToolKind::kBag);
  Reach(kRight, middle);
  Add(
      "close the bag", [](const Snapshot&) {}, [](const Snapshot& seen) { return seen.operation.is_in_bag; },
      4.0);
  LetGo(kLeft);
  // the bag goes by where the left hand's tool lies
  Reach(kLeft, [this](const Snapshot&) { return HandOf(kLeft).BehindTip(kOutOfTheWay); });
  Exchange(kRight, ToolKind::kHook);
  // Exchange ends with the bag outside
  acts_.pop_back();
  acts_.back().is_done = [](const Snapshot& seen) { return seen.operation.is_completed; };
}

}  // namespace trocar::session
