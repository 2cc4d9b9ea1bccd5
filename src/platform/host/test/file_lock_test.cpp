// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/file_lock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::host {
namespace {

class FileLockTest : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "sub" / "a.lock";
};

TEST_F(FileLockTest, IsHeldByOneAndNamesIt) {
  auto first = FileLock::Take(path_);
  ASSERT_TRUE(first.ok()) << first.error().Text();
  const auto second = FileLock::Take(path_);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, base::ErrorCode::kFileInUse);
  EXPECT_NE(second.error().message.find("process " + std::to_string(getpid())), std::string::npos)
      << second.error().message;
}

TEST_F(FileLockTest, IsGivenBackWithItsFile) {
  {
    auto first = FileLock::Take(path_);
    ASSERT_TRUE(first.ok());
    const FileLock moved = std::move(*first);
    EXPECT_FALSE(FileLock::Take(path_).ok());
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_TRUE(FileLock::Take(path_).ok());
}

TEST_F(FileLockTest, OutlivesNoProgram) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto lock = FileLock::Take(path_);
    const char told = lock.ok() ? 'y' : 'n';
    (void)!write(ready[1], &told, 1);
    pause();
    _exit(0);
  }
  char told = 0;
  ASSERT_EQ(read(ready[0], &told, 1), 1);
  EXPECT_EQ(told, 'y');
  const auto held = FileLock::Take(path_);
  EXPECT_FALSE(held.ok());
  EXPECT_NE(held.error().message.find(std::to_string(child)), std::string::npos);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(FileLock::Take(path_).ok()) << "a dead program holds the file";
  close(ready[0]);
  close(ready[1]);
}

TEST_F(FileLockTest, DoesNotFollowALink) {
  std::filesystem::create_directories(path_.parent_path());
  ASSERT_TRUE(WriteFile(folder_.Path() / "precious", "kept").ok());
  std::filesystem::create_symlink(folder_.Path() / "precious", path_);
  EXPECT_EQ(FileLock::Take(path_).error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_EQ(ReadFile(folder_.Path() / "precious").value(), "kept");
}

}  // namespace
}  // namespace trocar::host
