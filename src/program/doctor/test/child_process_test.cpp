// SPDX-License-Identifier: Apache-2.0
#include "child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace trocar::doctor {
namespace {

TEST(AskChild, BringsTheAnswerBack) {
  const ChildAnswer answer = AskChild(
      [](std::string& text) {
        text = "llvmpipe";
        return true;
      },
      10);
  EXPECT_EQ(answer.end, ChildEnd::kAnswered);
  EXPECT_EQ(answer.text, "llvmpipe");
}

TEST(AskChild, TellsAComplaintFromAnAnswer) {
  const ChildAnswer answer = AskChild(
      [](std::string& text) {
        text = "no context";
        return false;
      },
      10);
  EXPECT_EQ(answer.end, ChildEnd::kFailed);
  EXPECT_EQ(answer.text, "no context");
}

// The reason for the child: a driver that crashes.
TEST(AskChild, SurvivesACrash) {
  const ChildAnswer answer = AskChild(
      [](std::string&) -> bool {
        ::signal(SIGSEGV, SIG_DFL);
        ::raise(SIGSEGV);
        return true;
      },
      10);
  EXPECT_EQ(answer.end, ChildEnd::kCrashed);
  EXPECT_THAT(answer.text, testing::HasSubstr("Segmentation fault"));
}

TEST(AskChild, EndsAChildThatNeverAnswers) {
  const ChildAnswer answer = AskChild(
      [](std::string&) -> bool {
        for (;;) ::pause();
      },
      0.2);
  EXPECT_EQ(answer.end, ChildEnd::kTimedOut);
}

TEST(AskChild, TurnsAnExceptionIntoAComplaint) {
  const ChildAnswer answer =
      AskChild([](std::string&) -> bool { throw std::runtime_error("driver is unhappy"); }, 10);
  EXPECT_EQ(answer.end, ChildEnd::kFailed);
  EXPECT_EQ(answer.text, "driver is unhappy");
}

TEST(AskChild, CutsAnEndlessAnswer) {
  const ChildAnswer answer = AskChild(
      [](std::string& text) {
        text.assign(1 << 20, 'x');
        return true;
      },
      10);
  EXPECT_EQ(answer.text.size(), 4096u);
}

}  // namespace
}  // namespace trocar::doctor
