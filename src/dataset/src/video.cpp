// SPDX-License-Identifier: Apache-2.0
#include "video.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/scene/task.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::dataset {
namespace {

constexpr double kWidestView = 2.4;  // rad

core::Result<scene::Scene> FindScene(const Plan& plan, std::uint64_t seed,
                                     const std::filesystem::path& patient) {
  auto operation = scene::FindOperation(plan.task, patient, seed);
  if (!operation) return operation.error();
  if (*operation) return std::move(**operation);
  const auto path = scene::FindTask(plan.task);
  if (!path) return path.error();
  scene::TaskChoice choice;
  choice.level = plan.level;
  choice.seed = seed;
  choice.patient_folder = patient;
  return scene::ReadTask(*path, choice);
}

std::string NameOutcome(const simulation::Snapshot& last, bool has_finished) {
  if (last.operation.is_completed || last.task.phase == scene::TaskPhase::kCompleted) return "completed";
  if (last.task.phase == scene::TaskPhase::kTimeOver) return "time over";
  if (last.task.phase == scene::TaskPhase::kEnded) return "ended by an error";
  return has_finished ? "given up" : "cut off";
}

bool IsVisible(const render::GeometryPicture& picture, const Act& act) {
  const std::uint16_t label = view::MakeLabel(act.tool, act.hand);
  return std::find(picture.labels.begin(), picture.labels.end(), label) != picture.labels.end();
}

/// A camera of its own, for one video.
class Camera {
 public:
  static core::Result<Camera> Make(const Plan& plan, const simulation::Simulation& simulation,
                                   const Variation& variation) {
    auto context = render::OffscreenContext::Make();
    if (!context) return context.error();
    auto target = render::OffscreenTarget::Make(plan.width, plan.height);
    if (!target) return target.error();
    auto view = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                            simulation.GetSnapshot(), simulation.Strands());
    if (!view) return view.error();
    // the camera finds its exposure by the frames before: they are the same whenever the video is made again
    view->SetOptions({.has_force_arrows = false, .light_power = variation.light_power});
    return Camera(std::move(*context), std::move(*target), std::move(*view), variation);
  }

  core::Status Take(const simulation::Snapshot& now, Frame& frame) {
    const simulation::Snapshot* shown = &now;
    if (smoke_ > now.operation.smoke) {
      hazy_ = now;
      hazy_.operation.smoke = smoke_;
      shown = &hazy_;
    }
    view_.Update(*shown);
    target_.Bind();
    view_.Draw(target_.Width(), target_.Height());
    target_.Read(frame.colour);
    colours_.Apply(frame.colour);
    frame.focal_length = view_.FocalLength(target_.Height());
    return view_.DrawGeometry(target_.Width(), target_.Height(), frame.geometry);
  }

 private:
  Camera(render::OffscreenContext context, render::OffscreenTarget target, view::LaparoscopeView view,
         const Variation& variation)
      : context_(std::move(context)),
        target_(std::move(target)),
        view_(std::move(view)),
        colours_(variation),
        smoke_(variation.smoke) {}

  render::OffscreenContext context_;
  render::OffscreenTarget target_;
  view::LaparoscopeView view_;
  ColourTable colours_;
  double smoke_;
  simulation::Snapshot hazy_;
};

}  // namespace

core::Result<VideoResult> MakeVideo(
    const VideoTask& task,
    const std::function<std::unique_ptr<VideoWriter>(const simulation::Simulation& simulation)>&
        make_writer) {
  const Plan& plan = *task.plan;
  VideoResult result;
  result.seed = plan.first_seed + task.index;
  std::filesystem::path patient;
  if (!plan.patients.empty()) {
    patient = plan.patients[task.index % plan.patients.size()];
    result.patient = patient.filename().string();
  }
  if (plan.has_variation) result.variation = DrawVariation(result.seed);
  auto read = FindScene(plan, result.seed, patient);
  if (!read) return read.error();
  read->laparoscope.field_of_view =
      std::min(kWidestView, read->laparoscope.field_of_view * result.variation.field_of_view_scale);
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene, 1);
  if (!simulation) return simulation.error();
  auto surgeon = agent::MakeSurgeon(plan.surgeon, scene, result.seed);
  if (!surgeon) return surgeon.error();
  auto camera = Camera::Make(plan, *simulation, result.variation);
  if (!camera) return camera.error();

  const auto writer = make_writer(*simulation);
  ActWatch watch(*scene, simulation->Surfaces());
  Frame frame;
  const simulation::Snapshot& now = simulation->GetSnapshot();
  scene::Input input;
  for (;;) {
    watch.Look(now, input);
    writer->Look(*simulation);
    if (now.time + 0.5 * scene->tick_seconds >= static_cast<double>(frame.index) * plan.every) {
      if (auto taken = camera->Take(now, frame); !taken) return taken.error();
      frame.number = static_cast<std::uint64_t>(std::llround(kFramesPerSecond * now.time));
      frame.acts = watch.Acts();
      std::erase_if(frame.acts, [&](const Act& act) { return !IsVisible(frame.geometry, act); });
      if (auto added = writer->Add(frame, *simulation); !added) return added.error();
      ++frame.index;
    }
    if ((*surgeon)->HasFinished() || now.time >= plan.most_seconds ||
        now.task.phase == scene::TaskPhase::kTimeOver || now.task.phase == scene::TaskPhase::kEnded)
      break;
    input = (*surgeon)->Act(now);
    simulation->Step(input);
  }
  if (auto finished = writer->Finish(); !finished) return finished.error();
  result.frames = frame.index;
  result.seconds = now.time;
  result.hash = simulation->Hash();
  result.outcome = NameOutcome(now, (*surgeon)->HasFinished());
  return result;
}

}  // namespace trocar::dataset
