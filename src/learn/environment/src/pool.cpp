// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/pool.h"

#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "trocar/base/assert.h"

namespace trocar::environment {
namespace {

base::Error WrongState(const std::string& what) {
  return base::Error{base::ErrorCode::kEnvironmentState, what};
}

}  // namespace

struct Pool::Content {
  enum class Work : std::uint8_t { kReset, kStep };
  /// One environment and what it is told to do. Only the thread that has its job touches it.
  struct Slot {
    std::optional<Environment> environment;
    Work work = Work::kReset;
    std::vector<double> action;
    std::optional<std::uint64_t> seed;
    bool is_at_work = false, has_begun = false;  // guarded by `mutex`
    base::Status status;
  };

  std::shared_ptr<EnvironmentModel> model;
  PoolSettings settings;
  PoolRows rows;
  std::vector<Slot> slots;
  ::pid_t process = ::getpid();

  std::mutex mutex;
  std::condition_variable has_job, has_results;
  std::vector<std::deque<std::int32_t>> jobs;  ///< of each thread, which others take where it is busy
  std::deque<std::int32_t> done;
  std::size_t at_work = 0;
  std::size_t wanted = 0;  ///< results that Receive waits for
  bool is_ending = false;
  std::vector<std::thread> threads;

  std::span<float> StateRow(std::vector<float>& all, std::int32_t id) const {
    const std::size_t size = model->StateSize();
    return std::span(all).subspan(static_cast<std::size_t>(id) * size, size);
  }
  base::Status Observe(std::int32_t id, std::vector<float>& rows_of_states, bool is_final);
  base::Status DoReset(std::int32_t id, std::optional<std::uint64_t> seed);
  base::Status DoStep(std::int32_t id);
  std::optional<std::int32_t> TakeJob(std::size_t thread);
  void Serve(std::size_t thread);
  base::Status CheckProcess() const;
  base::Result<std::vector<std::int32_t>> Choose(std::span<const std::int32_t> ids) const;
  void HandOver(std::span<const std::int32_t> ids);
};

base::Status Pool::Content::Observe(std::int32_t id, std::vector<float>& rows_of_states, bool is_final) {
  const Environment& environment = *slots[static_cast<std::size_t>(id)].environment;
  environment.Observe(StateRow(rows_of_states, id));
  return settings.observe ? settings.observe(id, environment, is_final) : base::Status{};
}

base::Status Pool::Content::DoReset(std::int32_t id, std::optional<std::uint64_t> seed) {
  const auto row = static_cast<std::size_t>(id);
  Slot& slot = slots[row];
  if (const auto reset = slot.environment->Reset(seed); !reset) return reset;
  rows.layout[row] = slot.environment->Layout();
  rows.episode_seed[row] = slot.environment->EpisodeSeed();
  return Observe(id, rows.state, false);
}

base::Status Pool::Content::DoStep(std::int32_t id) {
  const auto row = static_cast<std::size_t>(id);
  Slot& slot = slots[row];
  const auto write = [&](const Outcome& outcome) {
    rows.reward[row] = outcome.reward;
    rows.terminated[row] = outcome.is_terminated;
    rows.truncated[row] = outcome.is_truncated;
    rows.success[row] = outcome.is_success;
    std::copy(outcome.features.begin(), outcome.features.end(),
              rows.features.begin() + static_cast<std::ptrdiff_t>(row * kFeatureCount));
  };
  rows.was_reset[row] = 0;
  if (slot.environment->IsOver() && settings.autoreset == Autoreset::kNextStep) {
    write({});
    rows.was_reset[row] = 1;
    return DoReset(id, {});
  }
  const auto outcome = slot.environment->Step(slot.action);
  if (!outcome) return outcome.error();
  write(*outcome);
  if (slot.environment->IsOver() && settings.autoreset == Autoreset::kSameStep) {
    if (const auto seen = Observe(id, rows.final_state, true); !seen) return seen;
    rows.was_reset[row] = 1;
    return DoReset(id, {});
  }
  return Observe(id, rows.state, false);
}

/// The thread's own oldest job, or the newest of whoever has most left. With `mutex` held.
std::optional<std::int32_t> Pool::Content::TakeJob(std::size_t thread) {
  if (std::deque<std::int32_t>& own = jobs[thread]; !own.empty()) {
    const std::int32_t id = own.front();
    own.pop_front();
    return id;
  }
  std::deque<std::int32_t>& most = *std::max_element(
      jobs.begin(), jobs.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (most.empty()) return {};
  const std::int32_t id = most.back();
  most.pop_back();
  return id;
}

void Pool::Content::Serve(std::size_t thread) {
  std::unique_lock lock(mutex);
  while (true) {
    std::optional<std::int32_t> job;
    has_job.wait(lock, [&] {
      job = TakeJob(thread);
      return is_ending || job;
    });
    if (!job) return;
    const std::int32_t id = *job;
    lock.unlock();
    Slot& slot = slots[static_cast<std::size_t>(id)];
    if (slot.work == Work::kReset) {
      const auto row = static_cast<std::size_t>(id);
      rows.reward[row] = 0;
      rows.terminated[row] = rows.truncated[row] = rows.success[row] = 0;
      std::fill_n(rows.features.begin() + static_cast<std::ptrdiff_t>(row * kFeatureCount), kFeatureCount,
                  0.0);
      rows.was_reset[row] = 1;
      slot.status = DoReset(id, slot.seed);
    } else {
      slot.status = DoStep(id);
    }
    lock.lock();
    done.push_back(id);
    if (done.size() >= wanted) has_results.notify_one();
  }
}

/// Before `mutex` is taken: in a fork a thread that did not come along may hold it for ever.
base::Status Pool::Content::CheckProcess() const {
  if (::getpid() == process) return {};
  return WrongState(
      "this pool was made by another process: its threads do not live on after a fork; make the pool in the "
      "process that uses it");
}

/// All of them where none is named. With `mutex` held.
base::Result<std::vector<std::int32_t>> Pool::Content::Choose(std::span<const std::int32_t> ids) const {
  std::vector<std::int32_t> chosen(ids.begin(), ids.end());
  if (chosen.empty()) {
    for (int id = 0; id < settings.count; ++id) chosen.push_back(id);
  }
  std::vector<bool> is_named(slots.size());
  for (const std::int32_t id : chosen) {
    if (id < 0 || id >= settings.count)
      return base::Error{base::ErrorCode::kUsage, "this pool has environments 0 to " +
                                                      std::to_string(settings.count - 1) + ", not " +
                                                      std::to_string(id)};
    const auto row = static_cast<std::size_t>(id);
    if (is_named[row])
      return base::Error{base::ErrorCode::kUsage, "environment " + std::to_string(id) + " is named twice"};
    is_named[row] = true;
    if (slots[row].is_at_work)
      return WrongState("environment " + std::to_string(id) + " is at work; receive its result first");
  }
  return chosen;
}

/// An environment goes to the same thread each time, whose cache still holds it. With `mutex` held.
void Pool::Content::HandOver(std::span<const std::int32_t> ids) {
  for (const std::int32_t id : ids) {
    const auto row = static_cast<std::size_t>(id);
    slots[row].is_at_work = true;
    jobs[row % jobs.size()].push_back(id);
  }
  at_work += ids.size();
  has_job.notify_all();
}

Pool::Pool(std::unique_ptr<Content> content) : content_(std::move(content)) {}

Pool::~Pool() {
  Content& now = *content_;
  if (::getpid() != now.process) {
    // the threads are the other process's, and what they wait on cannot be taken down here: its memory is left
    static_cast<void>(content_.release());
    return;
  }
  {
    const std::lock_guard lock(now.mutex);
    now.is_ending = true;
    now.has_job.notify_all();
  }
  for (std::thread& thread : now.threads) thread.join();
}

base::Result<std::unique_ptr<Pool>> Pool::Make(std::shared_ptr<EnvironmentModel> model,
                                               const PoolSettings& settings) {
  if (settings.count < 1 || settings.count > kMostEnvironments)
    return base::Error{base::ErrorCode::kUsage, "a pool has 1 to 4096 environments"};
  if (settings.threads < 0 || settings.threads > 1024)
    return base::Error{base::ErrorCode::kUsage, "a pool has 1 to 1024 threads, or 0 for as many as fit"};
  auto content = std::make_unique<Content>();
  Content& made = *content;
  made.model = std::move(model);
  made.settings = settings;
  const auto count = static_cast<std::size_t>(settings.count);
  made.slots.resize(count);
  for (Content::Slot& slot : made.slots) {
    auto environment = Environment::Make(made.model);
    if (!environment) return environment.error();
    slot.environment.emplace(std::move(*environment));
    slot.action.resize(made.model->ActionSize());
  }
  made.rows.state.resize(count * made.model->StateSize());
  made.rows.final_state.resize(made.rows.state.size());
  made.rows.reward.resize(count);
  made.rows.layout.resize(count);
  made.rows.episode_seed.resize(count);
  made.rows.features.resize(count * kFeatureCount);
  for (auto* flags : {&made.rows.terminated, &made.rows.truncated, &made.rows.success, &made.rows.was_reset})
    flags->resize(count);
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = settings.threads > 0 ? settings.threads : std::min(settings.count, cores);
  made.jobs.resize(static_cast<std::size_t>(threads));
  for (std::size_t i = 0; i < made.jobs.size(); ++i) made.threads.emplace_back([&made, i] { made.Serve(i); });
  return std::unique_ptr<Pool>(new Pool(std::move(content)));
}

int Pool::Count() const {
  return content_->settings.count;
}
int Pool::ThreadCount() const {
  return static_cast<int>(content_->threads.size());
}
const EnvironmentModel& Pool::Model() const {
  return *content_->model;
}
const PoolRows& Pool::Rows() const {
  return content_->rows;
}

base::Status Pool::Reset(std::span<const std::int32_t> ids, std::optional<std::uint64_t> seed) {
  std::vector<std::optional<std::uint64_t>> seeds(ids.empty() ? static_cast<std::size_t>(Count())
                                                              : ids.size());
  for (std::size_t i = 0; seed && i < seeds.size(); ++i)
    seeds[i] = *seed + (ids.empty() ? i : static_cast<std::uint64_t>(ids[i]));
  return ResetEach(ids, seeds);
}

base::Status Pool::ResetEach(std::span<const std::int32_t> ids,
                             std::span<const std::optional<std::uint64_t>> seeds) {
  Content& now = *content_;
  if (const auto checked = now.CheckProcess(); !checked) return checked;
  const std::lock_guard lock(now.mutex);
  const auto chosen = now.Choose(ids);
  if (!chosen) return chosen.error();
  if (seeds.size() != chosen->size()) {
    return base::Error{base::ErrorCode::kUsage, std::to_string(chosen->size()) +
                                                    " environments are reset with as many seeds, not " +
                                                    std::to_string(seeds.size())};
  }
  for (std::size_t i = 0; i < chosen->size(); ++i) {
    const std::int32_t id = (*chosen)[i];
    Content::Slot& slot = now.slots[static_cast<std::size_t>(id)];
    slot.work = Content::Work::kReset;
    slot.seed = seeds[i];
    if (!slot.seed && !slot.has_begun) slot.seed = now.settings.seed + static_cast<std::uint64_t>(id);
    slot.has_begun = true;
  }
  now.HandOver(*chosen);
  return {};
}

base::Status Pool::Send(std::span<const double> actions, std::span<const std::int32_t> ids) {
  Content& now = *content_;
  if (const auto checked = now.CheckProcess(); !checked) return checked;
  const std::size_t size = now.model->ActionSize();
  const std::lock_guard lock(now.mutex);
  const auto chosen = now.Choose(ids);
  if (!chosen) return chosen.error();
  if (actions.size() != chosen->size() * size) {
    return base::Error{base::ErrorCode::kActionInvalid,
                       "actions for " + std::to_string(chosen->size()) + " environments are " +
                           std::to_string(chosen->size()) + " x " + std::to_string(size) + " numbers, not " +
                           std::to_string(actions.size())};
  }
  for (std::size_t i = 0; i < chosen->size(); ++i) {
    const std::int32_t id = (*chosen)[i];
    Content::Slot& slot = now.slots[static_cast<std::size_t>(id)];
    if (!slot.has_begun) return WrongState("environment " + std::to_string(id) + " has not been reset");
    if (slot.environment->IsOver() && now.settings.autoreset == Autoreset::kDisabled)
      return WrongState("the episode of environment " + std::to_string(id) +
                        " is over and this pool does not reset by itself; reset it");
    if (const auto checked = now.model->CheckAction(actions.subspan(i * size, size)); !checked) {
      return base::Error{checked.error().code,
                         "environment " + std::to_string(id) + ": " + checked.error().message};
    }
  }
  for (std::size_t i = 0; i < chosen->size(); ++i) {
    Content::Slot& slot = now.slots[static_cast<std::size_t>((*chosen)[i])];
    slot.work = Content::Work::kStep;
    const auto action = actions.subspan(i * size, size);
    std::copy(action.begin(), action.end(), slot.action.begin());
  }
  now.HandOver(*chosen);
  return {};
}

base::Status Pool::Receive(std::size_t count, std::vector<std::int32_t>& ids) {
  Content& now = *content_;
  ids.clear();
  if (const auto checked = now.CheckProcess(); !checked) return checked;
  std::unique_lock lock(now.mutex);
  if (count == 0 || count > now.at_work) {
    return WrongState(std::to_string(now.at_work) + " environments are at work, and results of " +
                      std::to_string(count) + " were asked for; send actions first");
  }
  now.wanted = count;
  now.has_results.wait(lock, [&] { return now.done.size() >= count; });
  ids.assign(now.done.begin(), now.done.begin() + static_cast<std::ptrdiff_t>(count));
  now.done.erase(now.done.begin(), now.done.begin() + static_cast<std::ptrdiff_t>(count));
  std::sort(ids.begin(), ids.end());
  now.at_work -= count;
  base::Status status;
  for (const std::int32_t id : ids) {
    Content::Slot& slot = now.slots[static_cast<std::size_t>(id)];
    slot.is_at_work = false;
    if (status.ok() && !slot.status.ok()) status = slot.status;
  }
  return status;
}

base::Result<const Environment*> Pool::Look(std::int32_t id) const {
  if (const auto checked = content_->CheckProcess(); !checked) return checked.error();
  const std::lock_guard lock(content_->mutex);
  const auto chosen = content_->Choose(std::span(&id, 1));
  if (!chosen.ok()) return chosen.error();
  return &*content_->slots[static_cast<std::size_t>(id)].environment;
}

base::Status Pool::SetRanges(std::span<const std::int32_t> ids, const Ranges& ranges) {
  if (const auto checked = content_->CheckProcess(); !checked) return checked;
  const std::lock_guard lock(content_->mutex);
  const auto chosen = content_->Choose(ids);
  if (!chosen.ok()) return chosen.error();
  for (const std::int32_t id : *chosen) {
    Environment& environment = *content_->slots[static_cast<std::size_t>(id)].environment;
    if (const auto set = environment.SetRanges(ranges); !set) return set;
  }
  return {};
}

std::size_t Pool::AtWork() const {
  if (!content_->CheckProcess()) return 0;
  const std::lock_guard lock(content_->mutex);
  return content_->at_work;
}

}  // namespace trocar::environment
