// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/surface_cut.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cut_checks.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/openings.h"
#include "trocar/geometry/primitives.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

constexpr double kSpacing = 0.005;

EditableMesh MakeEditable(const TriangleMesh& mesh) {
  auto made = EditableMesh::Make(mesh, 4000, 8000);
  EXPECT_TRUE(made.ok());
  return std::move(*made);
}

/// A blade that stands upright on the sheet's plane, at (x, y).
BladeEdge Upright(double x, double y) {
  return {{x, y, -0.01}, {x, y, 0.01}};
}

std::size_t CountPieces(const EditableMesh& mesh) {
  return InspectMesh(mesh.RestMesh()).components;
}

/// Cuts along a straight line in so many ticks.
CutReport CutLine(EditableMesh& mesh, const BladeEdge& from, const BladeEdge& to, int ticks,
                  const CutSettings& settings = {}) {
  SurfaceCutter cutter(mesh);
  CutFront front;
  CutReport sum;
  BladeEdge before = from;
  for (int i = 1; i <= ticks; ++i) {
    const double s = static_cast<double>(i) / ticks;
    const BladeEdge now{math::Lerp(from.a, to.a, s), math::Lerp(from.b, to.b, s)};
    const CutReport report = cutter.Cut(before, now, settings, front, mesh);
    sum.splits += report.splits;
    sum.snaps += report.snaps;
    sum.opened += report.opened;
    sum.copies += report.copies;
    sum.refused += report.refused;
    sum.wall_triangles += report.wall_triangles;
    before = now;
  }
  return sum;
}

class SheetCut : public testing::TestWithParam<int> {};

TEST_P(SheetCut, RightThroughGivesTwoPieces) {
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  const Uncut uncut = Measure(mesh);
  CutLine(mesh, Upright(-0.003, 0.0171), Upright(0.045, 0.0233), GetParam());
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(CountPieces(mesh), 2u);
  // the line divides the square of 40 mm: below it lie 40 mm x the height at its middle
  const auto pieces = FindComponents(mesh.Triangles(), mesh.VertexCount());
  double below = 0;
  for (const Triangle& t : mesh.Triangles()) {
    if (pieces[t[0]] == pieces[0]) below += 0.5 * math::Norm(CalcAreaNormal(mesh.Rest(), t));
  }
  const double height = 0.0171 + (0.0233 - 0.0171) * (0.020 + 0.003) / 0.048;
  EXPECT_NEAR(below, 0.040 * height, 0.06 * 0.040 * height);
  EXPECT_EQ(FindLoopLengths(mesh.RestMesh()).size(), 2u);
}

TEST_P(SheetCut, SlitHasOneRimOfTwiceItsLength) {
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  const Uncut uncut = Measure(mesh);
  CutLine(mesh, Upright(0.0061, 0.0203), Upright(0.0337, 0.0203), GetParam());
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(CountPieces(mesh), 1u);
  auto lengths = FindLoopLengths(mesh.RestMesh());
  ASSERT_EQ(lengths.size(), 2u);
  std::sort(lengths.begin(), lengths.end());
  // blade: 27.6 mm; the slit runs from edge to edge, so up to a triangle's reach is missing at either end
  EXPECT_LT(lengths[0], 2.0 * 0.0276 + 2 * kSpacing);
  EXPECT_GT(lengths[0], 2.0 * (0.0276 - 2 * kSpacing));
  std::array<Opening, 4> openings;
  ASSERT_EQ(FindOpenings(mesh, openings), 2u);
  const double slit = std::min(openings[0].length, openings[1].length);
  EXPECT_NEAR(slit, lengths[0], 1e-12);
  EXPECT_EQ(InspectMesh(mesh.RestMesh()).components, 1u);
}

