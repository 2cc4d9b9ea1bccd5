// SPDX-License-Identifier: Apache-2.0
#include "cholecystectomy_surgeon.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "operation.h"

namespace trocar::session {
namespace {

constexpr double kHurriedHook = 1.0;
constexpr double kNear = 0.0025;   // the tip has come to where the hand wants it [m]
constexpr double kPatience = 1.2;  // for one fibre [s]
constexpr std::uint8_t kMostAttempts = 3;
constexpr double kMainDistance = 0.009;  // from ducts that must stay, where no fibre is burnt [m]
/// Where the left hand holds the gallbladder: from the neck towards the fundus, and off the bed [m].
constexpr double kHoldBack = 0.020, kHoldBeside = 0.012;
constexpr double kStandOff = -0.012;    // of a tool's tip from the vessel while it is lined up [m]
constexpr double kFromTips = 0.0018;    // of a vessel's axis, so that the clip reaches around it [m]
constexpr double kAnother = 0.05;       // of a vessel's length, to another place for a clip
constexpr double kBetweenLegs = 0.003;  // of a clip applier's middle line, where a vessel is to be [m]
constexpr double kOpenShare = 6.0;      // how much sooner a fibre is taken that is stretched, by its stretch
constexpr double kPeelRate = 0.0012;    // of the hand that draws the gallbladder off its bed [m/s]
constexpr double kBlocked = 0.7;        // after which a hook that does not get there turns back [s]
constexpr double kCameraRate = 0.25;    // [rad/s]

Vec3 MeanPort(const Scene& scene) {
  return 0.5 * (scene.instruments[kLeft].p_world_port + scene.instruments[kRight].p_world_port);
}

HandMotion MakeHand(const Scene& scene, int hand, const HandSkill& skill, std::uint64_t seed) {
  const InstrumentSetup& setup = scene.instruments[static_cast<std::size_t>(hand)];
  return {setup.p_world_port, setup.home, skill, seed + static_cast<std::uint64_t>(hand)};
}

}  // namespace

bool IsCholecystectomy(const Scene& scene) {
  return scene.operation.has_value() && scene.patient.FindOrgan("gallbladder") >= 0 &&
         scene.patient.FindOrgan("liver") >= 0;
}

CholecystectomySurgeon::CholecystectomySurgeon(std::shared_ptr<const Scene> scene, const SurgeonSkill& skill,
                                               OperationFlaw flaw, std::uint64_t seed)
    : scene_(std::move(scene)),
      skill_(skill),
      hands_{MakeHand(*scene_, kLeft, skill.hand, seed), MakeHand(*scene_, kRight, skill.hand, seed)},
      camera_(scene_->laparoscope.home),
      camera_to_(scene_->laparoscope.home) {
  Learn();
  if (flaw == OperationFlaw::kNone) {
    PlanOperation();
  } else {
    PlanFlaw(flaw);
  }
}

void CholecystectomySurgeon::Learn() {
  const anatomy::Patient& patient = scene_->patient;
  auto tissue = MakePatientTissue(*scene_, Operation::kSpare);
  if (!tissue.ok()) {
    has_finished_ = true;
    return;
  }
  strands_ = std::move(tissue->strands);
  surfaces_ = std::move(tissue->surfaces);
  rest_ = std::move(tissue->definition.rest);
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = surfaces_[patient.organs.size() + t];
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t k = 0; k < surface.node_count; ++k) nodes.push_back(surface.first_node + k);
    if (patient.tubes[t].to == "gallbladder") std::reverse(nodes.begin(), nodes.end());
    tube_nodes_.push_back(std::move(nodes));
  }
  const int gallbladder = patient.FindOrgan("gallbladder"), liver = patient.FindOrgan("liver");
  const auto landmark = [&](const char* name) {
    const anatomy::Landmark* found = patient.FindLandmark(name);
    return found != nullptr ? found->position : Vec3{};
  };
  neck_ = FindNode(gallbladder, landmark("infundibulum"));
  fundus_ = FindNode(gallbladder, landmark("fundus"));
  liver_node_ = FindNode(liver, landmark("liver_edge"));
  for (const StrandInfo& strand : strands_) {
    if (strand.kind == StrandInfo::Kind::kBed) bed_normal_ += rest_[strand.a] - rest_[strand.b];
  }
  bed_normal_ = math::Normalized(bed_normal_, {0, -1, 0});
  // beside the neck, so that both tools have room
  const Vec3 axis = math::Normalized(landmark("fundus") - landmark("infundibulum"));
  hold_ = FindNode(gallbladder, landmark("infundibulum") + kHoldBack * axis + kHoldBeside * bed_normal_);
}

