// SPDX-License-Identifier: Apache-2.0
/// \file threads.h  Threads of the standard library for the engine's tests, which link no library of threads.
#pragma once

#include <memory>
#include <thread>
#include <vector>

#include "trocar/base/threads.h"

namespace trocar::test {

/// Starts threads anew each time.
class StandardCrew final : public base::Crew {
 public:
  explicit StandardCrew(int count) : count_(count) {}

  void Begin(Serve serve, void* context) noexcept override {
    for (int member = 1; member < count_; ++member) members_.emplace_back([=] { serve(context, member); });
  }

  void End() noexcept override {
    for (std::thread& member : members_) member.join();
    members_.clear();
  }

 private:
  int count_;
  std::vector<std::thread> members_;
};

/// `count` threads; the caller alone where there are none, as in a browser without them.
inline base::Threads UseThreads([[maybe_unused]] int count) {
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
  return {};
#else
  return {count,
          [](int members) -> std::unique_ptr<base::Crew> { return std::make_unique<StandardCrew>(members); }};
#endif
}

}  // namespace trocar::test
