// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "trocar/base/error_codes.h"
#include "trocar/base/result.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"

namespace trocar::base {
namespace {

TEST(ErrorTable, HasOneEntryPerCodeInOrderWithUniqueText) {
  std::set<std::string_view> texts;
  int index = 0;
  for (const ErrorEntry& entry : ErrorTable()) {
    EXPECT_EQ(static_cast<int>(entry.code), index++);
    EXPECT_TRUE(texts.insert(entry.text).second) << entry.text;
    EXPECT_FALSE(entry.meaning.empty());
  }
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> good = 7;
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, 7);
  const Result<int> bad = Error{ErrorCode::kImageSliceMissing, "slice 0561 is missing"};
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().Text(), "E-IMG-002 slice 0561 is missing");
}

TEST(CalcPercentile, InterpolatesBetweenRanks) {
  EXPECT_DOUBLE_EQ(CalcPercentile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(CalcPercentile({4, 1, 3, 2}, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(CalcPercentile({}, 0.5), 0.0);
}

TEST(StateHash, ChangesWithTheLastBitAndTheOrder) {
  StateHash a, b, c;
  a.Add(1.0);
  a.Add(2.0);
  b.Add(1.0);
  b.Add(2.0000000000000004);
  c.Add(2.0);
  c.Add(1.0);
  EXPECT_NE(a.Value(), b.Value());
  EXPECT_NE(a.Value(), c.Value());
  EXPECT_EQ(a.Text().size(), 16u);
}

}  // namespace
}  // namespace trocar::base
