// SPDX-License-Identifier: Apache-2.0
#include "replay_video.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "console.h"
#include "part_folder.h"
#include "picture_size.h"
#include "trocar/record/tip_path.h"
#include "trocar/view/film_maker.h"
#include "trocar/view/free_camera.h"

namespace trocar::cli {
namespace {

using record::Recording;
using record::Replay;

constexpr const char* kRecorded = "recorded";
constexpr int kPictures = 6;
constexpr int kFramesPerSecond = 30;
constexpr double kTrailSeconds = 4;  // of the tips' ways that are shown

/// One replay and what is drawn over it.
struct ShownRecording {
  Replay* replay;
  record::TipPath path;
  std::optional<math::Pose> X_world_camera;
};

ShownRecording MakeShown(Replay& replay, std::optional<render::Viewpoint> viewpoint) {
  ShownRecording shown{
      &replay, record::CalcTipPath(replay.GetSimulation().GetScene(), replay.GetRecording()), {}};
  if (viewpoint) {
    const auto& now = replay.GetSimulation().GetSnapshot();
    shown.X_world_camera = view::PoseOf(view::MakeFreeCamera(now.X_world_laparoscope, *viewpoint));
  }
  return shown;
}

view::Overlay MakeOverlay(const ShownRecording& shown, const ShownRecording* other, bool has_ghosts) {
  view::Overlay overlay;
  overlay.X_world_camera = shown.X_world_camera;
  if (!has_ghosts) return overlay;
  const double now = shown.replay->GetSimulation().GetSnapshot().time;
  overlay.trails = view::MakePathTrails(shown.path.Between(instrument::kLeft, now - kTrailSeconds, now),
                                        shown.path.Between(instrument::kRight, now - kTrailSeconds, now));
  if (other == nullptr) return overlay;
  const auto ghosts = view::MakeGhosts(other->replay->GetSimulation().GetSnapshot());
  overlay.trails.insert(overlay.trails.end(), ghosts.begin(), ghosts.end());
  return overlay;
}

double EndOf(const Recording& recording) {
  return static_cast<double>(recording.LastTick()) * recording.description.tick_seconds;
}

}  // namespace

std::uint64_t TickAt(const record::Recording& recording, double seconds) {
  const double tick = std::floor(seconds / recording.description.tick_seconds + 0.5);
  return static_cast<std::uint64_t>(std::clamp(tick, static_cast<double>(recording.FirstTick()),
                                               static_cast<double>(recording.LastTick())));
}

std::vector<std::string> ListReplayCameras() {
  std::vector<std::string> names = {kRecorded};
  for (int i = 0; i < static_cast<int>(render::Viewpoint::kCount); ++i)
    names.emplace_back(render::ViewpointName(static_cast<render::Viewpoint>(i)));
  return names;
}

base::Status MakeReplayVideo(Replay& replay, Replay* other, const ReplayVideoOptions& options) {
  const auto size = ReadSize(options.size);
  if (!size.ok()) return size.error();
  double end = EndOf(replay.GetRecording());
  if (other != nullptr) end = std::max(end, EndOf(other->GetRecording()));
  end = std::min(end, options.until);
  if (end <= options.from)
    return base::Error{base::ErrorCode::kUsage, "--from and --until leave nothing to show"};

  const auto viewpoint = options.camera == kRecorded ? std::nullopt : render::FindViewpoint(options.camera);
  std::vector<Replay*> replays = {&replay};
  if (other != nullptr) replays.push_back(other);
  std::vector<ShownRecording> shown;
  std::vector<const simulation::Simulation*> simulations;
  for (Replay* each : replays) {
    if (const auto status = each->Seek(TickAt(each->GetRecording(), options.from)); !status.ok())
      return status;
    shown.push_back(MakeShown(*each, viewpoint));
    simulations.push_back(&each->GetSimulation());
  }
  PartFolder part(options.output);
  view::FilmSettings settings;
  settings.width = (*size)[0], settings.height = (*size)[1];
  settings.frames_per_second = kFramesPerSecond;
  settings.video = part.Path() / "demo.webm";
  settings.view.has_force_arrows = options.has_forces;
  // from another side the abdominal wall would hide everything, and there is no telescope
  settings.view.has_background = settings.view.has_mask = !viewpoint;
  auto film = view::FilmMaker::Make(settings, simulations);
  if (!film.ok()) return film.error();

  host::ProgressBar progress("drawing", 1.0);
  const auto frames = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil((end - options.from) / options.speed * kFramesPerSecond)));
  int pictures = 0;
  std::vector<view::FilmMaker::Side> sides(shown.size());
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const double time = options.from + static_cast<double>(frame) * options.speed / kFramesPerSecond;
    for (ShownRecording& each : shown) {
      if (const auto status = each.replay->Seek(TickAt(each.replay->GetRecording(), time)); !status.ok())
        return status;
    }
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const ShownRecording* beside = shown.size() == 2 ? &shown[1 - i] : nullptr;
      sides[i] = {&shown[i].replay->GetSimulation().GetSnapshot(),
                  MakeOverlay(shown[i], beside, options.has_ghosts)};
    }
    if (const auto added = film->AddFrame(sides); !added.ok()) return added;
    if (frame * kPictures >= static_cast<std::uint64_t>(pictures) * frames + frames / 2 &&
        pictures < kPictures) {
      char name[40];
      std::snprintf(name, sizeof name, "picture_%03d.png", ++pictures);
      if (const auto saved = film->SavePicture(part.Path() / name); !saved.ok()) return saved;
    }
    progress.Show(static_cast<double>(frame + 1) / static_cast<double>(frames));
  }
  progress.Finish();
  if (const auto finished = film->Finish(); !finished.ok()) return finished;
  if (const auto kept = part.Keep(); !kept.ok()) return kept;
  host::Say("{1} holds demo.webm and {2} pictures, from {3} s to {4} s\n", options.output, pictures,
            host::ShownNumber(options.from, 4), host::ShownNumber(end, 4));
  return {};
}

}  // namespace trocar::cli
