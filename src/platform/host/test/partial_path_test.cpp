// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/partial_path.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::host {
namespace {

namespace fs = std::filesystem;

/// Names of what lies in the folder.
std::string List(const fs::path& folder) {
  std::string names;
  for (const auto& entry : fs::directory_iterator(folder)) names += entry.path().filename().string() + " ";
  return names;
}

/// Fills a partial folder, and a folder in it.
void Fill(const fs::path& folder) {
  fs::create_directories(folder / "a/b");
  for (int i = 0; i < 200; ++i) std::ofstream(folder / "a" / ("file" + std::to_string(i))) << "x";
  std::ofstream(folder / "a/b/last") << "x";
}

TEST(PartialPath, IsGoneUnlessItWasRenamed) {
  const test::TemporaryFolder folder;
  {
    const PartialPath partial(folder.Path() / "given up");
    Fill(partial.Path());
    EXPECT_NE(List(folder.Path()), "");
  }
  EXPECT_EQ(List(folder.Path()), "");
  {
    const PartialPath partial(folder.Path() / "whole/");
    Fill(partial.Path());
    fs::rename(partial.Path(), folder.Path() / "whole");
  }
  EXPECT_EQ(List(folder.Path()), "whole ");
  EXPECT_TRUE(fs::exists(folder.Path() / "whole/a/b/last"));
}

/// Runs `work` in a process of its own. \return its wait status
int InAProcess(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(0);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return status;
}

TEST(PartialPath, IsGoneAfterASignalWhichStillEndsTheProcess) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const test::TemporaryFolder folder, elsewhere;
    std::ofstream(elsewhere.Path() / "kept") << "x";
    const auto end = [&](bool is_guarded) {
      return InAProcess([&] {
        std::signal(signal, SIG_DFL);
        if (is_guarded) RemovePartialPathsOnSignals();
        const PartialPath partial(folder.Path() / "result");
        Fill(partial.Path());
        fs::create_directory_symlink(elsewhere.Path(), partial.Path() / "link");
        ::raise(signal);
      });
    };
    int status = end(false);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
    EXPECT_NE(List(folder.Path()), "") << "the control: without the handler it stays";
    for (const auto& left : fs::directory_iterator(folder.Path())) fs::remove_all(left.path());
    status = end(true);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    EXPECT_EQ(List(folder.Path()), "") << signal;
    EXPECT_EQ(List(elsewhere.Path()), "kept ") << "a link is not followed";
  }
}

TEST(PartialPath, AnIgnoredSignalStaysIgnored) {
  const int status = InAProcess([] {
    std::signal(SIGHUP, SIG_IGN);
    RemovePartialPathsOnSignals();
    ::raise(SIGHUP);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

// a child of fork() that is stopped does not take its parent's work away
TEST(PartialPath, AChildRemovesNothingOfItsParent) {
  const test::TemporaryFolder folder;
  const PartialPath partial(folder.Path() / "result");
  Fill(partial.Path());
  (void)InAProcess([] {
    std::signal(SIGTERM, SIG_DFL);
    RemovePartialPathsOnSignals();
    ::raise(SIGTERM);
  });
  EXPECT_TRUE(fs::exists(partial.Path() / "a/b/last"));
}

// more than the table holds: those beyond it are removed by their destructors alone
TEST(PartialPath, ThereMayBeManyAtOnce) {
  const test::TemporaryFolder folder;
  {
    std::vector<std::unique_ptr<PartialPath>> many;
    for (int i = 0; i < 50; ++i) {
      many.push_back(std::make_unique<PartialPath>(folder.Path() / std::to_string(i)));
      std::ofstream(many.back()->Path()) << "x";
    }
  }
  EXPECT_EQ(List(folder.Path()), "");
}

TEST(PartialPath, AFileThatMayNotGrowIsAnErrorOfWriting) {
  const test::TemporaryFolder folder;
  const int status = InAProcess([&] {
    RemovePartialPathsOnSignals();
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const base::Status written = WriteFile(folder.Path() / "large", std::string(100'000, 'x'));
    ::_exit(!written && written.error().code == base::ErrorCode::kFileUnwritable ? 7 : 1);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
  EXPECT_EQ(List(folder.Path()), "");
}

}  // namespace
}  // namespace trocar::host
