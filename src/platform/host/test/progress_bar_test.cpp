// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/progress_bar.h"

#include <gtest/gtest.h>

namespace trocar::host {
namespace {

TEST(ProgressBar, IsSilentWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressBar bar("working", 3);
    for (int i = 1; i <= 3; ++i) bar.Show(i);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace trocar::host
