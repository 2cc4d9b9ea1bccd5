// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "trocar/patient/patient.h"

namespace trocar::editor {
namespace {

using math::Vec3;

class PatientEditorTest : public testing::Test {
 protected:
  PatientEditorTest() : editor_(Open()) {}
  static anatomy::PatientDocument Open() {
    auto document = anatomy::PatientDocument::Open(std::string(TROCAR_SOURCE_DIR) +
                                                   "/assets/patients/visible-human-male/patient");
    EXPECT_TRUE(document.ok()) << document.error().Text();
    return std::move(document).value();
  }
  std::uint32_t TubeIndex(std::string_view name) const {
    const auto& tubes = editor_.GetPatient().tubes;
    return static_cast<std::uint32_t>(
        std::find_if(tubes.begin(), tubes.end(), [&](auto& t) { return t.name == name; }) - tubes.begin());
  }
  std::size_t RegionSize(std::string_view organ, std::string_view name) const {
    for (const auto& region : editor_.GetPatient().organs[editor_.GetPatient().FindOrgan(organ)].regions) {
      if (region.name == name) return region.vertices.size();
    }
    return 0;
  }
  /// What a ray from the front at a vertex of an organ meets there.
  render::SurfaceHit HitAt(std::size_t surface, std::uint32_t triangle) const {
    const auto& mesh = editor_.GetPatient().organs[surface].mesh;
    const auto& t = mesh.triangles[triangle];
    return {surface, triangle, t[0], mesh.positions[t[0]], 0.1};
  }
  PatientEditor editor_;
};

TEST_F(PatientEditorTest, LookToolTakesNothing) {
  EXPECT_FALSE(editor_.Press(HitAt(0, 5), std::nullopt, false));
  EXPECT_FALSE(editor_.Document().IsDirty());
  EXPECT_FALSE(editor_.Wheel(std::nullopt, true, 1));
}

TEST_F(PatientEditorTest, StrokeIsOneStepAndShiftErases) {
  editor_.tool = EditorTool::kPaint;
  editor_.region = {"liver", "bare_area"};
  EXPECT_FALSE(editor_.Press(std::nullopt, std::nullopt, false));
  EXPECT_FALSE(editor_.Press(HitAt(1, 0), std::nullopt, false)) << "another organ turns the view";
  ASSERT_TRUE(editor_.Press(HitAt(0, 5), std::nullopt, false));
  ASSERT_TRUE(editor_.Drag(HitAt(0, 900), {}).ok());
  ASSERT_TRUE(editor_.Drag(std::nullopt, {}).ok());  // beside the organ
  editor_.Release();
  const auto painted = RegionSize("liver", "bare_area");
  EXPECT_GT(painted, 4u);
  ASSERT_TRUE(editor_.Press(HitAt(0, 5), std::nullopt, true));
  editor_.Release();
  EXPECT_LT(RegionSize("liver", "bare_area"), painted);
  editor_.Undo();
  EXPECT_EQ(RegionSize("liver", "bare_area"), painted);
  editor_.Undo();
  EXPECT_EQ(RegionSize("liver", "bare_area"), 0u);
  EXPECT_FALSE(editor_.Document().IsDirty());
  editor_.Redo();
  EXPECT_EQ(RegionSize("liver", "bare_area"), painted);
}

TEST_F(PatientEditorTest, DuctIsChosenAndItsPointDragged) {
  editor_.tool = EditorTool::kTubes;
  const auto duct = TubeIndex("common_bile_duct");
  render::SurfaceHit hit;
  hit.surface = editor_.GetPatient().organs.size() + duct;
  hit.point = editor_.GetPatient().tubes[duct].line.points[6];
  EXPECT_TRUE(editor_.Press(hit, std::nullopt, false));
  EXPECT_EQ(editor_.Tube(), duct);
  EXPECT_FALSE(editor_.Document().IsDirty());
  // its points are in the figure, in their order
  const auto figure = editor_.MakeFigure(std::nullopt);
  EXPECT_EQ(figure.marks.points.size(), editor_.GetPatient().tubes[duct].line.points.size());
  const Vec3 before = editor_.GetPatient().tubes[duct].line.points[6];
  ASSERT_TRUE(editor_.Press(hit, 6, false));
  EXPECT_EQ(editor_.Grabbed(), before);
  ASSERT_TRUE(editor_.Drag(std::nullopt, before + Vec3{0.001, 0, 0}).ok());
  ASSERT_TRUE(editor_.Drag(std::nullopt, before + Vec3{0.003, 0, 0}).ok());
  editor_.Release();
  EXPECT_NEAR(Distance(editor_.GetPatient().tubes[duct].line.points[6], before + Vec3{0.003, 0, 0}), 0,
              1e-12);
  editor_.Undo();
  EXPECT_EQ(editor_.GetPatient().tubes[duct].line.points[6], before);
}

TEST_F(PatientEditorTest, PointsAreInsertedByShiftClickAndDeleted) {
  editor_.tool = EditorTool::kTubes;
  const auto duct = TubeIndex("cystic_duct");
  const auto count = editor_.GetPatient().tubes[duct].line.points.size();
  render::SurfaceHit hit;
  hit.surface = editor_.GetPatient().organs.size() + duct;
  hit.point = 0.5 * (editor_.GetPatient().tubes[duct].line.points[4] +
                     editor_.GetPatient().tubes[duct].line.points[5]);
  EXPECT_TRUE(editor_.Press(hit, std::nullopt, true));
  EXPECT_EQ(editor_.GetPatient().tubes[duct].line.points.size(), count + 1);
  EXPECT_EQ(editor_.TubePoint(), 5u);
  ASSERT_TRUE(editor_.DeletePoint().ok());
  EXPECT_EQ(editor_.GetPatient().tubes[duct].line.points.size(), count);
  editor_.ChooseTubePoint(std::nullopt);
  EXPECT_EQ(editor_.DeletePoint().error().code, base::ErrorCode::kUsage);
}

TEST_F(PatientEditorTest, WheelChangesBrushAndRadius) {
  editor_.tool = EditorTool::kPaint;
  const double brush = editor_.brush_radius;
  EXPECT_FALSE(editor_.Wheel(std::nullopt, false, 1));
  EXPECT_TRUE(editor_.Wheel(std::nullopt, true, 1));
  EXPECT_GT(editor_.brush_radius, brush);
  for (int i = 0; i < 200; ++i) editor_.Wheel(std::nullopt, true, 1);
  EXPECT_DOUBLE_EQ(editor_.brush_radius, 0.040);
  editor_.tool = EditorTool::kTubes;
  const auto duct = TubeIndex("cystic_duct");
  editor_.ChooseTube(duct);
  const double radius = editor_.GetPatient().tubes[duct].line.radii[3];
  EXPECT_TRUE(editor_.Wheel(3, false, 2));
  EXPECT_GT(editor_.GetPatient().tubes[duct].line.radii[3], 1.2 * radius);
}

TEST_F(PatientEditorTest, WhatWasChosenIsDroppedWhenUndoTakesItAway) {
  const auto count = static_cast<std::uint32_t>(editor_.GetPatient().tubes.size());
  ASSERT_TRUE(editor_.Document()
                  .Edit("add",
                        [](patient::Patient& p) {
                          return anatomy::AddTube(p, {"extra",
                                                      patient::TubeKind::kDuct,
                                                      "",
                                                      "",
                                                      {{{0, 0, 0}, {0, 0, 0.01}}, {0.001, 0.001}},
                                                      true});
                        })
                  .ok());
  editor_.ChooseTube(count);
  editor_.ChooseTubePoint(1);
  editor_.Undo();
  EXPECT_FALSE(editor_.Tube().has_value());
  EXPECT_FALSE(editor_.TubePoint().has_value());
  editor_.ChooseTube(99);
  EXPECT_FALSE(editor_.Tube().has_value());
}

TEST_F(PatientEditorTest, LandmarkIsDragged) {
  editor_.tool = EditorTool::kLandmarks;
  EXPECT_FALSE(editor_.Press(std::nullopt, std::nullopt, false));
  ASSERT_TRUE(editor_.Press(std::nullopt, 0, false));
  const Vec3 wanted = editor_.Grabbed() + Vec3{0.002, 0, 0};
  ASSERT_TRUE(editor_.Drag(std::nullopt, wanted).ok());
  editor_.Release();
  EXPECT_LT(Distance(editor_.GetPatient().landmarks[0].position, wanted), 0.003);
  EXPECT_TRUE(editor_.Document().CanUndo());
}

TEST_F(PatientEditorTest, FigurePicksOnlyThePaintedOrgan) {
  editor_.tool = EditorTool::kPaint;
  editor_.region = {"gallbladder", patient::kGallbladderBed};
  const auto figure = editor_.MakeFigure(HitAt(1, 3));
  EXPECT_FALSE(figure.surfaces[0].is_pickable);
  EXPECT_TRUE(figure.surfaces[1].is_pickable);
  ASSERT_EQ(figure.marks.lines.size(), 1u);  // the brush
  for (const auto& p : figure.marks.lines[0].points)
    EXPECT_NEAR(Distance(p, HitAt(1, 3).point), editor_.brush_radius, 1e-9);
}

TEST(EditorTool, NamesAreFound) {
  EXPECT_EQ(FindEditorTool("tubes"), EditorTool::kTubes);
  EXPECT_FALSE(FindEditorTool("saw").has_value());
}

}  // namespace
}  // namespace trocar::editor
