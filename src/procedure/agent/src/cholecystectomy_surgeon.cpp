// SPDX-License-Identifier: Apache-2.0
#include "cholecystectomy_surgeon.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "trocar/patient/patient.h"

namespace trocar::agent {

using instrument::IsInView;
using instrument::kRight;
using math::Vec3;
using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::CalcLaparoscopePose;
using scene::FindView;
using scene::InstrumentSetup;
using scene::Scene;
using scene::StrandInfo;
using scene::SurfaceInfo;
using scene::ViewRequest;
using simulation::DescribeModel;
using simulation::InstrumentSnapshot;
using simulation::Snapshot;

namespace {

/// Where the left hand holds the gallbladder: from the neck towards the fundus, and off the bed [m].
constexpr double kHoldBack = 0.020, kHoldBeside = 0.012;
constexpr double kCameraRate = 0.25;    // [rad/s]
constexpr double kSeenWell = 0.8;       // of the picture's width: the camera does not follow what lies within
constexpr double kFollowSeconds = 0.3;  // a tip is out of there before the picture follows [s]
constexpr double kFollowDistance = 0.09;  // of the lens from what it follows [m]
constexpr double kNeckRadius = 0.015;     // what lies so near to the infundibulum turns with the neck [m]
constexpr double kWorks = 0.06;           // a tool this deep is at work [m]
constexpr std::uint64_t kProgressTicks = 120;  // between two counts of the fibres
constexpr double kMostStuck = 120.0;           // of dissection that parts nothing [s]
constexpr double kMostSeconds = 2400.0;        // without the critical view [s]

HandMotion MakeHand(const Scene& scene, int hand, const HandSkill& skill, std::uint64_t seed) {
  const InstrumentSetup& setup = scene.instruments[static_cast<std::size_t>(hand)];
  return {setup.p_world_port, setup.home, skill, seed + static_cast<std::uint64_t>(hand)};
}

}  // namespace

bool IsCholecystectomy(const Scene& scene) {
  using instrument::ToolKind;
  const patient::Patient& patient = scene.patient;
  const auto has_organ = [&](OrganRole role) { return patient.OrganOf(role) >= 0; };
  const auto has_landmark = [&](LandmarkRole role) { return patient.LandmarkOf(role) != nullptr; };
  const auto has_tube = [&](TubeRole role) { return patient.TubeOf(role) >= 0; };
  const auto has_tool = [&](ToolKind kind) {
    return std::ranges::any_of(scene.instruments[kRight].tray,
                               [&](const instrument::Tool& tool) { return tool.kind == kind; });
  };
  return scene.operation.has_value() && has_organ(OrganRole::kGallbladder) && has_organ(OrganRole::kLiver) &&
         has_landmark(LandmarkRole::kInfundibulum) && has_landmark(LandmarkRole::kFundus) &&
         has_landmark(LandmarkRole::kLiverEdge) && has_tube(TubeRole::kCysticDuct) &&
         has_tube(TubeRole::kCysticArtery) && has_tube(TubeRole::kCommonHepaticDuct) &&
         has_tool(ToolKind::kHook) && has_tool(ToolKind::kClipApplier) && has_tool(ToolKind::kScissors) &&
         has_tool(ToolKind::kBag);
}

CholecystectomySurgeon::CholecystectomySurgeon(std::shared_ptr<const Scene> scene, const SurgeonSkill& skill,
                                               OperationErrorScenario error_scenario, std::uint64_t seed)
    : scene_(std::move(scene)),
      hands_{MakeHand(*scene_, instrument::kLeft, skill.hand, seed),
             MakeHand(*scene_, kRight, skill.hand, seed)} {
  picture_.camera = picture_.to = scene_->laparoscope.home;
  auto model = DescribeModel(*scene_);
  if (!model.ok()) {
    // the simulation of such a scene says why
    has_finished_ = true;
  } else {
    Learn(std::move(*model));
    operates_ = error_scenario == OperationErrorScenario::kNone;
    operates_ ? PlanOperation() : PlanErrorScenario(error_scenario);
  }
}

void CholecystectomySurgeon::Learn(simulation::ModelDescription model) {
  const patient::Patient& patient = scene_->patient;
  known_.strands = std::move(model.strands);
  known_.surfaces = std::move(model.surfaces);
  known_.rest = std::move(model.rest);
  known_.window_strands = std::move(model.window_strands);
  sight_ = std::move(model.sight);
  known_.exposable = std::move(model.exposable);
  known_.gallbladder = scene::FindSurface(known_.surfaces, OrganRole::kGallbladder);
  known_.liver = scene::FindSurface(known_.surfaces, OrganRole::kLiver);
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const SurfaceInfo& surface = known_.surfaces[patient.organs.size() + t];
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t k = 0; k < surface.node_count; ++k) nodes.push_back(surface.first_node + k);
    if (surface.ends[1] == known_.gallbladder) std::reverse(nodes.begin(), nodes.end());
    known_.tube_nodes.push_back(std::move(nodes));
  }
  // what anatomy teaches of each tube
  for (std::size_t t = 0; t < model.tube_roles.size(); ++t) {
    const patient::Tube& tube = patient.tubes[t];
    const SurfaceInfo& surface = known_.surfaces[patient.organs.size() + t];
    if (surface.Joins(known_.gallbladder)) known_.entering.push_back(t);
    for (std::uint32_t k = 0; k < surface.node_count; ++k) {
      const cholecystectomy::VesselRole role = model.tube_roles[t][k];
      if (!cholecystectomy::MayBeDivided(role)) known_.main_nodes.push_back(surface.first_node + k);
      const bool is_duct = tube.kind == patient::TubeKind::kDuct;
      if (!cholecystectomy::MayBeDivided(role) && is_duct)
        known_.main_ducts.push_back(surface.first_node + k);
      const bool is_kept_artery = !cholecystectomy::MayBeDivided(role) && !is_duct;
      if (is_kept_artery || role == cholecystectomy::VesselRole::kSubvesicalDuct)
        known_.careful_nodes.push_back(surface.first_node + k);
    }
  }
  for (std::size_t i = 0; i < patient.organs.size(); ++i) {
    const SurfaceInfo& surface = known_.surfaces[i];
    auto tree =
        collision::TriangleTree::Make(std::span(known_.rest).subspan(surface.first_node, surface.node_count),
                                      patient.organs[i].mesh.triangles);
    trees_.push_back(tree.ok() ? std::move(*tree) : collision::TriangleTree());
  }
  for (std::uint32_t i = 0; i < known_.strands.size(); ++i) {
    const bool enters = std::any_of(known_.entering.begin(), known_.entering.end(), [&](std::size_t tube) {
      return known_.strands[i].a == known_.tube_nodes[tube].front();
    });
    if (known_.strands[i].kind == StrandInfo::Kind::kEnd && enters) known_.end_strands.push_back(i);
  }
  const Vec3 neck = patient.LandmarkOf(LandmarkRole::kInfundibulum)->position,
             fundus = patient.LandmarkOf(LandmarkRole::kFundus)->position,
             edge = patient.LandmarkOf(LandmarkRole::kLiverEdge)->position;
  known_.neck = FindNode(known_.gallbladder, neck);
  known_.fundus = FindNode(known_.gallbladder, fundus);
  known_.liver_node = FindNode(known_.liver, edge);
  for (const StrandInfo& strand : known_.strands) {
    if (strand.kind == StrandInfo::Kind::kBed)
      known_.bed_normal += known_.rest[strand.a] - known_.rest[strand.b];
  }
  known_.bed_normal = math::Normalized(known_.bed_normal, {0, -1, 0});
  // beside the neck, so that both tools have clearance
  const Vec3 axis = math::Normalized(fundus - neck);
  known_.hold = FindNode(known_.gallbladder, neck + kHoldBack * axis + kHoldBeside * known_.bed_normal);
  const SurfaceInfo& surface = known_.surfaces[static_cast<std::size_t>(known_.gallbladder)];
  for (std::uint32_t node = surface.first_node; node < surface.first_node + surface.node_count; ++node) {
    if (math::Distance(known_.rest[node], neck) <= kNeckRadius) known_.neck_nodes.push_back(node);
  }
  picture_.field = Place::AtNode(known_.neck);
  KnowFirstView(scene_->laparoscope.home);
}

