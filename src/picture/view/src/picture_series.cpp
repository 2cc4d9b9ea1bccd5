// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/picture_series.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/base/state_archive.h"
#include "trocar/base/statistics.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/state_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/threads.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"

namespace trocar::view {
namespace {

using cholecystectomy::Phase;
using simulation::Snapshot;

constexpr double kLongestSitting = 900.0;  // s; no scripted attempt takes as long
constexpr std::uint64_t kSeed = 1;

template <int kSeconds>
bool IsLaterThan(const Snapshot& now) {
  return now.time >= kSeconds;
}
template <Phase kPhase>
bool IsIn(const Snapshot& now) {
  return now.operation.procedure.phase == static_cast<std::uint8_t>(kPhase);
}
bool HasCurrent(const Snapshot& now) {
  return now.operation.has_current[0] || now.operation.has_current[1];
}
bool BurnsInTriangle(const Snapshot& now) {
  return HasCurrent(now) && IsIn<Phase::kCalotTriangleDissection>(now) &&
         now.operation.procedure.Measure(cholecystectomy::kClearedShare) > 0.3;
}
template <int kClips>
bool HasClips(const Snapshot& now) {
  return now.operation.clip_count >= kClips;
}
template <int kCuts>
bool HasCuts(const Snapshot& now) {
  return now.operation.tube_cut_count >= kCuts;
}
template <int kPercent>
bool IsDetached(const Snapshot& now) {
  return now.operation.procedure.Measure(cholecystectomy::kDetachedShare) >= 0.01 * kPercent;
}
bool IsCriticalView(const Snapshot& now) {
  return now.operation.procedure.view.AreCriteriaWhole();
}
bool IsFree(const Snapshot& now) {
  return now.operation.is_organ_free;
}
bool IsInBag(const Snapshot& now) {
  return now.operation.is_in_bag;
}
bool IsRinsing(const Snapshot& now) {
  return now.operation.is_rinsing[instrument::kRight];
}
template <int kStones>
bool HasSpilled(const Snapshot& now) {
  const auto& stones = now.operation.stones;
  return std::count_if(stones.begin(), stones.end(), [](const surgery::StoneSnapshot& stone) {
           return stone.place == surgery::StonePlace::kSpilled;
         }) >= kStones;
}
bool Bleeds(const Snapshot& now) {
  const auto leaks = std::span(now.operation.flow.leaks).first(now.operation.flow.leak_count);
  return std::any_of(leaks.begin(), leaks.end(), [](const surgery::LeakSnapshot& leak) {
    return leak.fluid == surgery::Fluid::kBlood && leak.rate > 1e-7;
  });
}

/// A target in a context, which pictures of all sittings share.
struct Easel {
  render::OffscreenContext context;
  render::OffscreenTarget target;
};

/// One attempt, its view, and which moments are still to come.
class Sitting {
 public:
  static base::Result<Sitting> Make(const SeriesSitting& plan, const SeriesOptions& options) {
    auto found = files::FindScene(plan.task, {"normal", kSeed, {}});
    if (!found) return found.error();
    const auto scene = std::make_shared<const scene::Scene>(std::move(*found));
    auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(options.threads)});
    if (!simulation) return simulation.error();
    auto surgeon = agent::MakeSurgeon(plan.surgeon, scene, kSeed);
    if (!surgeon) return surgeon.error();
    auto view = LaparoscopeView::Make(*scene, simulation->Surfaces(), simulation->GetSnapshot(),
                                      simulation->Strands());
    if (!view) return view.error();
    view->SetOptions(options.view);
    return Sitting(std::string(plan.surgeon) + ", seed " + std::to_string(kSeed), scene,
                   std::move(*simulation), std::move(*surgeon), std::move(*view));
  }

  /// From a kept state, or by playing on from where it is.
  base::Status GoTo(const SeriesShot& shot, const SeriesOptions& options) {
    const auto kept = options.moments / (std::string(shot.name) + ".state");
    std::error_code ignored;
    if (!options.moments.empty() && std::filesystem::exists(kept, ignored)) return TakeUp(kept);
    if (auto status = Play(shot, options); !status) return status;
    if (options.moments.empty()) return {};
    std::filesystem::create_directories(options.moments, ignored);
    return Keep(kept);
  }

