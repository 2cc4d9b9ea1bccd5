// SPDX-License-Identifier: Apache-2.0
/// \file nearest_triangle.cpp  The paper's greedy search and the exact one over the same tree.
#include <cmath>
#include <cstdio>

#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/geometry/distance.h"
#include "trocar/geometry/primitives.h"

int main() {
  using namespace trocar;
  const geometry::TriangleMesh organ = geometry::MakeSphere({0, 0, 0}, 0.05, 4);
  const auto hierarchy = collision::CentroidHierarchy::Make(organ.positions, organ.triangles);
  if (!hierarchy.ok()) {
    std::fprintf(stderr, "%s\n", hierarchy.error().Text().c_str());
    return 1;
  }
  const math::Vec3 tip{0.021, 0.034, 0.052};
  const auto exact = hierarchy->FindNearest(organ.positions, tip);
  const auto& t = organ.triangles[hierarchy->FindGreedy(tip)];
  const auto greedy = geometry::FindNearestOnTriangle(tip, organ.positions[t[0]], organ.positions[t[1]],
                                                      organ.positions[t[2]]);
  std::printf("distance from the tip to %zu triangles:\n", organ.triangles.size());
  std::printf("  exact  %.4f mm\n", 1000.0 * std::sqrt(exact.squared_distance));
  std::printf("  greedy %.4f mm (the paper's search, never nearer)\n",
              1000.0 * math::Distance(tip, greedy.point));
}