void CholecystectomySurgeon::KnowFirstView(const instrument::TrocarJoints& laparoscope) {
  if (known_.tube_nodes.empty()) return;
  picture_.first_azimuth = 0;
  picture_.first_azimuth =
      CalcAzimuth(known_.rest, CalcLaparoscopePose(scene_->laparoscope, laparoscope).translation);
}

/// The picture goes where the right hand works.
void CholecystectomySurgeon::FollowWithCamera(const Snapshot& seen) {
  const InstrumentSnapshot& hand = seen.instruments[kRight];
  const Vec3& tip = hand.X_world_tool.translation;
  const bool is_seen = hand.joints.depth < kWorks ||
                       IsInView(seen.X_world_laparoscope, kSeenWell * scene_->laparoscope.field_of_view, tip);
  picture_.unseen_seconds = is_seen ? 0.0 : picture_.unseen_seconds + scene_->tick_seconds;
  if (picture_.unseen_seconds < kFollowSeconds || !(picture_.camera == picture_.to)) return;
  const Vec3 middle = 0.5 * (tip + Find(picture_.field, seen));
  AimCamera(middle, math::Normalized(scene_->laparoscope.p_world_port - middle), kFollowDistance);
  picture_.unseen_seconds = 0;
}

/// Turns the laparoscope to a place, at about a distance; nothing where it does not get there.
void CholecystectomySurgeon::AimCamera(const Vec3& p, const Vec3& facing, double distance) {
  for (const double share : {1.0, 0.85, 1.15, 0.7, 1.3, 0.55}) {
    ViewRequest request;
    request.p_world = p;
    request.distance = share * distance;
    request.facing = facing;
    if (const auto view = FindView(scene_->laparoscope, request)) {
      picture_.to = *view;
      return;
    }
  }
}