  SeriesPicture Draw(const SeriesShot& shot, const SeriesOptions& options, Easel& easel,
                     render::Image& image) {
    std::vector<double> seconds;
    for (int i = 0; i < std::max(1, options.draws); ++i) {
      const host::Stopwatch watch;
      view_.Update(simulation_.GetSnapshot());
      easel.target.Bind();
      view_.Draw(options.width, options.height);
      easel.target.Read(image);
      seconds.push_back(watch.Seconds());
    }
    return {shot.name, shot.about, simulation_.GetSnapshot().time, base::CalcPercentile(seconds, 0.5)};
  }

 private:
  Sitting(std::string who, std::shared_ptr<const scene::Scene> scene, simulation::Simulation simulation,
          std::unique_ptr<agent::Surgeon> surgeon, LaparoscopeView view)
      : who_(std::move(who)),
        scene_(std::move(scene)),
        simulation_(std::move(simulation)),
        surgeon_(std::move(surgeon)),
        view_(std::move(view)) {}

  /// As `trocar play --save` writes it: the surgeon can go on from there.
  base::Status Keep(const std::filesystem::path& path) {
    std::vector<std::byte> player;
    base::StateArchive archive = base::StateArchive::ForSave(player);
    archive.Field("who", who_);
    surgeon_->VisitState(archive);
    return files::WriteStateFile(path, simulation_, player);
  }

  base::Status TakeUp(const std::filesystem::path& path) {
    const auto player = files::ReadStateFile(path, simulation_);
    if (!player) return player.error();
    base::StateArchive archive = base::StateArchive::ForRestore(*player);
    std::string who;
    archive.Field("who", who);
    if (who == who_) surgeon_->VisitState(archive);
    if (archive.ok() && archive.IsAtEnd()) return {};
    return base::Error{base::ErrorCode::kStateInvalid,
                       path.string() + " was kept by another surgeon; remove it, and it is made again"};
  }

  base::Status Play(const SeriesShot& shot, const SeriesOptions& options) {
    std::optional<double> moment;
    for (;;) {
      const Snapshot& now = simulation_.GetSnapshot();
      if (!moment && shot.has_come(now)) moment = now.time + shot.delay;
      if (moment && now.time >= *moment) return {};
      if (surgeon_->HasFinished() || now.time > kLongestSitting) {
        return base::Error{base::ErrorCode::kScriptInvalid,
                           std::string("the moment of ") + shot.name + " never came; the scripted surgeon " +
                               "has changed, so the series needs another moment"};
      }
      if (options.on_progress && now.tick % 60 == 0)
        options.on_progress(
            -1, std::string(shot.name) + ", " + std::to_string(static_cast<int>(now.time)) + " s");
      simulation_.Step(surgeon_->Act(now));
    }
  }

  std::string who_;
  std::shared_ptr<const scene::Scene> scene_;
  simulation::Simulation simulation_;
  std::unique_ptr<agent::Surgeon> surgeon_;
  LaparoscopeView view_;
};

}  // namespace

