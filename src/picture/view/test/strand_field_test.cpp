// SPDX-License-Identifier: Apache-2.0
#include "strand_field.h"

#include <gtest/gtest.h>

#include <vector>

namespace trocar::view {
namespace {

using math::Vec3;

// The strands' rest length is the way between their ends at the start.
TEST(StrandField, ShowsTheBedsWebOnlyWhereItIsDrawn) {
  const std::vector<Vec3> rest = {{0, 0, 0}, {0, 0, 0.005}, {0.004, 0, 0}, {0.004, 0, 0.005}};
  scene::StrandInfo info;
  info.kind = scene::StrandInfo::Kind::kBed;
  std::vector<scene::StrandInfo> strands(2, info);
  strands[0].a = 0, strands[0].b = 1, strands[1].a = 2, strands[1].b = 3;
  const StrandField field(strands, rest);
  render::Frame frame;
  simulation::Snapshot snapshot;
  snapshot.positions = rest;
  field.AddFibres(frame, snapshot);
  EXPECT_TRUE(frame.fibres.empty()) << "peritoneum covers what lies as it grew";
  snapshot.positions[1].z = 0.0065;
  field.AddFibres(frame, snapshot);
  EXPECT_FALSE(frame.fibres.empty());
  for (const render::Fibre& fibre : frame.fibres) EXPECT_LT(fibre.a.x, 0.003) << "the other one is not drawn";
}

}  // namespace
}  // namespace trocar::view
