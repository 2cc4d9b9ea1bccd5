// SPDX-License-Identifier: Apache-2.0
// Ducts and arteries that come off the gallbladder without having been cut.
#include <gtest/gtest.h>

#include <algorithm>

#include "operation_harness.h"

namespace trocar::simulation {

using scene::StrandInfo;

namespace {

class TubeEnd : public OperationHarness {
 protected:
  void SetUp() override { MakeOperation(); }

  /// Strands that tie a tube to the gallbladder.
  std::vector<std::uint32_t> EndOf(const char* name) const {
    const auto& surfaces = Tissue().surfaces;
    const auto tube =
        std::find_if(surfaces.begin(), surfaces.end(),
                     [name](const scene::SurfaceInfo& surface) { return surface.name == name; });
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < Tissue().strands.size(); ++i) {
      const StrandInfo& strand = Tissue().strands[i];
      const bool is_of_tube = strand.a >= tube->first_node && strand.a < tube->first_node + tube->node_count;
      const bool is_at_gallbladder = strand.b >= Gallbladder().first_node &&
                                     strand.b < Gallbladder().first_node + Gallbladder().node_count;
      if (strand.kind == StrandInfo::Kind::kEnd && is_of_tube && is_at_gallbladder) found.push_back(i);
    }
    return found;
  }
  void Part(std::uint32_t strand) { state_.strand_is_intact[strand] = 0; }
  void Tick() { Act(), Judge(); }
  double BloodLost() const {
    return Result().fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left;
  }
};

TEST_F(TubeEnd, AnArteryThatComesOffIsOpenAndCountsAsCut) {
  const std::vector<std::uint32_t> end = EndOf("cystic_artery");
  ASSERT_GT(end.size(), 1u);
  for (std::size_t i = 0; i + 1 < end.size(); ++i) Part(end[i]);
  for (int tick = 0; tick < 60; ++tick) Tick();
  EXPECT_EQ(CountErrors("unclipped_cut"), 0u) << "it hangs on one strand";
  EXPECT_EQ(BloodLost(), 0.0);
  Part(end.back());
  for (int tick = 0; tick < 240; ++tick) Tick();
  EXPECT_EQ(CountErrors("unclipped_cut"), 1u) << "once, not in each tick";
  EXPECT_GT(BloodLost(), 0.1e-6) << "two seconds of an open artery";
}

// What a torn strand is said to be: fibres of no organ, ducts and vessels by their own number.
TEST_F(TubeEnd, StrandsNameWhatTheyHold) {
  const auto& tissue = Tissue();
  ASSERT_EQ(tissue.strand_organs.size(), tissue.strands.size());
  int ends = 0, fibres = 0;
  for (std::size_t i = 0; i < tissue.strands.size(); ++i) {
    const std::int32_t organ = tissue.strand_organs[i];
    switch (tissue.strands[i].kind) {
      case StrandInfo::Kind::kEnd: {
        ASSERT_GE(organ, 0);
        const scene::SurfaceInfo& held = tissue.surfaces[static_cast<std::size_t>(organ)];
        EXPECT_GE(tissue.strands[i].b, held.first_node);
        EXPECT_LT(tissue.strands[i].b, held.first_node + held.node_count);
        ++ends;
        break;
      }
      case StrandInfo::Kind::kTriangle:
      case StrandInfo::Kind::kPeritoneum:
        EXPECT_EQ(organ, -1);
        ++fibres;
        break;
      default:
        EXPECT_GE(organ, 0);
    }
  }
  EXPECT_GT(ends, 0);
  EXPECT_GT(fibres, 0);
}

TEST_F(TubeEnd, WhatLeavesInTheBagCountsAsNothing) {
  TakeGallbladderOut();
  for (int tick = 0; tick < 60; ++tick) Tick();
  EXPECT_EQ(CountErrors("unclipped_cut"), 0u);
}

}  // namespace
}  // namespace trocar::simulation
