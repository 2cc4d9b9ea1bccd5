// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_error.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <vector>

#include "trocar/base/state_archive.h"

namespace trocar::cholecystectomy {
namespace {

using surgery::ErrorLog;
using surgery::Severity;

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
  ErrorLog log(OperationErrors());
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
  ErrorLog log(OperationErrors());
  for (std::size_t i = 0; i < ErrorLog::kCapacity + 5; ++i)
    log.Add({OperationError::kClipDropped, 10.0 * static_cast<double>(i + 1), {}, 0});
  EXPECT_EQ(log.Entries().size(), ErrorLog::kCapacity);
  EXPECT_EQ(log.Count(Severity::kMinor), ErrorLog::kCapacity + 5);
}

// A state that was saved with another table, or is made up, is refused.
TEST(ErrorLog, RestoresNoRowThatItsTableHasNot) {
  ErrorLog log(OperationErrors());
  log.Add({OperationError::kBlindInsertion, 1.0, {}, 0});
  std::vector<std::byte> bytes;
  base::SaveState(log, bytes);
  ErrorLog same(OperationErrors()), smaller(OperationErrors().first(3));
  base::StateArchive archive = base::StateArchive::ForRestore(bytes);
  archive.Field("state", same);
  EXPECT_TRUE(archive.ok() && archive.IsAtEnd());
  EXPECT_EQ(same.Count(OperationError::kBlindInsertion), 1u);
  base::StateArchive other = base::StateArchive::ForRestore(bytes);
  other.Field("state", smaller);
  EXPECT_FALSE(other.ok());
  EXPECT_EQ(smaller.Count(), 0u);
}

}  // namespace
}  // namespace trocar::cholecystectomy
