// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/simd_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

namespace trocar::base {
namespace {

using testing::HasSubstr;

TEST(SimdLevel, IsNamedOrTheWidest) {
  const std::vector<SimdLevel> levels = ListSimdLevels();
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(levels.front(), SimdLevel::kBaseline);
  EXPECT_EQ(levels.back(), FindWidestSimdLevel());
  for (const SimdLevel level : levels) {
    const auto read = ReadSimdLevel(SimdLevelName(level));
    ASSERT_TRUE(read.ok()) << read.error().Text();
    EXPECT_EQ(*read, level);
  }
  EXPECT_EQ(*ReadSimdLevel(""), FindWidestSimdLevel());
#if defined(__x86_64__)
  EXPECT_EQ(*ReadSimdLevel("sse2"), SimdLevel::kBaseline);
#endif
}

// never another level in silence
TEST(SimdLevel, WhatIsNotThereIsAnErrorThatNamesWhatIs) {
  std::vector<std::string> wrong = {"avx", "AVX2", "baseline ", "0"};
  for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (!HasSimdLevel(level)) wrong.emplace_back(SimdLevelName(level));
  }
  for (const std::string& name : wrong) {
    const auto read = ReadSimdLevel(name);
    ASSERT_FALSE(read.ok()) << name;
    EXPECT_EQ(read.error().code, ErrorCode::kUsage);
    EXPECT_THAT(read.error().Text(), testing::AllOf(HasSubstr(name), HasSubstr("baseline")));
  }
  ::setenv(kSimdVariable, "avx9", 1);
  EXPECT_FALSE(CheckSimdLevel().ok());
  ::setenv(kSimdVariable, "baseline", 1);
  EXPECT_TRUE(CheckSimdLevel().ok());
  ::unsetenv(kSimdVariable);
  EXPECT_TRUE(CheckSimdLevel().ok());
}

}  // namespace
}  // namespace trocar::base
