// SPDX-License-Identifier: Apache-2.0
#include "trocar/dataset/dataset.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <memory>
#include <mutex>
#include <thread>

#include "data_card.h"
#include "layout_set.h"
#include "trocar/host/clock.h"
#include "trocar/host/partial_path.h"

namespace trocar::dataset {
namespace {

constexpr std::uint64_t kMostVideos = 100'000;

std::unique_ptr<LayoutSet> MakeLayout(Layout layout) {
  switch (layout) {
    case Layout::kCholecSeg8k:
      return MakeCholecSeg8k();
    case Layout::kCholec80:
      return MakeCholec80();
    case Layout::kCholecT50:
      return MakeCholecT50();
    case Layout::kEndoscapes:
      return MakeEndoscapes();
    case Layout::kTrocar:
      return MakeTrocar();
  }
  return nullptr;
}

base::Status CheckPlan(const Plan& plan) {
  const auto refuse = [](const char* what) { return base::Error{base::ErrorCode::kUsage, what}; };
  if (plan.last_seed < plan.first_seed || plan.last_seed - plan.first_seed >= kMostVideos)
    return refuse("seeds are FIRST:LAST, both included, at most 100,000 of them");
  if (plan.width < 16 || plan.width > 4096 || plan.height < 16 || plan.height > 4096)
    return refuse("a picture must have 16 to 4096 pixels a side");
  if (!(plan.every >= 0.04 && plan.every <= 60)) return refuse("frames are 0.04 to 60 s apart");
  if (!(plan.most_seconds > 0)) return refuse("a video lasts longer than 0 s");
  if (!plan.has_pictures && plan.layout != Layout::kTrocar)
    return refuse(
        "only the layout trocar holds something besides pictures: --no-pictures needs --layout trocar");
  const bool has_seconds = plan.layout == Layout::kCholec80 || plan.layout == Layout::kCholecT50;
  if (has_seconds && plan.every != 1.0)
    return refuse("cholec80 and cholect50 have one frame a second: --every 1");
  return {};
}

/// Videos by number, each on one of the threads.
class Factory {
 public:
  Factory(const Plan& plan, LayoutSet& layout, std::filesystem::path folder,
          const std::function<void(double, std::string_view)>& on_progress)
      : plan_(plan),
        layout_(layout),
        folder_(std::move(folder)),
        on_progress_(on_progress),
        videos_(plan.last_seed - plan.first_seed + 1) {}

  base::Result<std::vector<VideoResult>> Run() {
    {
      std::vector<std::jthread> threads;
      const auto jobs =
          std::min<std::size_t>(static_cast<std::size_t>(std::max(1, plan_.jobs)), videos_.size());
      for (std::size_t i = 0; i < jobs; ++i) threads.emplace_back([this] { Work(); });
    }
    if (!status_) return status_.error();
    return std::move(videos_);
  }

 private:
  void Work() {
    for (std::size_t i = next_++; i < videos_.size() && !has_failed_; i = next_++) {
      auto video = MakeVideo({&plan_, i, folder_}, [&](const simulation::Simulation& simulation) {
        return layout_.MakeWriter({&plan_, i, folder_}, simulation);
      });
      const std::scoped_lock lock(mutex_);
      if (!video) {
        // the first in order is told, whichever thread was faster
        if (status_.ok() || i < failed_) status_ = video.error(), failed_ = i;
        has_failed_ = true;
        continue;
      }
      videos_[i] = std::move(*video);
      ++done_;
      if (on_progress_)
        on_progress_(static_cast<double>(done_) / static_cast<double>(videos_.size()),
                     (plan_.recordings.empty() ? "seed " : "recording ") + std::to_string(videos_[i].seed));
    }
  }

  const Plan& plan_;
  LayoutSet& layout_;
  std::filesystem::path folder_;
  const std::function<void(double, std::string_view)>& on_progress_;
  std::vector<VideoResult> videos_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> has_failed_{false};
  std::mutex mutex_;
  std::size_t done_ = 0, failed_ = 0;
  base::Status status_;
};

base::Error Unwritable(const std::filesystem::path& path, const std::string& why) {
  return {base::ErrorCode::kFileUnwritable, path.string() + ": " + why};
}

}  // namespace

std::string_view NameOf(Layout layout) noexcept {
  constexpr std::array<std::string_view, kLayouts.size()> kNames = {"cholecseg8k", "cholec80", "cholect50",
                                                                    "endoscapes", "trocar"};
  return kNames[static_cast<std::size_t>(layout)];
}
std::optional<Layout> FindLayout(std::string_view name) noexcept {
  const auto found =
      std::find_if(kLayouts.begin(), kLayouts.end(), [&](Layout l) { return NameOf(l) == name; });
  return found == kLayouts.end() ? std::nullopt : std::optional(*found);
}

std::string NameVideo(const char* prefix, std::uint64_t seed, int digits) {
  std::string number = std::to_string(seed);
  if (number.size() < static_cast<std::size_t>(digits))
    number.insert(0, static_cast<std::size_t>(digits) - number.size(), '0');
  return prefix + number;
}

base::Result<Summary> WriteDataset(
    const Plan& wanted, const std::filesystem::path& output,
    const std::function<void(double share, std::string_view doing)>& on_progress) {
  namespace fs = std::filesystem;
  Plan plan = wanted;
  if (!plan.recordings.empty()) plan.first_seed = 1, plan.last_seed = plan.recordings.size();
  if (const auto status = CheckPlan(plan); !status) return status.error();
  std::error_code failure;
  if (fs::exists(output, failure) && !fs::is_empty(output, failure))
    return Unwritable(
        output, "it holds something already; a data set is never mixed with another: name a new folder");
  const host::Stopwatch watch;
  host::PartialPath part(output);
  fs::create_directories(part.Path(), failure);
  if (failure)
    return Unwritable(part.Path(), failure.message() + "; check the folder, its rights and the space left");
  const auto layout = MakeLayout(plan.layout);
  const auto videos = Factory(plan, *layout, part.Path(), on_progress).Run();
  if (!videos) return videos.error();
  if (const auto status = layout->Finish(part.Path()); !status) return status.error();
  const auto card = WriteCard(part.Path(), plan, *layout, *videos);
  if (!card) return card.error();
  fs::remove(output, failure);  // the empty folder
  fs::rename(part.Path(), output, failure);
  if (failure) return Unwritable(output, failure.message() + "; check the folder and its rights");
  Summary summary{videos->size(), 0, card->files, watch.Seconds(), card->hash};
  for (const VideoResult& video : *videos) summary.frames += video.frames;
  return summary;
}

}  // namespace trocar::dataset