std::uint32_t CholecystectomySurgeon::FindNode(std::int32_t organ, const Vec3& p) const {
  const SurfaceInfo& surface = known_.surfaces[static_cast<std::size_t>(organ)];
  std::uint32_t nearest = surface.first_node;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    const std::uint32_t node = surface.first_node + i;
    if (math::SquaredDistance(known_.rest[node], p) < math::SquaredDistance(known_.rest[nearest], p))
      nearest = node;
  }
  return nearest;
}

std::size_t CholecystectomySurgeon::FindTube(TubeRole role) const {
  return static_cast<std::size_t>(std::max(0, scene_->patient.TubeOf(role)));
}

Vec3 CholecystectomySurgeon::TubePoint(const Snapshot& seen, std::size_t tube, double share) const {
  const auto& nodes = known_.tube_nodes[tube];
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(nodes.size() - 1);
  const auto i = std::min(nodes.size() - 2, static_cast<std::size_t>(at));
  return math::Lerp(seen.positions[nodes[i]], seen.positions[nodes[i + 1]], at - static_cast<double>(i));
}

Vec3 CholecystectomySurgeon::TubeDirection(const Snapshot& seen, std::size_t tube, double share) const {
  return math::Normalized(TubePoint(seen, tube, share + 0.08) - TubePoint(seen, tube, share - 0.08));
}

/// Counts the fibres once a second while it dissects. Without the critical view it ends the operation after a time in
/// which a careful surgeon would no longer go on.
/// \return whether what is under way is worth going on with
bool CholecystectomySurgeon::WatchProgress(const SurgeonAct& act, const Snapshot& seen) {
  progress_.seconds += scene_->tick_seconds;
  if (operates_ && !has_view_ && progress_.seconds > kMostSeconds) BailOut(ExplainMissingView(seen));
  const bool dissects = act.kind == SurgeonAct::Kind::kDissect || act.kind == SurgeonAct::Kind::kSpread;
  if (!dissects) {
    progress_.stuck_seconds = 0;
    return true;
  }
  progress_.stuck_seconds += scene_->tick_seconds;
  if (seen.tick % kProgressTicks == 0) {
    const auto& is_intact = seen.operation.strand_is_intact;
    const auto left =
        is_intact.size() - static_cast<std::size_t>(std::count(is_intact.begin(), is_intact.end(), 0));
    if (left != progress_.fibres_left) progress_.stuck_seconds = 0;
    progress_.fibres_left = left;
  }
  if (progress_.stuck_seconds < kMostStuck) return true;
  LeaveFibre(dissection_);
  return false;
}

scene::Input CholecystectomySurgeon::Act(const Snapshot& seen) {
  const double dt = scene_->tick_seconds;
  has_view_ = has_view_ || seen.operation.critical_view.IsAchieved();
  if (stops_) acts_.clear();
  if (acts_.empty()) {
    if (operates_ && bail_out_.empty() && !seen.operation.is_completed)
      bail_out_ = "the gallbladder is off its bed but could not be brought out in the bag";
    has_finished_ = true;
  }
  if (!acts_.empty()) {
    SurgeonAct& act = acts_.front();
    if (!has_begun_) {
      Begin(act, seen);
      has_begun_ = true;
      act_seconds_ = 0;
      doing_ = act.doing;
    }
    act_seconds_ += dt;
    const bool gets_on = WatchProgress(act, seen);
    if (IsDone(act, seen) || act_seconds_ > act.time_limit || !gets_on) {
      acts_.pop_front();
      has_begun_ = false;
      acts_.insert(acts_.begin(), std::make_move_iterator(inserted_.begin()),
                   std::make_move_iterator(inserted_.end()));
      inserted_.clear();
    }
  }
  if (picture_.follows) FollowWithCamera(seen);
  const auto follow = [&](double& now, double to) {
    now += std::clamp(to - now, -kCameraRate * dt, kCameraRate * dt);
  };
  follow(picture_.camera.pan, picture_.to.pan);
  follow(picture_.camera.tilt, picture_.to.tilt);
  picture_.camera.spin +=
      std::clamp(picture_.to.spin - picture_.camera.spin, -4 * kCameraRate * dt, 4 * kCameraRate * dt);
  picture_.camera.depth += std::clamp(picture_.to.depth - picture_.camera.depth, -0.03 * dt, 0.03 * dt);
  picture_.camera.jaw = picture_.to.jaw;
  scene::Input input;
  for (int hand = 0; hand < instrument::kHandCount; ++hand)
    input.hands[static_cast<std::size_t>(hand)] = HandOf(hand).Step(dt);
  input.controls = controls_;
  input.assistant = assistant_;
  input.laparoscope = picture_.camera;
  input.settings = scene_->settings;
  return input;
}

}  // namespace trocar::agent
