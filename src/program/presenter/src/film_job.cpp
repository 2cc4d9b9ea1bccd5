// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/film_job.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <system_error>
#include <utility>

#include "trocar/host/partial_path.h"
#include "trocar/host/user_folder.h"
#include "trocar/record/replay.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/view/film_maker.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesPerSecond = 30;
constexpr int kMomentWidth = 640, kMomentHeight = 400;  // [pixels]

base::Error Cancelled() {
  return {base::ErrorCode::kCancelled, "the video was given up; nothing was written"};
}

}  // namespace

base::Result<Film> MakeFilm(const FilmRequest& request, gui::JobProgress& progress,
                            const std::atomic<bool>& is_cancelled) {
  auto recording = record::ReadRecording(request.recording);
  if (!recording.ok()) return recording.error();
  const double tick_seconds = recording->description.tick_seconds;
  const std::uint64_t first_tick = recording->FirstTick(), last_tick = recording->LastTick();
  const double until = std::min(request.until, static_cast<double>(last_tick) * tick_seconds);
  const double from = std::max(request.last_seconds > 0 ? until - request.last_seconds : request.from,
                               static_cast<double>(first_tick) * tick_seconds);
  if (until - from < 1.0 / kFramesPerSecond)
    return base::Error{base::ErrorCode::kUsage,
                       "the recording has nothing to show between these moments yet"};
  record::ReplaySettings settings;
  settings.threads = request.threads;
  settings.visit_seconds = 0;  // it is gone through once; the index is the replay window's
  progress.Set("Seeking", 0);
  auto replay = record::Replay::Open(std::move(*recording), settings);
  if (!replay.ok()) return replay.error();
  const auto goes_on = [&is_cancelled] { return !is_cancelled.load(); };
  const auto tick_at = [&](double time) {
    return std::clamp(static_cast<std::uint64_t>(std::llround(time / tick_seconds)), first_tick, last_tick);
  };
  if (const auto sought = replay->Seek(tick_at(from), goes_on); !sought.ok()) return sought.error();
  if (is_cancelled) return Cancelled();

  view::FilmSettings film_settings;
  film_settings.width = request.width, film_settings.height = request.height;
  film_settings.frames_per_second = kFramesPerSecond;
  film_settings.video = request.video;
  film_settings.view.has_force_arrows = false;
  const simulation::Simulation* simulation = &replay->GetSimulation();
  auto film = view::FilmMaker::Make(film_settings, {&simulation, 1});
  if (!film.ok()) return film.error();
  const auto frames = static_cast<std::uint64_t>(std::ceil((until - from) * kFramesPerSecond));
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const double time = from + static_cast<double>(frame) / kFramesPerSecond;
    if (const auto sought = replay->Seek(tick_at(time), goes_on); !sought.ok()) return sought.error();
    if (is_cancelled) return Cancelled();
    const view::FilmMaker::Side side{&simulation->GetSnapshot(), {}};
    if (const auto added = film->AddFrame({&side, 1}); !added.ok()) return added.error();
    progress.Set("Drawing", static_cast<double>(frame + 1) / static_cast<double>(frames));
  }
  if (const auto finished = film->Finish(); !finished.ok()) return finished.error();
  return Film{from, until, frames};
}

base::Status DrawMoment(const fs::path& recording, double time, const fs::path& picture, int threads,
                        const std::function<bool()>& goes_on) {
  auto read = record::ReadRecording(recording);
  if (!read.ok()) return read.error();
  const auto tick =
      static_cast<std::uint64_t>(std::max(0.0, std::round(time / read->description.tick_seconds)));
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.index = record::IndexPathOf(recording);
  settings.visit_seconds = 0;
  auto replay = record::Replay::Open(std::move(*read), settings);
  if (!replay.ok()) return replay.error();
  if (const auto sought = replay->Seek(tick, goes_on); !sought.ok()) return sought.error();
  if (goes_on && !goes_on()) return Cancelled();
  const simulation::Simulation& simulation = replay->GetSimulation();
  auto context = render::OffscreenContext::Make();
  if (!context.ok()) return context.error();
  auto target = render::OffscreenTarget::Make(kMomentWidth, kMomentHeight);
  if (!target.ok()) return target.error();
  auto view = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                          simulation.GetSnapshot(), simulation.Strands());
  if (!view.ok()) return view.error();
  view->Update(simulation.GetSnapshot());
  target->Bind();
  view->Draw(target->Width(), target->Height());
  render::Image image;
  target->Read(image);
  if (const auto failure = host::MakeFolders(picture.parent_path())) {
    return base::Error{base::ErrorCode::kFileUnwritable,
                       picture.string() + " cannot be written: " + failure.message() + "; check the folder"};
  }
  return render::WritePng(picture, image);
}

fs::path PictureFolder(const fs::path& pictures) {
  return pictures.empty() ? host::FindUserDataFolder() / "pictures" : pictures / "Trocar";
}

fs::path NamePicture(const fs::path& folder, std::chrono::system_clock::time_point now,
                     const std::string& ending) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  std::tm local{};
  ::localtime_r(&seconds, &local);
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "trocar-%Y-%m-%d-%H%M%S", &local);
  fs::path path = folder / (text.data() + ending);
  std::error_code ignored;
  for (int n = 2; fs::exists(path, ignored); ++n)
    path = folder / (text.data() + ("-" + std::to_string(n)) + ending);
  return path;
}

}  // namespace trocar::presenter