TEST_P(SheetCut, FollowsTheTissueThatMoves) {
  // the sheet drifts across the blade's path while it is cut: the cut stays one
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  const Uncut uncut = Measure(mesh);
  SurfaceCutter cutter(mesh);
  CutFront front;
  BladeEdge before = Upright(-0.002, 0.0203);
  const int ticks = std::max(GetParam(), 40);
  for (int i = 1; i <= ticks; ++i) {
    std::vector<Vec3> moved(mesh.Rest().begin(), mesh.Rest().end());
    for (Vec3& p : moved) p.y += 0.004 * i / ticks;
    mesh.SetPositions(moved);
    const BladeEdge now = Upright(-0.002 + 0.046 * i / ticks, 0.0203);
    cutter.Cut(before, now, {}, front, mesh);
    before = now;
  }
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(CountPieces(mesh), 2u);
}

INSTANTIATE_TEST_SUITE_P(Ticks, SheetCut, testing::Values(1, 2, 7, 40, 400));

TEST(SurfaceCut, AlongEdgesAndThroughVerticesSplitsNothing) {
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  const Uncut uncut = Measure(mesh);
  const CutReport report = CutLine(mesh, Upright(-0.01, 4 * kSpacing), Upright(0.05, 4 * kSpacing), 1);
  EXPECT_EQ(report.splits, 0u);
  EXPECT_EQ(report.opened, 8u);
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(CountPieces(mesh), 2u);
  EXPECT_EQ(mesh.VertexCount(), 81u + 9u);
}

TEST(SurfaceCut, CrossingCutsGiveFourPieces) {
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  const Uncut uncut = Measure(mesh);
  CutLine(mesh, Upright(-0.01, 0.0187), Upright(0.05, 0.0187), 1);
  CutLine(mesh, Upright(0.0222, -0.01), Upright(0.0222, 0.05), 1);
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(CountPieces(mesh), 4u);
}

TEST(SurfaceCut, NothingChangesWithoutABlade) {
  EditableMesh mesh = MakeEditable(MakeSphere({}, 0.02, 3));
  SurfaceCutter cutter(mesh);
  CutFront front;
  const BladeEdge far{{0.1, 0, 0}, {0.2, 0, 0}}, farther{{0.1, 0.1, 0}, {0.2, 0.1, 0}};
  EXPECT_FALSE(cutter.Cut(far, farther, {}, front, mesh).HasChanged());
  // one that does not move, moves along itself, or is no number
  const BladeEdge in{{0, 0, 0}, {0.05, 0, 0}};
  EXPECT_FALSE(cutter.Cut(in, in, {}, front, mesh).HasChanged());
  EXPECT_FALSE(cutter.Cut(in, {{0.01, 0, 0}, {0.06, 0, 0}}, {}, front, mesh).HasChanged());
  EXPECT_FALSE(cutter.Cut(in, {{NAN, 0, 0}, {0.05, 0.01, 0}}, {}, front, mesh).HasChanged());
  EXPECT_FALSE(cutter.Cut({{0, INFINITY, 0}, {0, 0, 0}}, in, {}, front, mesh).HasChanged());
  EXPECT_TRUE(mesh.Journal().empty());
  EXPECT_EQ(mesh.TriangleCount(), 1280u);
}

// A hollow organ: the cut is an opening with an area.
TEST(SurfaceCut, HollowSphereGetsOneRim) {
  EditableMesh mesh = MakeEditable(MakeSphere({}, 0.02, 3));
  const Uncut uncut = Measure(mesh);
  const BladeEdge from{{0.015, -0.006, 0.001}, {0.025, -0.006, 0.001}},
      to{{0.015, 0.006, 0.001}, {0.025, 0.006, 0.001}};
  CutLine(mesh, from, to, 30);
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  std::array<Opening, 4> openings;
  ASSERT_EQ(FindOpenings(mesh, openings), 1u);
  EXPECT_NEAR(openings[0].length, 0.024, 0.008);
  EXPECT_NEAR(openings[0].area, 0.0, 1e-12);
  // drawn apart by a millimetre, it gapes
  std::vector<Vec3> drawn(mesh.Rest().begin(), mesh.Rest().end());
  for (std::uint32_t h = openings[0].half_edge, i = 0; i < openings[0].edges; ++i, h = NextOnRim(mesh, h)) {
    Vec3 middle;
    mesh.ForEachAround(mesh.From(h), [&](std::uint32_t g) {
      middle += mesh.Rest()[mesh.To(g)] - mesh.Rest()[mesh.From(h)];
    });
    if (mesh.Sources()[mesh.From(h)].origin == VertexOrigin::kCopy)
      drawn[mesh.From(h)].z += middle.z > 0 ? 0.001 : -0.001;
  }
  mesh.SetPositions(drawn);
  FindOpenings(mesh, openings);
  EXPECT_GT(openings[0].area, 0.5 * 0.001 * 0.006);
  // with its lid, the sphere has its volume again
  TriangleMesh closed = mesh.RestMesh();
  const double volume = InspectMesh(MakeSphere({}, 0.02, 3)).volume;
  const auto lids = MakeLids(mesh);
  closed.triangles.insert(closed.triangles.end(), lids.begin(), lids.end());
  EXPECT_NEAR(CalcVolume(closed.positions, closed.triangles) / volume, 1.0, 1e-9);
}

