// SPDX-License-Identifier: Apache-2.0
// A sheet with a circle to cut out: its judge, and what the expert's cut leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "task_play.h"
#include "trocar/geometry/surface_cut.h"
#include "trocar/surgery/pattern_cut_monitor.h"

namespace trocar::agent {

using math::Vec3;
using scene::ModelSheet;
using surgery::PatternCut;
namespace {

// --- its judge, against closed formulas

class Sheet : public testing::Test {
 protected:
  Sheet() {
    auto scene = ReadDelivered("pattern_cut");
    setup_ = scene->model->sheets[0];
    setup_.circle = 0.020;
    auto mesh = geometry::EditableMesh::Make(scene->patient.organs[0].mesh, 500, 1500);
    EXPECT_TRUE(mesh.ok());
    mesh_.emplace(std::move(*mesh));
    cutter_.emplace(*mesh_);
  }
  /// One stroke of a blade that stands upright in the sheet, in short pieces.
  void Cut(const Vec3& from, const Vec3& to) {
    geometry::CutFront front;
    constexpr int kPieces = 40;
    const auto edge = [&](double s) {
      const Vec3 p = setup_.centre + math::Lerp(from, to, s);
      return geometry::BladeEdge{p + Vec3{0, 0, 0.01}, p - Vec3{0, 0, 0.01}};
    };
    for (int i = 0; i < kPieces; ++i)
      (void)cutter_->Cut(edge(1.0 * i / kPieces), edge((i + 1.0) / kPieces), {}, front, *mesh_);
  }
  PatternCut Judge() const {
    surgery::PatternCutMonitor monitor({setup_.centre, setup_.half, setup_.circle}, *mesh_);
    monitor.Update(*mesh_);
    return monitor.Now();
  }

  ModelSheet setup_;
  std::optional<geometry::EditableMesh> mesh_;
  std::optional<geometry::SurfaceCutter> cutter_;
};

constexpr double kSnap = 0.0007;  // that a cut may lie beside the blade: a fifth of an edge

TEST_F(Sheet, UncutIsHeldAndRight) {
  const PatternCut now = Judge();
  EXPECT_FALSE(now.is_free);
  EXPECT_EQ(now.cut_length, 0);
  EXPECT_EQ(now.farthest, 0);
}

TEST_F(Sheet, ACutInsideCountsByItsDistanceFromTheLineOneOutsideDoesNot) {
  Cut({-0.010, 0.025, 0}, {0.010, 0.025, 0});
  EXPECT_EQ(Judge().farthest, 0) << "outside one may cut to get to the line";
  EXPECT_NEAR(Judge().cut_length, 0.020, 0.002);
  Cut({-0.008, 0.012, 0}, {0.008, 0.012, 0});
  EXPECT_NEAR(Judge().farthest, 0.020 - 0.012, kSnap);
  EXPECT_FALSE(Judge().is_free);
  EXPECT_EQ(Judge().off_area, 0) << "no piece yet";
}

TEST_F(Sheet, ASquareCutOutDiffersFromTheCircleAsTheFormulaSays) {
  // its sides are tangents of the circle, and cross: the area between is (4 - pi) r^2
  const double r = setup_.circle, beyond = r + 0.003;
  Cut({-beyond, -r, 0}, {beyond, -r, 0});
  Cut({r, -beyond, 0}, {r, beyond, 0});
  Cut({beyond, r, 0}, {-beyond, r, 0});
  EXPECT_FALSE(Judge().is_free);
  Cut({-r, beyond, 0}, {-r, -beyond, 0});
  const PatternCut now = Judge();
  EXPECT_TRUE(now.is_free);
  EXPECT_NEAR(now.farthest, (std::sqrt(2.0) - 1) * r, 0.0025) << "the corners; an edge is 3 mm long";
  EXPECT_NEAR(now.off_area, (4 - M_PI) * r * r, 0.1 * (4 - M_PI) * r * r);
}

// --- the expert's cut

TEST(PatternCut, TheExpertsPieceIsFreeRoundAndLeftWhereItWas) {
  const auto scene = ReadDelivered("pattern_cut");
  auto simulation = simulation::Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  auto surgeon = MakeSurgeon("expert", scene, 1);
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < 200)
    simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
  const simulation::Snapshot& now = simulation->GetSnapshot();
  ASSERT_EQ(now.operation.sheets.size(), 1u);
  const PatternCut& sheet = now.operation.sheets[0];
  EXPECT_TRUE(sheet.is_free);
  const double around = 2 * M_PI * scene->model->sheets[0].circle;
  EXPECT_GT(sheet.cut_length, around);
  EXPECT_LT(sheet.cut_length, 1.25 * around);
  EXPECT_LT(sheet.farthest, 0.002);
  EXPECT_GT(sheet.off_area, 0.0);
  EXPECT_LT(sheet.off_area, 100e-6);
  for (const Vec3& p : now.positions) {
    ASSERT_TRUE(std::isfinite(p.z));
    ASSERT_NEAR(p.z, scene->model->sheets[0].centre.z, 0.02) << "nothing flies away";
  }
}

struct SheetAround {
  double before = 0;   ///< farthest that a node moved across the sheet before it was cut [m]
  double outside = 0;  ///< how far the sheet outside the circle has drawn back from it, mean [m]
};

/// The expert's cut of a sheet under this strain.
SheetAround CutSheetUnder(double prestrain) {
  auto scene = std::make_shared<scene::Scene>(*ReadDelivered("pattern_cut"));
  ModelSheet& sheet = scene->model->sheets[0];
  sheet.prestrain = prestrain;
  auto simulation = simulation::Simulation::Make(scene);
  EXPECT_TRUE(simulation.ok());
  std::vector<Vec3> rest = simulation->GetSnapshot().positions;
  rest.resize(simulation->Surfaces()[0].node_count);
  const simulation::Snapshot& now = simulation->GetSnapshot();
  SheetAround found;
  auto surgeon = MakeSurgeon("expert", scene, 1);
  while (!(*surgeon)->HasFinished() && now.time < 200) {
    simulation->Step((*surgeon)->Act(now));
    if (now.operation.sheets[0].cut_length > 0.0) continue;
    for (std::size_t i = 0; i < rest.size(); ++i)
      found.before =
          std::max(found.before, std::hypot(now.positions[i].x - rest[i].x, now.positions[i].y - rest[i].y));
  }
  EXPECT_TRUE(now.operation.sheets[0].is_free);
  int count = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto radius = [&](const Vec3& p) { return std::hypot(p.x - sheet.centre.x, p.y - sheet.centre.y); };
    const double away = radius(rest[i]) - sheet.circle;
    if (away < 0.001 || away > 0.004) continue;
    found.outside += radius(now.positions[i]) - radius(rest[i]);
    ++count;
  }
  found.outside /= count;
  return found;
}

TEST(PatternCut, ASheetUnderTensionLiesStillAndDrawsBackFromTheCut) {
  const SheetAround tense = CutSheetUnder(ReadDelivered("pattern_cut")->model->sheets[0].prestrain);
  EXPECT_LT(tense.before, 1e-4);
  EXPECT_GT(tense.outside, 3e-4);
  EXPECT_LT(tense.outside, 2e-3);
  const SheetAround slack = CutSheetUnder(0.0);
  EXPECT_LT(std::abs(slack.outside), 5e-5) << "negative control";
}

}  // namespace
}  // namespace trocar::agent