std::uint32_t CholecystectomySurgeon::FindNode(std::int32_t organ, const Vec3& p) const {
  const SurfaceInfo& surface = surfaces_[static_cast<std::size_t>(organ)];
  std::uint32_t nearest = surface.first_node;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    const std::uint32_t node = surface.first_node + i;
    if (math::SquaredDistance(rest_[node], p) < math::SquaredDistance(rest_[nearest], p)) nearest = node;
  }
  return nearest;
}

std::size_t CholecystectomySurgeon::FindTube(std::string_view name) const {
  const auto& tubes = scene_->patient.tubes;
  const auto found =
      std::find_if(tubes.begin(), tubes.end(), [&](const anatomy::Tube& tube) { return tube.name == name; });
  return found == tubes.end() ? 0 : static_cast<std::size_t>(found - tubes.begin());
}

Vec3 CholecystectomySurgeon::TubePoint(const Snapshot& seen, std::size_t tube, double share) const {
  const auto& nodes = tube_nodes_[tube];
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(nodes.size() - 1);
  const auto i = std::min(nodes.size() - 2, static_cast<std::size_t>(at));
  return math::Lerp(seen.positions[nodes[i]], seen.positions[nodes[i + 1]], at - static_cast<double>(i));
}

Vec3 CholecystectomySurgeon::TubeDirection(const Snapshot& seen, std::size_t tube, double share) const {
  return math::Normalized(TubePoint(seen, tube, share + 0.08) - TubePoint(seen, tube, share - 0.08));
}

/// Where the tip stands when the middle of the hook's toe is at a point.
Vec3 CholecystectomySurgeon::HookTip(const Vec3& at) const {
  const HandMotion& hand = hands_[kRight];
  const Pose X =
      instrument::CalcToolPose(hand.Port(), instrument::FindJoints(hand.Port(), at, hand.Spin(), 0.0));
  return at - math::Rotate(X.rotation, {0, 0.00225, 0});
}

// --- verbs