class SolidCut : public testing::TestWithParam<int> {};

TEST_P(SolidCut, StaysClosedWithATrench) {
  EditableMesh mesh = MakeEditable(MakeSphere({}, 0.02, 3));
  const Uncut uncut = Measure(mesh);
  CutSettings settings;
  settings.has_walls = true;
  settings.depth = 0.004;
  const BladeEdge from{{0.015, -0.008, 0.001}, {0.025, -0.008, 0.001}},
      to{{0.015, 0.008, 0.001}, {0.025, 0.008, 0.001}};
  const CutReport report = CutLine(mesh, from, to, GetParam(), settings);
  EXPECT_EQ(FindFault(mesh, uncut, true), "");
  EXPECT_GT(report.wall_triangles, 8u);
  EXPECT_EQ(report.refused, 0u);
  const MeshReport after = InspectMesh(mesh.RestMesh());
  EXPECT_TRUE(after.closed);
  EXPECT_EQ(after.genus, 0);
  // a wedge of no width takes nothing away
  EXPECT_NEAR(after.volume / InspectMesh(MakeSphere({}, 0.02, 3)).volume, 1.0, 1e-9);
  // the walls lie below the cut, as deep as asked
  double deepest = 1;
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v) {
    if (mesh.Sources()[v].origin == VertexOrigin::kTrench)
      deepest = std::min(deepest, math::Norm(mesh.Rest()[v]));
  }
  EXPECT_NEAR(deepest, 0.016, 0.0005);
}

INSTANTIATE_TEST_SUITE_P(Ticks, SolidCut, testing::Values(1, 5, 60));

TEST(SurfaceCut, TrenchesCross) {
  EditableMesh mesh = MakeEditable(MakeSphere({}, 0.02, 3));
  const Uncut uncut = Measure(mesh);
  CutSettings settings;
  settings.has_walls = true;
  settings.depth = 0.003;
  CutLine(mesh, {{0.012, -0.008, 0.001}, {0.025, -0.008, 0.001}},
          {{0.012, 0.008, 0.001}, {0.025, 0.008, 0.001}}, 30, settings);
  ASSERT_EQ(FindFault(mesh, uncut, true), "");
  // drawn apart, so that the second meets its walls
  std::vector<Vec3> drawn(mesh.Rest().begin(), mesh.Rest().end());
  for (Vec3& p : drawn) p.z += p.z > 0.001 ? 0.0005 : 0.0;
  mesh.SetPositions(drawn);
  const Uncut once = Measure(mesh);
  const CutReport report = CutLine(mesh, {{0.012, 0.0012, -0.008}, {0.025, 0.0012, -0.008}},
                                   {{0.012, 0.0012, 0.008}, {0.025, 0.0012, 0.008}}, 40, settings);
  EXPECT_EQ(FindFault(mesh, once, true), "");
  EXPECT_GT(report.opened, 6u);
}

