// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_error.h"

#include <gtest/gtest.h>

#include <set>

namespace trocar::cholecystectomy {
namespace {

TEST(OperationError, HasANameAndASentenceOfItsOwn) {
  std::set<std::string_view> names, sentences;
  for (std::size_t i = 0; i < kOperationErrorCount; ++i) {
    const auto error = static_cast<OperationError>(i);
    EXPECT_TRUE(names.insert(NameOf(error)).second) << NameOf(error);
    EXPECT_TRUE(sentences.insert(ExplanationOf(error)).second) << NameOf(error);
    EXPECT_EQ(ExplanationOf(error).back(), '.') << NameOf(error);
  }
}

TEST(ErrorLog, CountsWhatGoesOnOnce) {
  ErrorLog log;
  for (int tick = 0; tick < 120; ++tick)
    log.Add({OperationError::kEnergyNearDuct, 10.0 + tick / 120.0, {0.01, 0, 0}, 1});
  EXPECT_EQ(log.Count(OperationError::kEnergyNearDuct), 1u);
  log.Add({OperationError::kEnergyNearDuct, 11.0, {}, 0});
  EXPECT_EQ(log.Count(OperationError::kEnergyNearDuct), 2u) << "the other hand's is another";
  log.Add({OperationError::kEnergyNearDuct, 14.0, {}, 1});
  EXPECT_EQ(log.Count(Severity::kMajor), 3u) << "after a pause";
  EXPECT_EQ(log.Count(Severity::kCritical), 0u);
  ASSERT_EQ(log.Entries().size(), 3u);
  EXPECT_EQ(log.Entries()[0].time, 10.0);
  EXPECT_EQ(log.Entries()[0].hand, 1);
  log.Clear();
  EXPECT_EQ(log.Count(), 0u);
  log.Add({OperationError::kEnergyNearDuct, 14.1, {}, 1});
  EXPECT_EQ(log.Count(), 1u);
}

TEST(ErrorLog, CountsBeyondItsRoom) {
  ErrorLog log;
  for (std::size_t i = 0; i < ErrorLog::kCapacity + 5; ++i)
    log.Add({OperationError::kClipDropped, 10.0 * static_cast<double>(i + 1), {}, 0});
  EXPECT_EQ(log.Entries().size(), ErrorLog::kCapacity);
  EXPECT_EQ(log.Count(Severity::kMinor), ErrorLog::kCapacity + 5);
}

}  // namespace
}  // namespace trocar::cholecystectomy