void CholecystectomySurgeon::Add(std::string doing, std::function<void(const Snapshot&)> begin,
                                 std::function<bool(const Snapshot&)> is_done, double patience) {
  acts_.push_back({std::move(doing), std::move(begin), std::move(is_done), patience});
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
      const Vec3 field = seen.positions[neck_];
      return field + 0.045 * math::Normalized(HandOf(hand).Port() - field);
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

void CholecystectomySurgeon::LetGo(int hand) {
  Jaw(hand, 0.8);
  Reach(hand, [this, hand](const Snapshot&) {
    return HandOf(hand).Tip() + 0.025 * math::Normalized(HandOf(hand).Port() - HandOf(hand).Tip());
  });
  Jaw(hand, 0.0);
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

void CholecystectomySurgeon::Dissect(const std::string& what, std::vector<std::uint32_t> strands,
                                     std::vector<double> order, double enough, double traction) {
  auto work = std::make_shared<Dissection>();
  work->attempts.assign(strands.size(), 0);
  work->strands = std::move(strands);
  work->order = std::move(order);
  work->enough = enough;
  work->traction = traction;
  Add(
      "dissect " + what, [this, work](const Snapshot&) { work->p_hold = HandOf(kLeft).Tip(); },
      [this, work](const Snapshot& seen) { return GoOnDissecting(*work, seen); }, 1200.0);
}

bool CholecystectomySurgeon::GoOnDissecting(Dissection& work, const Snapshot& seen) {
  HandControls& pedals = controls_[kRight];
  const auto middle = [&](std::uint32_t strand) {
    return 0.5 * (seen.positions[strands_[strand].a] + seen.positions[strands_[strand].b]);
  };
  const auto is_intact = [&](std::uint32_t strand) { return seen.operation.strand_is_intact[strand] != 0; };
  const auto next = [&] {
    pedals.coagulate = false;
    work.is_burning = false;
    work.target = -1;
    work.seconds = work.blocked = 0;
  };
  if (work.target >= 0) {
    const std::uint32_t strand = work.strands[static_cast<std::size_t>(work.target)];
    work.seconds += scene_->tick_seconds;
    if (!is_intact(strand)) {
      next();
    } else if (work.seconds > kPatience + 2.0) {
      ++work.attempts[static_cast<std::size_t>(work.target)];
      next();
    } else {
      const Vec3 tip = HookTip(middle(strand));
      if (!HandOf(kRight).IsMoving()) {
        const bool is_there =
            math::Distance(seen.instruments[kRight].X_world_tool.translation, HandOf(kRight).Tip()) < kNear;
        // the fibre has moved on while the hand went there
        if (math::Distance(HandOf(kRight).Tip(), tip) > 0.0008) HandOf(kRight).MoveTo(tip, kHurriedHook);
        pedals.coagulate = is_there;
        work.blocked = is_there ? 0.0 : work.blocked + scene_->tick_seconds;
        if (work.blocked > kBlocked || (!is_there && work.seconds > kPatience)) {
          ++work.attempts[static_cast<std::size_t>(work.target)];
          next();
        }
      }
    }
  }
  if (work.target >= 0) return false;
  std::size_t left = 0;
  const auto choose = [&] {
    left = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < work.strands.size(); ++i) {
      if (!is_intact(work.strands[i])) continue;
      ++left;
      if (work.attempts[i] >= kMostAttempts) continue;
      // what is stretched lies open
      const StrandInfo& strand = strands_[work.strands[i]];
      const double stretch = math::Distance(seen.positions[strand.a], seen.positions[strand.b]) -
                             math::Distance(rest_[strand.a], rest_[strand.b]);
      const double cost = work.order[i] + math::Distance(middle(work.strands[i]), HandOf(kRight).Tip()) +
                          0.02 * work.attempts[i] - kOpenShare * stretch;
      if (cost >= best) continue;
      best = cost;
      work.target = static_cast<std::int32_t>(i);
    }
    return 1.0 -
           static_cast<double>(left) / static_cast<double>(std::max<std::size_t>(1, work.strands.size()));
  };
  double parted = choose();
  // what could not be reached may be, now that more has given way
  if (parted > work.parted_at_reset + (work.target < 0 ? 0.004 : 0.03)) {
    std::fill(work.attempts.begin(), work.attempts.end(), std::uint8_t{0});
    work.parted_at_reset = parted;
    parted = choose();
  }
  // the other hand takes up the slack
  if (work.traction > 0.0 && !HandOf(kLeft).IsMoving() && seen.instruments[kLeft].is_grasping) {
    const double drawn = std::min(work.traction, std::max(work.traction * parted, kPeelRate * act_seconds_));
    const Vec3 wanted = work.p_hold + drawn * bed_normal_;
    if (math::Distance(wanted, HandOf(kLeft).Tip()) > 0.002) HandOf(kLeft).MoveTo(wanted, 0.2);
  }
  if (work.target < 0 || parted >= work.enough) {
    next();
    return true;
  }
  // another try comes from another side
  constexpr double kSpins[] = {0.0, 1.3, -1.3};
  hook_spin_ = kSpins[work.attempts[static_cast<std::size_t>(work.target)] % std::size(kSpins)];
  HandOf(kRight).Turn(hook_spin_);
  HandOf(kRight).MoveTo(HookTip(middle(work.strands[static_cast<std::size_t>(work.target)])), kHurriedHook);
  return false;
}

/// Turns the laparoscope so that it looks at a place from aside: by `turn` about the cystic duct.
void CholecystectomySurgeon::LookAt(Place target, double turn, double distance) {
  Add(
      "look",
      [this, target, turn, distance](const Snapshot& seen) {
        const std::size_t duct = FindTube("cystic_duct");
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

// --- the operation

void CholecystectomySurgeon::PlanOperation() {
  using Kind = StrandInfo::Kind;
  const std::size_t duct = FindTube("cystic_duct"), artery = FindTube("cystic_artery");
  const Place neck = [this](const Snapshot& seen) { return seen.positions[neck_]; };
  const Vec3 duct_way = math::Normalized(rest_[tube_nodes_[duct].front()] - rest_[tube_nodes_[duct].back()]);

  Add(
      "assistant: retract", [this](const Snapshot&) { assistant_ = AssistantCommand::kRetract; },
      [](const Snapshot& seen) {
        return seen.operation.is_assistant_holding || !seen.operation.has_assistant;
      },
      8.0);
  Wait(1.5);
  Grasp(kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; });
  Draw(kLeft, 0.006 * duct_way + 0.003 * bed_normal_);
  LookAt(neck, 0.0, 0.075);

  // the triangle, from the gallbladder towards the ducts
  std::vector<std::uint32_t> triangle, bed;
  std::vector<double> triangle_order, bed_order;
  const Vec3 neck_rest = rest_[neck_], axis = rest_[fundus_] - rest_[neck_];
  const auto& organs = scene_->patient.organs;
  const auto is_near_main = [&](const Vec3& p) {
    for (std::size_t t = 0; t < tube_nodes_.size(); ++t) {
      const anatomy::Tube& tube = scene_->patient.tubes[t];
      if (tube.name.find("cystic") == 0) continue;
      for (const std::uint32_t node : tube_nodes_[t]) {
        if (math::Distance(rest_[node], p) < kMainDistance) return true;
      }
    }
    return false;
  };
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    const Vec3 middle = 0.5 * (rest_[strands_[i].a] + rest_[strands_[i].b]);
    if (strands_[i].kind == Kind::kTriangle || strands_[i].kind == Kind::kPeritoneum) {
      if (is_near_main(middle)) continue;
      triangle.push_back(i);
      // the front first
      triangle_order.push_back(-0.5 * middle.z);
    }
    if (strands_[i].kind == Kind::kBed || strands_[i].kind == Kind::kAdhesion) {
      bed.push_back(i);
      bed_order.push_back(0.5 * math::Dot(middle - neck_rest, axis) / math::Norm(axis));
    }
  }
  (void)organs;
  Dissect("the hepatocystic triangle", triangle, triangle_order, 0.995, 0.0);
  // the lower third of the bed
  const double third = 0.42 * math::Norm(axis);
  std::vector<std::uint32_t> lower;
  std::vector<double> lower_order;
  for (std::size_t i = 0; i < bed.size(); ++i) {
    if (bed_order[i] / 0.5 > third) continue;
    lower.push_back(bed[i]);
    lower_order.push_back(bed_order[i]);
  }
  Draw(kLeft, 0.006 * bed_normal_);
  Dissect("the lower third of the bed", lower, lower_order, 0.97, 0.028);

  // both views
  const Place triangle_middle = [this, duct](const Snapshot& seen) { return TubePoint(seen, duct, 0.5); };
  Reach(kRight, [this](const Snapshot& seen) {
    const Vec3 field = seen.positions[neck_];
    return field + 0.05 * math::Normalized(HandOf(kRight).Port() - field);
  });
  for (const double turn : {-0.8, 0.8}) {
    LookAt(triangle_middle, turn, 0.060);
    Wait(1.6);
  }
  LookAt(triangle_middle, 0.0, 0.065);

  Exchange(kRight, instrument::ToolKind::kClipApplier);
  for (const double share : {0.66, 0.54, 0.38}) PlaceClip(duct, share);
  for (const double share : {0.80, 0.69, 0.55}) PlaceClip(artery, share);
  Exchange(kRight, instrument::ToolKind::kScissors);
  CutTube(duct, 0.46);
  CutTube(artery, 0.62);

  Exchange(kRight, instrument::ToolKind::kHook);
  LookAt([this](const Snapshot& seen) { return 0.5 * (seen.positions[neck_] + seen.positions[fundus_]); },
         0.0, 0.105);
  // a new hold for each: the old one may have slipped, and what is free can be drawn elsewhere
  const Vec3 aside = math::Normalized(math::Cross(bed_normal_, axis));
  for (const Vec3& way : {Vec3{}, 0.02 * aside, -0.02 * aside}) {
    LetGo(kLeft);
    Grasp(kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; });
    Draw(kLeft, 0.012 * bed_normal_ + way);
    Dissect("the gallbladder from its bed", bed, bed_order, 1.0, 0.070);
  }
  Add(
      "assistant: release", [this](const Snapshot&) { assistant_ = AssistantCommand::kRelease; },
      [](const Snapshot& seen) { return !seen.operation.is_assistant_holding; }, 4.0);
  Draw(kLeft, 0.03 * bed_normal_);
  Exchange(kRight, instrument::ToolKind::kBag);
  Reach(kRight, [this](const Snapshot& seen) {
    const SurfaceInfo& surface =
        surfaces_[static_cast<std::size_t>(scene_->patient.FindOrgan("gallbladder"))];
    Vec3 centre;
    for (std::uint32_t i = 0; i < surface.node_count; ++i)
      centre += seen.positions[surface.first_node + i] / static_cast<double>(surface.node_count);
    return centre;
  });
  Add(
      "close the bag", [](const Snapshot&) {}, [](const Snapshot& seen) { return seen.operation.is_in_bag; },
      4.0);
  LetGo(kLeft);
  Exchange(kRight, instrument::ToolKind::kHook);
  // Exchange ends with the bag outside
  acts_.pop_back();
  acts_.back().is_done = [](const Snapshot& seen) { return seen.operation.is_completed; };
}

void CholecystectomySurgeon::PlanFlaw(OperationFlaw flaw) {
  using instrument::ToolKind;
  const std::size_t duct = FindTube("cystic_duct"), artery = FindTube("cystic_artery"),
                    main = FindTube("common_hepatic_duct");
  const Place liver = [this](const Snapshot& seen) { return seen.positions[liver_node_]; };
  const auto clip = [this] { Exchange(kRight, ToolKind::kClipApplier); };
  const auto scissors = [this] { Exchange(kRight, ToolKind::kScissors); };
  const auto tube_at = [this](std::size_t tube, double share) -> Place {
    return [this, tube, share](const Snapshot& seen) { return HookTip(TubePoint(seen, tube, share)); };
  };
  switch (flaw) {
    case OperationFlaw::kNone:
      break;
    case OperationFlaw::kClipsMainDuct:
      clip();
      PlaceClip(main, 0.5);
      break;
    case OperationFlaw::kCutsMainDuct:
      scissors();
      CutTube(main, 0.75);
      break;
    case OperationFlaw::kBurnsMainDuct:
      Burn(kRight, tube_at(main, 0.6), 20.0);
      break;
    case OperationFlaw::kCutsUnclipped:
      scissors();
      CutTube(duct, 0.4);
      break;
    case OperationFlaw::kClipsEarly:
      clip();
      PlaceClip(duct, 0.5);
      break;
    case OperationFlaw::kTooFewClips:
      clip();
      PlaceClip(duct, 0.6);
      scissors();
      CutTube(duct, 0.36);
      break;
    case OperationFlaw::kCrossesClips:
      clip();
      PlaceClip(duct, 0.5);
      PlaceClip(duct, 0.5);
      break;
    case OperationFlaw::kClipsPartly:
      clip();
      PlaceClip(duct, 0.5, 0.1);
      break;
    case OperationFlaw::kBleeds:
      scissors();
      CutTube(artery, 0.65);
      Wait(60.0);
      break;
    case OperationFlaw::kPerforates:
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(seen.positions[neck_]); }, 10.0);
      break;
    case OperationFlaw::kBurnsLiver:
      Burn(
          kRight, [this](const Snapshot& seen) { return HookTip(seen.positions[liver_node_]); }, 15.0);
      break;
    case OperationFlaw::kBurnsNearDuct:
      Burn(kRight, tube_at(main, 0.6), 0.5);
      break;
    case OperationFlaw::kBurnsUnseen:
      Burn(
          kRight,
          [this](const Snapshot&) {
            return HandOf(kRight).Port() + 0.035 * Vec3{0.2, 0.1, -1.0};
          },
          0.5);
      break;
    case OperationFlaw::kBurnsAir:
      Burn(
          kRight,
          [this](const Snapshot& seen) {
            const Vec3 field = seen.positions[neck_];
            return field + 0.05 * math::Normalized(MeanPort(*scene_) - field);
          },
          0.5);
      break;
    case OperationFlaw::kDropsClip:
      clip();
      Jaw(kRight, 1.0);
      Jaw(kRight, 0.0);
      break;
    case OperationFlaw::kGraspsLiver:
      Grasp(kLeft, liver);
      break;
    case OperationFlaw::kPullsHard:
      // a light grip, and a strong pull
      Grasp(
          kLeft, [this](const Snapshot& seen) { return seen.positions[hold_]; }, 0.17);
      Draw(kLeft, {0.0, -0.09, 0.06});
      Wait(1.0);
      break;
    case OperationFlaw::kCutsLiver: {
      const auto in_liver = [this](double along) -> Place {
        return [this, along](const Snapshot& seen) {
          const Vec3 p = seen.positions[liver_node_];
          const Vec3 in = math::Normalized(p - HandOf(kRight).Port());
          return p + 0.006 * in + along * math::Normalized(math::Cross(in, {0, 1, 0}));
        };
      };
      Reach(kRight, in_liver(-0.006), 0.5);
      Add(
          "press the pedal", [this](const Snapshot&) { controls_[kRight].cut = true; },
          [](const Snapshot&) { return true; }, 1.0);
      Reach(kRight, in_liver(0.010), 0.1);
      Add(
          "let go of the pedal", [this](const Snapshot&) { controls_[kRight].cut = false; },
          [](const Snapshot&) { return true; }, 1.0);
      break;
    }
    case OperationFlaw::kInsertsBlind:
      Exchange(kRight, ToolKind::kScissors);
      Reach(kRight, [this](const Snapshot&) { return HandOf(kRight).Port() + 0.10 * Vec3{0.6, -0.3, -0.7}; });
      Exchange(kRight, ToolKind::kHook, false);
      Wait(3.0);
      break;
  }
  Wait(0.5);
}

