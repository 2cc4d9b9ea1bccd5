// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/background_job.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>

namespace trocar::gui {
namespace {

TEST(BackgroundJob, GivesItsOutcomeOnce) {
  std::promise<void> done;
  BackgroundJob<std::unique_ptr<int>> job([&] { done.set_value(); });
  EXPECT_FALSE(job.IsRunning());
  job.Start([] { return std::make_unique<int>(7); });
  done.get_future().wait();
  EXPECT_TRUE(job.IsRunning()) << "until it is taken";
  EXPECT_EQ(*job.Take(), 7);
  EXPECT_FALSE(job.IsRunning());
}

TEST(BackgroundJob, RunsAgain) {
  BackgroundJob<int> job([] {});
  for (int i = 0; i < 3; ++i) {
    job.Start([i] { return i; });
    EXPECT_EQ(job.Take(), i);
  }
}

TEST(BackgroundJob, IsWaitedForAtTheEnd) {
  std::atomic<bool> has_ended = false;
  std::promise<void> go;
  {
    BackgroundJob<int> job([&] { has_ended = true; });
    job.Start([&] {
      go.get_future().wait();
      return 0;
    });
    go.set_value();
  }
  EXPECT_TRUE(has_ended);
}

TEST(JobProgress, SaysTheNewest) {
  JobProgress progress;
  progress.Set("reading", 0.25);
  progress.Set("meshing", 0.5);
  EXPECT_EQ(progress.Get().what, "meshing");
  EXPECT_EQ(progress.Get().fraction, 0.5);
}

}  // namespace
}  // namespace trocar::gui
