// SPDX-License-Identifier: Apache-2.0
#include "video.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "layout_set.h"
#include "player.h"
#include "trocar/host/sha256.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/simulation/attempt_end.h"
#include "trocar/view/laparoscope_view.h"
#include "truth.h"

namespace trocar::dataset {
namespace {

std::string NameOutcome(const Plan& plan, const simulation::Snapshot& last, bool has_finished) {
  if (simulation::HasCompleted(last)) return "completed";
  if (last.task.phase == scene::TaskPhase::kTimeOver) return "time over";
  if (last.task.phase == scene::TaskPhase::kEnded) return "ended by an error";
  if (!plan.recordings.empty() && has_finished) return "end of the recording";
  return has_finished ? "given up" : "cut off";
}

bool IsVisible(const render::GeometryPicture& picture, const Act& act) {
  const std::uint16_t label = view::MakeLabel(act.tool, act.hand);
  return std::find(picture.labels.begin(), picture.labels.end(), label) != picture.labels.end();
}

/// A camera of its own, for one video.
class Camera {
 public:
  static base::Result<Camera> Make(const Plan& plan, const simulation::Simulation& simulation,
                                   const Variation& variation) {
    auto context = render::OffscreenContext::Make();
    if (!context) return context.error();
    auto target = render::OffscreenTarget::Make(plan.width, plan.height);
    if (!target) return target.error();
    auto view = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                            simulation.GetSnapshot(), simulation.Strands());
    if (!view) return view.error();
    // the camera finds its exposure by the frames before: they are the same whenever the video is made again
    view->SetOptions({.has_force_arrows = false,
                      .light_power = variation.light_power,
                      .tool_wear = variation.tool_wear,
                      .stains = variation.stains});
    return Camera(std::move(*context), std::move(*target), std::move(*view), variation,
                  plan.layout == Layout::kTrocar);
  }

  base::Status Take(const simulation::Snapshot& now, Frame& frame) {
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
    return has_flow_ ? view_.DrawGeometryAndFlow(target_.Width(), target_.Height(), frame.geometry)
                     : view_.DrawGeometry(target_.Width(), target_.Height(), frame.geometry);
  }

 private:
  Camera(render::OffscreenContext context, render::OffscreenTarget target, view::LaparoscopeView view,
         const Variation& variation, bool has_flow)
      : context_(std::move(context)),
        target_(std::move(target)),
        view_(std::move(view)),
        colours_(variation),
        smoke_(variation.smoke),
        has_flow_(has_flow) {}

  render::OffscreenContext context_;
  render::OffscreenTarget target_;
  view::LaparoscopeView view_;
  ColourTable colours_;
  double smoke_;
  bool has_flow_;
  simulation::Snapshot hazy_;
};

/// Who acts in a video; the result gets patient, lens and recording.
base::Result<std::unique_ptr<Player>> OpenPlayer(const VideoTask& task, VideoResult& result) {
  const Plan& plan = *task.plan;
  if (plan.recordings.empty()) {
    std::filesystem::path patient;
    if (!plan.patients.empty()) patient = plan.patients[task.index % plan.patients.size()];
    result.patient = patient.filename().string();
    return MakeSurgeonPlayer(plan, result.seed, patient, result.variation.field_of_view_scale);
  }
  const std::filesystem::path& file = plan.recordings[task.index];
  const auto sum = host::CalcSha256OfFile(file);
  if (!sum) return sum.error();
  result.recording = *sum;
  // the lens is part of the scene that was recorded
  result.variation.field_of_view_scale = 1;
  return MakeRecordingPlayer(file);
}

}  // namespace

base::Result<VideoResult> MakeVideo(
    const VideoTask& task,
    const std::function<std::unique_ptr<VideoWriter>(const simulation::Simulation& simulation)>&
        make_writer) {
  const Plan& plan = *task.plan;
  VideoResult result;
  result.seed = plan.first_seed + task.index;
  if (plan.has_variation && plan.has_pictures) result.variation = DrawVariation(result.seed);
  auto player = OpenPlayer(task, result);
  if (!player) return player.error();
  const simulation::Simulation& simulation = (*player)->GetSimulation();
  std::optional<Camera> camera;
  if (plan.has_pictures) {
    auto made = Camera::Make(plan, simulation, result.variation);
    if (!made) return made.error();
    camera.emplace(std::move(*made));
  }

  const auto writer = make_writer(simulation);
  ActWatch watch(simulation.GetScene(), simulation.Surfaces(), simulation.Strands());
  std::optional<TruthTable> truth;
  if (simulation.GetOperationResult()) truth.emplace(simulation);
  Frame frame;
  const simulation::Snapshot& now = simulation.GetSnapshot();
  const double begin = now.time, half_tick = 0.5 * simulation.GetScene().tick_seconds;
  for (;;) {
    watch.Look(now);
    if (truth) truth->Look(now);
    writer->Look(simulation, (*player)->LastInput());
    if (now.time - begin + half_tick >= static_cast<double>(frame.index) * plan.every) {
      frame.number = static_cast<std::uint64_t>(std::llround(kFramesPerSecond * (now.time - begin)));
      frame.acts = watch.Acts();
      if (truth) truth->Add(frame.index, frame.number, **player, frame.acts);
      if (camera) {
        if (auto taken = camera->Take(now, frame); !taken) return taken.error();
        std::erase_if(frame.acts, [&](const Act& act) { return !IsVisible(frame.geometry, act); });
      }
      if (auto added = writer->Add(frame, simulation); !added) return added.error();
      ++frame.index;
    }
    if ((*player)->HasFinished() || now.time - begin >= plan.most_seconds ||
        now.task.phase == scene::TaskPhase::kTimeOver || now.task.phase == scene::TaskPhase::kEnded)
      break;
    (*player)->Step();
  }
  if (auto whole = (*player)->Finish(); !whole) return whole.error();
  if (auto finished = writer->Finish(); !finished) return finished.error();
  if (truth) {
    const std::string name = NameVideo("video_", result.seed, 5) + ".csv";
    if (auto written = truth->Write(task.folder / "truth" / name); !written) return written.error();
  }
  result.frames = frame.index;
  result.seconds = now.time - begin;
  result.hash = simulation.Hash();
  result.outcome = NameOutcome(plan, now, (*player)->HasFinished());
  return result;
}

}  // namespace trocar::dataset
