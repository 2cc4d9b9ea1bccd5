// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/software_renderer.h"

#include <gtest/gtest.h>

namespace trocar::gui {
namespace {

TEST(SoftwareRenderer, IsKnownByItsName) {
  EXPECT_TRUE(IsSoftwareRenderer("llvmpipe (LLVM 15.0.6, 256 bits)"));
  EXPECT_TRUE(IsSoftwareRenderer("softpipe"));
  EXPECT_TRUE(IsSoftwareRenderer("Mesa DRI swrast"));
  EXPECT_FALSE(IsSoftwareRenderer("Mesa Intel(R) UHD Graphics 620 (KBL GT2)"));
  EXPECT_FALSE(IsSoftwareRenderer("NVIDIA GeForce RTX 3060/PCIe/SSE2"));
  EXPECT_FALSE(IsSoftwareRenderer("AMD Radeon Graphics (radeonsi, renoir, LLVM 15.0.6)"));
  EXPECT_FALSE(IsSoftwareRenderer(""));
}

}  // namespace
}  // namespace trocar::gui
