// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/offscreen_context.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>

namespace trocar::render {
namespace {

TEST(OffscreenContext, NamesItsVersionAndRenderer) {
  const auto context = OffscreenContext::Make();
  ASSERT_TRUE(context.ok()) << context.error().Text();
  EXPECT_FALSE(context->VersionText().empty());
  EXPECT_FALSE(context->RendererText().empty());
}

TEST(OffscreenContext, MovesToAnotherThreadAfterRelease) {
  auto context = OffscreenContext::Make();
  ASSERT_TRUE(context.ok()) << context.error().Text();
  std::thread([&] {
    const auto refused = context->MakeCurrent();
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, base::ErrorCode::kNoGraphics);
  }).join();
  context->Release();
  std::thread([&] {
    EXPECT_TRUE(context->MakeCurrent().ok());
    context->Release();
  }).join();
  EXPECT_TRUE(context->MakeCurrent().ok());
}

// The driver's threads do not come along, and what they hold is held for ever.
TEST(OffscreenContext, IsRefusedInForks) {
  auto context = OffscreenContext::Make();
  ASSERT_TRUE(context.ok()) << context.error().Text();
  context->Release();
  const ::pid_t child = ::fork();
  if (child == 0) {
    ::alarm(30);
    const auto is_refused = [](const auto& result) {
      return !result.ok() && result.error().code == base::ErrorCode::kEnvironmentState;
    };
    const bool holds = is_refused(context->MakeCurrent()) && is_refused(OffscreenContext::Make());
    context->Release();
    { const OffscreenContext goes(std::move(*context)); }
    ::_exit(holds ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(context->MakeCurrent().ok());
}

/// In a process of its own: prints the error's text and ends with 0, or with 1 when there was none.
[[noreturn]] void FailWith(const char* variable, const std::string& value) {
  ::setenv(variable, value.c_str(), 1);
  const auto context = OffscreenContext::Make();
  if (!context.ok()) std::fputs(context.error().Text().c_str(), stderr);
  std::exit(context.ok() ? 1 : 0);
}

class OffscreenContextDeathTest : public testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(OffscreenContextDeathTest, WithoutADriverSaysWhatToInstall) {
  EXPECT_EXIT(FailWith("__EGL_VENDOR_LIBRARY_DIRS", "/nowhere"), testing::ExitedWithCode(0),
              "E-GL-001.*libegl1.*libgl1-mesa-dri");
}

TEST_F(OffscreenContextDeathTest, AnOldOpenGlIsNamed) {
  EXPECT_EXIT(FailWith("MESA_GL_VERSION_OVERRIDE", "2.1"), testing::ExitedWithCode(0),
              "E-GL-002.*2\\.1.*3\\.3");
}

}  // namespace
}  // namespace trocar::render