TEST(SurfaceCut, FullPoolsLeaveTheRestUncut) {
  auto made = EditableMesh::Make(MakeGrid(9, kSpacing), 6, 9);
  ASSERT_TRUE(made.ok());
  EditableMesh mesh = std::move(*made);
  const Uncut uncut = Measure(mesh);
  SurfaceCutter cutter(mesh);
  CutFront front;
  const CutReport report = cutter.Cut(Upright(-0.003, 0.0171), Upright(0.045, 0.0233), {}, front, mesh);
  EXPECT_TRUE(report.is_full);
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
}

// An edge that full pools left waiting is opened together with what parts one of its ends, and its other end is parted
// too: that one stood on two fans.
TEST(SurfaceCut, AnEdgeThatWaitedForRoomOpensWithBothEnds) {
  EditableMesh mesh = MakeEditable(MakeGrid(5, kSpacing));
  const Uncut uncut = Measure(mesh);
  const std::uint32_t rim = 2, inner = 2 + 5;
  ASSERT_TRUE(mesh.IsBoundary(rim));
  ASSERT_FALSE(mesh.IsBoundary(inner));
  mesh.SetScored(mesh.FindHalfEdge(inner, rim), true);
  const CutReport report =
      CutLine(mesh, Upright(2.05 * kSpacing, 0.97 * kSpacing), Upright(2.05 * kSpacing, 3 * kSpacing), 1);
  EXPECT_EQ(FindFault(mesh, uncut, false), "");
  EXPECT_EQ(report.opened, 3u) << "two of the cut, and the one that waited";
  EXPECT_EQ(report.copies, 3u);
}

TEST(SurfaceCut, VerticesKnowWhatTheyAreMadeOf) {
  EditableMesh mesh = MakeEditable(MakeGrid(9, kSpacing));
  // the sheet is stretched now to twice its width: rest places follow the same weights
  std::vector<Vec3> stretched(mesh.Rest().begin(), mesh.Rest().end());
  for (Vec3& p : stretched) p.x *= 2.0;
  mesh.SetPositions(stretched);
  CutLine(mesh, Upright(-0.003, 0.0171), Upright(0.1, 0.0233), 5);
  int splits = 0, copies = 0;
  for (std::uint32_t v = 81; v < mesh.VertexCount(); ++v) {
    const VertexSource& source = mesh.Sources()[v];
    ASSERT_LT(source.from[0], v);
    if (source.origin == VertexOrigin::kSplit) {
      ++splits;
      Vec3 rest;
      for (int i = 0; i < 3; ++i) {
        if (source.from[i] != kNone) rest += source.weights[i] * mesh.Rest()[source.from[i]];
      }
      EXPECT_NEAR(math::Distance(rest, mesh.Rest()[v]), 0.0, 1e-15);
    } else {
      ASSERT_EQ(source.origin, VertexOrigin::kCopy);
      ++copies;
      EXPECT_EQ(mesh.Rest()[v], mesh.Rest()[source.from[0]]);
    }
    EXPECT_NEAR(mesh.Positions()[v].x, 2.0 * mesh.Rest()[v].x, 1e-15);
  }
  EXPECT_GE(splits, 8);
  EXPECT_GE(copies, 8);
}

TEST(EditableMesh, RefusesWhatIsNoSurface) {
  TriangleMesh fin = MakeGrid(3, kSpacing);
  fin.positions.push_back({0.005, 0.005, 0.01});
  fin.triangles.push_back({0, 1, 9});
  fin.triangles.push_back({1, 0, 9});
  EXPECT_EQ(EditableMesh::Make(fin, 0, 0).error().code, base::ErrorCode::kMeshInvalid);
  TriangleMesh range = MakeGrid(3, kSpacing);
  range.triangles[0][0] = 99;
  EXPECT_EQ(EditableMesh::Make(range, 0, 0).error().code, base::ErrorCode::kMeshInvalid);
  TriangleMesh loose = MakeGrid(3, kSpacing);
  loose.positions.push_back({});
  EXPECT_EQ(EditableMesh::Make(loose, 0, 0).error().code, base::ErrorCode::kMeshInvalid);
  EXPECT_EQ(EditableMesh::Make({}, 0, 0).error().code, base::ErrorCode::kMeshInvalid);
}

}  // namespace
}  // namespace trocar::geometry
