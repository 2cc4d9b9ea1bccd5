// SPDX-License-Identifier: Apache-2.0
#include "cholecystectomy_surgeon.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "act_execution.h"
#include "cholecystectomy_goals.h"
#include "find_place.h"
#include "state_fields.h"
#include "trocar/patient/patient.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using roles::LandmarkRole;
using roles::OrganRole;
using roles::TubeRole;
using scene::InstrumentSetup;
using scene::Scene;
using simulation::Snapshot;

namespace {

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
      operates_(error_scenario == OperationErrorScenario::kNone),
      memory_{{MakeHand(*scene_, kLeft, skill.hand, seed), MakeHand(*scene_, kRight, skill.hand, seed)}} {
  memory_.camera.now = memory_.camera.to = scene_->laparoscope.home;
  auto model = simulation::DescribeModel(*scene_);
  if (!model.ok()) {
    // the simulation of such a scene says why
    course_.has_finished = true;
    return;
  }
  cholecystectomy::TriangleDescription triangle = cholecystectomy::DescribeTriangle(*scene_, *model);
  known_ = LearnPatient(*scene_, *model, triangle);
  sight_ = std::move(triangle.sight);
  organs_ = OrganClearance(scene_->patient.organs, known_.surfaces, known_.rest);
  memory_.camera.field = Place::AtNode(known_.neck);
  memory_.camera.follows = has_goals_ = IsWholeOperation(error_scenario);
  KnowFirstView(scene_->laparoscope.home);
  ActList plan(scene_->instruments);
  WriteErrorPlan(error_scenario, known_, memory_.Hand(kRight).Port(), plan);
  course_.acts.assign(std::make_move_iterator(plan.acts.begin()), std::make_move_iterator(plan.acts.end()));
}

void CholecystectomySurgeon::KnowFirstView(const instrument::TrocarJoints& laparoscope) {
  if (known_.tube_nodes.empty()) return;
  memory_.camera.first_azimuth = CalcAzimuth(
      known_, known_.rest, scene::CalcLaparoscopePose(scene_->laparoscope, laparoscope).translation, 0.0);
}

SurgeonView CholecystectomySurgeon::See(const Snapshot& seen) {
  return {*scene_, known_, seen, memory_.hands, organs_, sight_, memory_.camera.first_azimuth};
}

/// Counts the fibres once a second while it dissects. Without the critical view it ends the operation after a time in
/// which a careful surgeon would no longer go on.
/// \return whether what is under way is worth going on with
bool CholecystectomySurgeon::WatchProgress(const SurgeonAct& act, const SurgeonView& view) {
  Progress& progress = memory_.progress;
  progress.seconds += scene_->tick_seconds;
  if (operates_ && !memory_.has_view && progress.seconds > kMostSeconds)
    memory_.BailOut(ExplainMissingView(view, memory_.ways));
  const bool dissects = act.kind == SurgeonAct::Kind::kDissect || act.kind == SurgeonAct::Kind::kSpread;
  if (!dissects) {
    progress.stuck_seconds = 0;
    return true;
  }
  progress.stuck_seconds += scene_->tick_seconds;
  if (view.seen.tick % kProgressTicks == 0) {
    const auto& is_intact = view.seen.operation.strand_is_intact;
    const auto left =
        is_intact.size() - static_cast<std::size_t>(std::count(is_intact.begin(), is_intact.end(), 0));
    if (left != progress.fibres_left) progress.stuck_seconds = 0;
    progress.fibres_left = left;
  }
  if (progress.stuck_seconds < kMostStuck) return true;
  LeaveFibre(memory_.dissection, memory_.controls[kRight].coagulate);
  return false;
}

/// One tick of the act that is first in the plan; what it plans is done next.
void CholecystectomySurgeon::GoOn(const SurgeonView& view) {
  ActList next(scene_->instruments);
  SurgeonAct& act = course_.acts.front();
  if (!course_.has_begun) {
    Planning on{view, memory_, next};
    act.IsDecision() ? PlanOn(on, act) : BeginAct(act, view, memory_);
    course_.has_begun = true;
    course_.act_seconds = 0;
    course_.doing = act.doing;
  }
  course_.act_seconds += scene_->tick_seconds;
  const bool gets_on = WatchProgress(act, view);
  if (!StepAct(act, view, memory_, course_.act_seconds, next) && course_.act_seconds <= act.time_limit &&
      gets_on)
    return;
  course_.acts.pop_front();
  course_.has_begun = false;
  course_.acts.insert(course_.acts.begin(), std::make_move_iterator(next.acts.begin()),
                      std::make_move_iterator(next.acts.end()));
}

scene::Input CholecystectomySurgeon::Act(const Snapshot& seen) {
  const SurgeonView view = See(seen);
  memory_.has_view = memory_.has_view || seen.operation.procedure.view.IsAchieved();
  if (memory_.stops) course_.acts.clear();
  if (course_.acts.empty()) {
    if (operates_ && memory_.bail_out.empty() && !seen.operation.is_completed)
      memory_.bail_out = "the gallbladder is off its bed but could not be brought out in the bag";
    course_.has_finished = true;
  } else {
    GoOn(view);
  }
  CameraWork& camera = memory_.camera;
  const simulation::InstrumentSnapshot& tool = view.Tool(kRight);
  if (camera.follows)
    FollowTool(camera, scene_->laparoscope, seen.X_world_laparoscope, tool.X_world_tool.translation,
               tool.joints.depth, FindPlace(view, camera.field, {memory_.aim, camera.field}),
               scene_->tick_seconds);
  StepCamera(camera, scene_->tick_seconds);
  scene::Input input;
  for (std::size_t hand = 0; hand < memory_.hands.size(); ++hand)
    input.hands[hand] = memory_.hands[hand].Step(scene_->tick_seconds);
  input.controls = memory_.controls;
  input.assistant = memory_.assistant;
  input.laparoscope = camera.now;
  input.settings = scene_->settings;
  return input;
}

std::optional<std::uint8_t> CholecystectomySurgeon::OwnPhase() const {
  if (!has_goals_ || course_.acts.empty()) return std::nullopt;
  const auto phase = FindPlannedPhase(course_.acts, scene_->instruments);
  return phase ? std::optional(static_cast<std::uint8_t>(*phase)) : std::nullopt;
}

// The order is that of states that have been saved.
void CholecystectomySurgeon::VisitState(base::StateArchive& archive) {
  archive.Field("hands", memory_.hands);
  archive.Field("controls", memory_.controls);
  archive.Field("assistant", memory_.assistant);
  archive.Field("camera", memory_.camera.now);
  archive.Field("camera_to", memory_.camera.to);
  archive.Field("first_azimuth", memory_.camera.first_azimuth);
  archive.Field("has_view", memory_.has_view);
  archive.Field("stops", memory_.stops);
  archive.Field("bail_out", memory_.bail_out);
  archive.Field("triangle_ways_left", memory_.ways.triangle);
  archive.Field("sharp_rounds_left", memory_.ways.sharp);
  archive.Field("has_begun_at_fundus", memory_.ways.has_begun_at_fundus);
  archive.Field("fibres_left", memory_.progress.fibres_left);
  archive.Field("stuck_seconds", memory_.progress.stuck_seconds);
  archive.Field("seconds", memory_.progress.seconds);
  VisitQueue(archive, "acts", course_.acts);
  archive.Field("dissection", memory_.dissection);
  archive.Field("spreading", memory_.spreading);
  archive.Field("division", memory_.division);
  archive.Field("has_begun", course_.has_begun);
  archive.Field("has_finished", course_.has_finished);
  archive.Field("act_seconds", course_.act_seconds);
  archive.Field("field", memory_.camera.field);
  archive.Field("camera_follows", memory_.camera.follows);
  archive.Field("unseen_seconds", memory_.camera.unseen_seconds);
  archive.Field("unheld_seconds", memory_.unheld_seconds);
  archive.Field("missed_holds", memory_.missed_holds);
  archive.Field("heat", memory_.heat);
  archive.Field("beyond", memory_.aim.beyond);
  archive.Field("offset", memory_.aim.offset);
  archive.Field("doing", course_.doing);
  if (archive.IsRestoring()) organs_.Forget();
}

}  // namespace trocar::agent
