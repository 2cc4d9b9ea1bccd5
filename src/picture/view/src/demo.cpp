// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/demo.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/statistics.h"
#include "trocar/host/clock.h"
#include "trocar/host/threads.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/render/video_writer.h"
#include "trocar/simulation/simulation.h"

namespace trocar::view {
namespace {

constexpr int kDefaultPictures = 6;
constexpr double kLongestDemo = 3600.0;  // s

base::Error WrongUse(const std::string& what) {
  return {base::ErrorCode::kUsage, "demonstration: " + what};
}

base::Result<double> FindDuration(const scene::Scene& scene, const DemoOptions& options) {
  if (!(options.duration >= 0.0 && options.duration <= kLongestDemo))
    return WrongUse("the duration must be 0 to 3600 s");
  if (options.duration > 0.0) return options.duration;
  if (scene.script.keys.empty()) {
    return base::Error{
        base::ErrorCode::kScriptInvalid,
        "the scene " + scene.name + " names no script; name one in the scene or give a duration"};
  }
  return scene.script.Duration();
}

/// Times at which pictures are kept, ascending and within the demonstration.
std::vector<double> FindPictureTimes(const DemoOptions& options, double duration) {
  std::vector<double> times = options.picture_times;
  if (times.empty() && options.is_until_end) {
    for (double time = 1; time <= duration; time *= 2) times.push_back(time);
  } else if (times.empty()) {
    for (int i = 0; i < kDefaultPictures; ++i) times.push_back(duration * (i + 0.5) / kDefaultPictures);
  }
  std::erase_if(times, [duration](double time) { return !(time >= 0.0 && time <= duration); });
  std::sort(times.begin(), times.end());
  return times;
}

std::string PictureName(std::size_t number) {
  char name[40];
  std::snprintf(name, sizeof name, "picture_%03zu.png", number);
  return name;
}

}  // namespace

base::Result<DemoReport> PlayDemonstration(std::shared_ptr<const scene::Scene> scene,
                                           const DemoOptions& options) {
  if (options.width < 16 || options.width > 4096 || options.height < 16 || options.height > 4096) {
    return WrongUse("the picture must have 16 to 4096 pixels a side");
  }
  if (options.frames_per_second < 1 || options.frames_per_second > 240)
    return WrongUse("1 to 240 frames a second");
  if (options.threads < 1) return WrongUse("at least one thread");
  TROCAR_ASSERT(options.source != nullptr || !options.is_until_end);
  const auto duration = FindDuration(*scene, options);
  if (!duration) return duration.error();

  auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(options.threads)});
  if (!simulation) return simulation.error();
  if (!options.start.empty()) {
    if (const auto restored = simulation->Restore(options.start); !restored) return restored.error();
  }
  auto context = render::OffscreenContext::Make();
  if (!context) return context.error();
  auto target = render::OffscreenTarget::Make(options.width, options.height);
  if (!target) return target.error();
  auto view =
      LaparoscopeView::Make(*scene, simulation->Surfaces(), simulation->GetSnapshot(), simulation->Strands());
  if (!view) return view.error();
  view->SetOptions(options.view);

  DemoReport report;
  report.graphics = context->RendererText();
  std::optional<render::VideoWriter> video;
  if (options.has_video) {
    report.video = options.output_folder / "demo.webm";
    auto made =
        render::VideoWriter::Make(report.video, {options.width, options.height, options.frames_per_second});
    if (!made) return made.error();
    video.emplace(std::move(*made));
  }

  if (options.on_start) {
    if (auto status = options.on_start(*simulation); !status) return status.error();
  }
  const std::vector<double> picture_times = FindPictureTimes(options, *duration);
  const auto frame_count =
      static_cast<std::uint64_t>(std::floor(*duration * options.frames_per_second + 1e-9)) + 1;
  std::vector<double> draw_seconds;
  draw_seconds.reserve(frame_count);
  render::Image image;
  std::size_t next_picture = 0;
  const auto play_until = [&](double time) {
    const auto tick_goal = static_cast<std::uint64_t>(std::floor(time / scene->tick_seconds + 1e-6));
    while (report.ticks < tick_goal) {
      const simulation::Snapshot& before = simulation->GetSnapshot();
      const scene::Input input = options.source != nullptr ? options.source->For(before.tick + 1, before)
                                                           : scene::CalcScriptInput(*scene, before.time);
      simulation->Step(input);
      ++report.ticks;
      if (options.after_step) options.after_step(*simulation, input);
      if (options.on_tick) options.on_tick(simulation->GetSnapshot());
    }
  };
  for (std::uint64_t frame = 0; frame < frame_count; ++frame) {
    const double frame_time = static_cast<double>(frame) / options.frames_per_second;
    play_until(frame_time);

    const host::Stopwatch watch;
    view->Update(simulation->GetSnapshot());
    target->Bind();
    view->Draw(options.width, options.height);
    target->Read(image);
    draw_seconds.push_back(watch.Seconds());
    ++report.frames;

    if (video) {
      if (auto status = video->AddFrame(image); !status) return status.error();
    }
    // the last picture may be asked for at the very end, between the last frame and it
    const bool has_finished = options.is_until_end && options.source->IsAtEnd();
    const bool is_last = frame + 1 == frame_count || has_finished;
    while (next_picture < picture_times.size() &&
           (picture_times[next_picture] <= frame_time + 1e-9 || is_last)) {
      const auto path = options.output_folder / PictureName(++next_picture);
      if (auto status = render::WritePng(path, image); !status) return status.error();
      report.pictures.push_back({frame_time, path});
      if (has_finished) break;  // what was to come later shows the end, once
    }
    if (options.on_progress)
      options.on_progress(static_cast<double>(frame + 1) / static_cast<double>(frame_count));
    if (has_finished) break;
  }
  if (!options.is_until_end) play_until(*duration);  // what lies behind the last frame
  if (video) {
    if (auto status = video->Finish(); !status) return status.error();
  }
  report.draw_median = base::CalcPercentile(draw_seconds, 0.5);
  report.draw_p99 = base::CalcPercentile(draw_seconds, 0.99);
  report.state_hash = simulation->Hash();
  report.operation = simulation->GetOperationResult();
  return report;
}

}  // namespace trocar::view
