// SPDX-License-Identifier: Apache-2.0
/// \file real_time_test.cpp  What is called in a tick allocates nothing: every allocation of this program is
/// counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "trocar/collision/capsule_tree.h"
#include "trocar/collision/queries.h"
#include "trocar/collision/sweep.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/geometry/primitives.h"

namespace {
std::atomic<int> allocations{0};
}

// every plain form, so that none of them meets the other library's counterpart
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size > 0 ? size : 1);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) {
  return operator new(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return operator new(size, std::nothrow);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  operator delete(memory);
}

namespace trocar::collision {
namespace {

TEST(RealTime, SearchesAndUpdatesAllocateNothing) {
  const geometry::TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  CentroidHierarchy hierarchy = CentroidHierarchy::Make(mesh.positions, mesh.triangles).value();
  const geometry::Rows around = geometry::FindVertexTriangles(mesh.triangles, mesh.positions.size());
  const std::uint32_t modified[] = {5, 900, 17, 5};
  std::uint32_t found[64];
  const Capsule jaw{{{0.09, 0, 0}, {0.2, 0.05, 0.1}}, 0.01};
  const math::Vec3 p{0.11, 0.01, 0.02};

  const int before = allocations;
  hierarchy.UpdateAll(mesh.positions);
  hierarchy.Update(mesh.positions, modified);
  const std::uint32_t greedy = hierarchy.FindGreedy(p);
  const NearestTriangle nearest = hierarchy.FindNearest(mesh.positions, p, {.first_guess = greedy});
  const CapsuleContact contact = FindNearestToCapsule(hierarchy, mesh.positions, jaw);
  const std::size_t count = FindTrianglesInCapsule(hierarchy, mesh.positions, jaw, found);
  const SurfaceSide side = FindSide(mesh.positions, mesh.triangles, around, p, nearest);
  EXPECT_EQ(allocations, before);

  EXPECT_TRUE(nearest.Found() && contact.Found());
  EXPECT_GT(count, 0u);
  EXPECT_GT(side.distance, 0.0);
  // the counter itself works; a compiler may leave out what only a vector asks for
  operator delete(operator new(10));
  EXPECT_GT(allocations, before);
}

TEST(RealTime, TreesAllocateNothing) {
  const geometry::TriangleMesh mesh = geometry::MakeSphere({0, 0, 0}, 0.1, 3);
  const std::vector<TubePiece> pieces{{0, 9, 0.002}, {9, 20, 0.002}, {20, 33, 0.003}};
  TriangleTree tree = TriangleTree::Make(mesh.positions, mesh.triangles).value();
  CapsuleTree tubes = CapsuleTree::Make(mesh.positions, pieces).value();
  std::uint32_t found[64];
  const Capsule jaw{{{0.09, 0, 0}, {0.2, 0.05, 0.1}}, 0.01};

  const int before = allocations;
  tree.Update(mesh.positions);
  tubes.Update(mesh.positions);
  const bool is_found = tree.FindNearest(mesh.positions, {0.11, 0.01, 0.02}).Found() &&
                        tree.FindNearestToCapsule(mesh.positions, jaw).Found() &&
                        tubes.FindNearest(mesh.positions, jaw.axis).Found();
  const std::size_t count = tree.FindWithin(mesh.positions, jaw, found);
  (void)tubes.FindWithin(mesh.positions, jaw, found);
  const bool is_inside = tree.IsInside(mesh.positions, {0.01, 0.02, 0.03});
  (void)SweepToSegment({jaw.axis, jaw.axis}, {jaw.axis, jaw.axis}, 0.001);
  const bool is_rebuilt = tree.Rebuild(mesh.positions, mesh.triangles).ok();
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(is_found && is_inside && is_rebuilt);
  EXPECT_GT(count, 0u);
}

}  // namespace
}  // namespace trocar::collision