Input CholecystectomySurgeon::Act(const Snapshot& seen) {
  const double dt = scene_->tick_seconds;
  if (acts_.empty()) has_finished_ = true;
  if (!acts_.empty()) {
    SurgicalAct& act = acts_.front();
    if (!has_begun_) {
      act.begin(seen);
      has_begun_ = true;
      act_seconds_ = 0;
      doing_ = act.doing;
    }
    act_seconds_ += dt;
    if (act.is_done(seen) || act_seconds_ > act.patience) {
      acts_.pop_front();
      has_begun_ = false;
      acts_.insert(acts_.begin(), std::make_move_iterator(inserted_.begin()),
                   std::make_move_iterator(inserted_.end()));
      inserted_.clear();
    }
  }
  const auto follow = [&](double& now, double to) {
    now += std::clamp(to - now, -kCameraRate * dt, kCameraRate * dt);
  };
  follow(camera_.pan, camera_to_.pan);
  follow(camera_.tilt, camera_to_.tilt);
  camera_.spin += std::clamp(camera_to_.spin - camera_.spin, -4 * kCameraRate * dt, 4 * kCameraRate * dt);
  camera_.depth += std::clamp(camera_to_.depth - camera_.depth, -0.03 * dt, 0.03 * dt);
  camera_.jaw = camera_to_.jaw;
  Input input;
  for (int hand = 0; hand < kHandCount; ++hand)
    input.hands[static_cast<std::size_t>(hand)] = HandOf(hand).Step(dt);
  input.controls = controls_;
  input.assistant = assistant_;
  input.laparoscope = camera_;
  input.settings = scene_->settings;
  return input;
}

}  // namespace trocar::session
