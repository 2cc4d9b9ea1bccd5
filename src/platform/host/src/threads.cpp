// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/threads.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <optional>

namespace trocar::host {
namespace {

class TbbCrew final : public base::Crew {
 public:
  explicit TbbCrew(int count) : count_(count), arena_(count) {
    if (count > tbb::info::default_concurrency())
      more_workers_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
    arena_.initialize();
  }

  ~TbbCrew() noexcept override = default;

  void Begin(Serve serve, void* context) noexcept override {
    arena_.execute([&] {
      for (int member = 1; member < count_; ++member) group_.run([=] { serve(context, member); });
    });
  }

  void End() noexcept override {
    arena_.execute([this] { group_.wait(); });
  }

 private:
  int count_;
  std::optional<tbb::global_control> more_workers_;  // when more threads are asked for than there are cores
  tbb::task_arena arena_;
  tbb::task_group group_;
};

std::unique_ptr<base::Crew> MakeTbbCrew(int count) {
  return std::make_unique<TbbCrew>(count);
}

}  // namespace

base::Threads UseThreads(int count) noexcept {
  return {std::max(1, count), MakeTbbCrew};
}

}  // namespace trocar::host
