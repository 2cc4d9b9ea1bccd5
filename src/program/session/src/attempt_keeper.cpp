// SPDX-License-Identifier: Apache-2.0
#include "attempt_keeper.h"

#include <array>
#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "trocar/host/log.h"

namespace trocar::session {
namespace {

/// A shorter attempt is a look at the scene.
constexpr double kShortestAttempt = 1.0;  // s
/// Of the indexes of all attempts; the oldest go first.
constexpr std::uint64_t kIndexBytes = std::uint64_t{2} << 30;

/// "2026-11-24_225020_peg_transfer.trocar"; a number makes it one that there is not yet.
std::filesystem::path MakeName(const AttemptKeeping& keeping) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  std::array<char, 32> time{};
  std::strftime(time.data(), time.size(), "%Y-%m-%d_%H%M%S_", &local);
  const std::string name = time.data() + std::filesystem::path(keeping.description.name).stem().string();
  for (int number = 1;; ++number) {
    const auto path = keeping.folder / (name + (number == 1 ? "" : "_" + std::to_string(number)) + ".trocar");
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return path;
  }
}

}  // namespace

void AttemptKeeper::BeforeStep(const simulation::Simulation& simulation, bool is_demonstration) {
  if (!keeping_ || recorder_ != nullptr || has_failed_ || is_closed_) return;
  record::Description description = keeping_->description;
  if (is_demonstration) description.player = "the demonstration";
  if (simulation.GetSnapshot().tick != description.branched_tick) {
    // begun anew: it goes on from nothing
    description.branched_from.clear();
    description.branched_id = description.branched_tick = 0;
  }
  record::TrimIndexes(keeping_->folder, kIndexBytes);
  record::RecorderSettings settings;
  settings.index_seconds = record::kIndexSeconds;
  auto recorder =
      record::Recorder::Start(MakeName(*keeping_), std::move(description), simulation, std::move(settings));
  if (recorder.ok()) {
    const std::filesystem::path path = (*recorder)->Status().path;
    {
      const std::lock_guard lock(mutex_);
      recorder_ = std::move(*recorder);
    }
    if (keeping_->on_begin) keeping_->on_begin(path);
    if (keeping_->watch) watch_ = keeping_->watch(path, simulation);
    return;
  }
  const std::lock_guard lock(mutex_);
  has_failed_ = true;
  last_ = record::RecorderStatus{};
  last_->failure = recorder.error();
  host::Log(host::LogLevel::kWarning, "attempts are not recorded: " + recorder.error().Text());
}

void AttemptKeeper::End(const simulation::Simulation& simulation) {
  if (recorder_ == nullptr) return;
  const bool is_short =
      static_cast<double>(recorder_->Status().added) * simulation.GetScene().tick_seconds < kShortestAttempt;
  const base::Status finished = recorder_->Finish(simulation);
  if (!finished.ok())
    host::Log(host::LogLevel::kWarning, "the recording is not whole: " + finished.error().Text());
  std::filesystem::path path;
  {
    const std::lock_guard lock(mutex_);
    last_ = recorder_->Status();
    recorder_.reset();
    path = last_->path;
  }
  if (is_short) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(record::IndexPathOf(path), ignored);
  }
  if (watch_.end) watch_.end(finished.ok());
  watch_ = {};
  if (keeping_->on_end) keeping_->on_end(path);
}

std::optional<record::RecorderStatus> AttemptKeeper::Status() const {
  const std::lock_guard lock(mutex_);
  return recorder_ != nullptr ? recorder_->Status() : last_;
}

}  // namespace trocar::session
