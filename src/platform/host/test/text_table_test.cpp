// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/text_table.h"

#include <gtest/gtest.h>

#include <limits>

namespace trocar::host {
namespace {

TEST(FormatNumber, KeepsSignificantDigitsAndNoExponentOfThousands) {
  EXPECT_EQ(FormatNumber(12.3456), "12.35");
  EXPECT_EQ(FormatNumber(0.00451), "0.00451");
  EXPECT_EQ(FormatNumber(123456.7), "123457");
  EXPECT_EQ(FormatNumber(0), "0");
  EXPECT_EQ(FormatNumber(std::numeric_limits<double>::quiet_NaN()), "not a number");
}

TEST(FormatTable, AlignsNumbersRightAndTextLeft) {
  EXPECT_EQ(FormatTable({{"stage", "ms"}, {"solve", "12.5"}, {"publish", "0.25"}}),
            "stage    ms\n"
            "solve    12.5\n"
            "publish  0.25\n");
  EXPECT_EQ(FormatTable({{"n"}, {"5"}, {"10"}}), "n\n 5\n10\n");
}

TEST(FormatTable, CountsCharactersNotBytes) {
  EXPECT_EQ(FormatTable({{"µs", "x"}, {"ab", "y"}}), "µs  x\nab  y\n");
}

TEST(FormatTable, AcceptsRowsThatEndEarly) {
  EXPECT_EQ(FormatTable({{"a", "b"}, {"c"}}), "a  b\nc\n");
}

}  // namespace
}  // namespace trocar::host