std::vector<SeriesSitting> ListPictureSeries() {
  return {
      {"cholecystectomy",
       "expert",
       {{"01-preparation", "the first look: gallbladder, liver and omentum", IsLaterThan<0>, 0.4},
        {"02-traction", "the fundus is held up, a hand takes the infundibulum",
         IsIn<Phase::kCalotTriangleDissection>, 3},
        {"03-triangle", "the hook divides fat and strands of the hepatocystic triangle", BurnsInTriangle,
         0.3},
        {"04-critical-view", "two structures enter the gallbladder, the lower bed is free", IsCriticalView,
         1},
        {"05-clip-applier", "the first clip is closed on the cystic duct", HasClips<1>, 0.5},
        {"06-clips", "clips on duct and artery", HasClips<5>, 1.0},
        {"07-scissors", "the cystic duct is divided", HasCuts<1>, 0.4},
        {"08-bed", "the gallbladder is taken off its bed", IsDetached<45>, 0.5},
        {"09-free", "the gallbladder is free, the bed lies open", IsFree, 0.5},
        {"10-bag", "the gallbladder is in the bag", IsInBag, 0.5}}},
      {"cholecystectomy",
       "rinses",
       {{"11-rinsing", "water on the field while the artery bleeds", IsRinsing, 2}}},
      {"cholecystectomy", "bleeds", {{"12-bleeding", "an accident: the cystic artery bleeds", Bleeds, 35}}},
      {"camera_navigation_30",
       "expert",
       {{"13-camera-navigation", "camera navigation with 30 degrees", IsLaterThan<6>}}},
      {"instrument_navigation",
       "expert",
       {{"14-instrument-navigation", "instrument navigation", IsLaterThan<6>}}},
      {"lift_and_grasp", "expert", {{"15-lift-and-grasp", "lift and grasp", IsLaterThan<4>}}},
      {"peg_transfer", "expert", {{"16-peg-transfer", "peg transfer: a ring changes hands", IsLaterThan<7>}}},
      {"wire_run", "expert", {{"17-wire-run", "a ring along a wire", IsLaterThan<9>}}},
      {"pattern_cut", "expert", {{"18-pattern-cut", "pattern cut", IsLaterThan<6>}}},
      {"clip_and_cut", "expert", {{"19-clip-and-cut", "clip and cut", IsLaterThan<6>}}},
      {"hook_dissection", "expert", {{"20-hook-dissection", "hook dissection", IsLaterThan<6>}}},
      {"camera_navigation_0",
       "expert",
       {{"21-straight-camera-navigation", "camera navigation with a straight scope", IsLaterThan<6>}}},
      {"object_transport",
       "expert",
       {{"22-object-transport", "transport of a thing from hand to hand", IsLaterThan<7>}}},
      {"cholecystectomy",
       "leaves_stones",
       {{"23-spilled-stones", "an accident: stones come out of the gallbladder with its bile",
         HasSpilled<2>}}}};
}

base::Result<std::vector<SeriesPicture>> MakePictureSeries(const SeriesOptions& options) {
  if (options.width < 16 || options.width > 4096 || options.height < 16 || options.height > 4096)
    return base::Error{base::ErrorCode::kUsage, "a picture must have 16 to 4096 pixels a side"};
  std::vector<SeriesSitting> series = ListPictureSeries();
  std::size_t all = 0;
  for (SeriesSitting& sitting : series) {
    std::erase_if(sitting.shots,
                  [&](const SeriesShot& shot) { return !options.only.empty() && options.only != shot.name; });
    all += sitting.shots.size();
  }
  if (all == 0) {
    return base::Error{base::ErrorCode::kUsage,
                       "there is no picture \"" + options.only + "\"; trocar pictures --list names all"};
  }
  auto context = render::OffscreenContext::Make();
  if (!context) return context.error();
  auto target = render::OffscreenTarget::Make(options.width, options.height);
  if (!target) return target.error();
  Easel easel{std::move(*context), std::move(*target)};
  std::vector<SeriesPicture> pictures;
  SeriesOptions told = options;
  told.on_progress = [&](double /*share*/, std::string_view doing) {
    if (options.on_progress)
      options.on_progress(static_cast<double>(pictures.size()) / static_cast<double>(all), doing);
  };
  render::Image image;
  for (const SeriesSitting& plan : series) {
    if (plan.shots.empty()) continue;
    auto sitting = Sitting::Make(plan, told);
    if (!sitting) return sitting.error();
    for (const SeriesShot& shot : plan.shots) {
      if (auto status = sitting->GoTo(shot, told); !status) {
        if (status.error().code != base::ErrorCode::kScriptInvalid) return status.error();
        // the others are worth having
        pictures.push_back({shot.name, status.error().message, 0, 0, false});
        continue;
      }
      pictures.push_back(sitting->Draw(shot, told, easel, image));
      const auto path = options.output / (std::string(shot.name) + ".png");
      if (auto status = render::WritePng(path, image); !status) return status.error();
      told.on_progress(0, shot.name);
    }
  }
  return pictures;
}

}  // namespace trocar::view
