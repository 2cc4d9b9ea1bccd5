// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_editor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "disc_series.h"
#include "trocar/editor/contour_read_outs.h"
#include "trocar/editor/contour_script.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::editor {

using math::Vec2;

namespace {

class Editor : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = OpenDisc(folder_.Path() / "slices");
    ASSERT_TRUE(opened.ok()) << opened.error().Text();
    workspace_.emplace(std::move(*opened));
    editor_.emplace(*workspace_);
    editor_->size = {600, 500};
    editor_->view = {4, {60, 50}};
    editor_->on_error = [this](const base::Error& error) { error_ = error; };
  }
  Vec2 At(const Vec2& p) const { return ToCanvas(editor_->view, editor_->size, p); }
  Vec2 OnDisc(double degrees, double radius = 30) const {
    return {60 + radius * std::cos(degrees * M_PI / 180), 50 + radius * std::sin(degrees * M_PI / 180)};
  }
  void Click(const Vec2& p, bool is_double = false) {
    editor_->Press(At(p), is_double);
    editor_->Release();
  }
  void DrawDisc() {
    for (int i = 0; i < 8; ++i) Click(OnDisc(45 * i, 29));
    editor_->Do(ContourAction::kCloseContour);
  }

  test::TemporaryFolder folder_;
  std::optional<contours::ContourWorkspace> workspace_;
  std::optional<ContourEditor> editor_;
  std::optional<base::Error> error_;
};

TEST_F(Editor, ClicksDrawAContourAndADoubleClickClosesIt) {
  for (int i = 0; i < 7; ++i) Click(OnDisc(45 * i));
  EXPECT_EQ(editor_->Here().open.size(), 7u);
  EXPECT_NE(SliceText(*editor_).find("7 points of an open contour"), std::string::npos);
  Click(OnDisc(315));
  Click(OnDisc(315), true);
  EXPECT_TRUE(editor_->Here().open.empty());
  ASSERT_EQ(editor_->Here().contours.size(), 1u);
  EXPECT_EQ(editor_->Here().contours[0].size(), 8u);
  // 30 pixels of 0.5 mm
  const double area = CalcArea(**editor_->Fit(), 0.5);
  EXPECT_NEAR(area, M_PI * 15 * 15, 0.04 * M_PI * 15 * 15);
  EXPECT_NE(SliceText(*editor_).find("1 contour \u00b7 8 points"), std::string::npos) << SliceText(*editor_);
}

TEST_F(Editor, AClickOnTheFirstPointCloses) {
  for (int i = 0; i < 5; ++i) Click(OnDisc(72 * i));
  Click(OnDisc(0) + Vec2{1, 1});
  EXPECT_EQ(editor_->Here().contours.size(), 1u);
}

TEST_F(Editor, PointsAreDraggedAsOneStep) {
  DrawDisc();
  const std::string before = workspace_->Document().Text();
  editor_->Press(At(OnDisc(0, 29)), false);
  EXPECT_TRUE(editor_->IsDragging());
  for (int i = 1; i <= 20; ++i) editor_->Drag(At(OnDisc(0, 29) + Vec2{0.1 * i, 0}));
  editor_->Release();
  EXPECT_NEAR(editor_->Here().contours[0][0].x, 91, 0.02);
  editor_->Do(ContourAction::kUndo);
  EXPECT_EQ(workspace_->Document().Text(), before);
}

TEST_F(Editor, EscapeTakesADragBack) {
  DrawDisc();
  const std::string before = workspace_->Document().Text();
  editor_->Press(At(OnDisc(0, 29)), false);
  editor_->Drag(At({100, 60}));
  EXPECT_NE(workspace_->Document().Text(), before);
  editor_->Do(ContourAction::kCancel);
  EXPECT_EQ(workspace_->Document().Text(), before);
  EXPECT_FALSE(editor_->IsDragging());
}

TEST_F(Editor, AClickOnTheCurveInsertsAPointBetweenItsNeighbours) {
  DrawDisc();
  editor_->Press(At(OnDisc(22.5)), false);
  editor_->Drag(At(OnDisc(22.5, 31)));
  editor_->Release();
  ASSERT_EQ(editor_->Here().contours[0].size(), 9u);
  EXPECT_LT(Norm(editor_->Here().contours[0][1] - OnDisc(22.5, 31)), 1.0);
  editor_->Do(ContourAction::kUndo);
  EXPECT_EQ(editor_->Here().contours[0].size(), 8u) << "insertion and drag are one step";
}

TEST_F(Editor, TheRightButtonDeletesPoints) {
  DrawDisc();
  editor_->SecondaryPress(At(OnDisc(90, 29)));
  EXPECT_EQ(editor_->Here().contours[0].size(), 7u);
  editor_->SecondaryPress(At({60, 50}));
  EXPECT_EQ(editor_->Here().contours[0].size(), 7u) << "nothing lies there";
  while (!editor_->Here().contours.empty()) editor_->SecondaryPress(At(editor_->Here().contours[0][0]));
  EXPECT_FALSE(error_.has_value());
  Click({10, 10});
  Click({20, 10});
  editor_->SecondaryPress(At({60, 50}));
  EXPECT_EQ(editor_->Here().open.size(), 1u) << "while drawing, the last point";
}

TEST_F(Editor, HolesNeedAContourAndSayWhy) {
  DrawDisc();
  editor_->Do(ContourAction::kToggleHole);
  ASSERT_TRUE(error_.has_value());
  EXPECT_EQ(error_->code, base::ErrorCode::kEditRefused);
  for (int i = 0; i < 4; ++i) Click(OnDisc(90 * i, 10));
  editor_->Do(ContourAction::kToggleHole);
  EXPECT_EQ(editor_->Here().holes.size(), 1u);
  EXPECT_NE(SliceText(*editor_).find("1 hole"), std::string::npos);
}

TEST_F(Editor, CarriesToTheNextSliceByTheStep) {
  editor_->SetSlice(1);
  DrawDisc();
  editor_->SetSliceStep(3);
  editor_->Do(ContourAction::kPropagateForward);
  EXPECT_EQ(editor_->Slice(), 4);
  ASSERT_EQ(editor_->Here().contours.size(), 1u);
  EXPECT_EQ(editor_->FindContoured(-1), 1);
  EXPECT_EQ(editor_->FindContoured(1), std::nullopt);
  editor_->Do(ContourAction::kPreviousContoured);
  EXPECT_EQ(editor_->Slice(), 1);
  editor_->Do(ContourAction::kStepForward);
  EXPECT_EQ(editor_->Slice(), 4);
  editor_->Do(ContourAction::kUndo);
  EXPECT_EQ(editor_->Slice(), 4) << "undo goes where it happened";
  EXPECT_TRUE(editor_->Here().contours.empty());
}

TEST_F(Editor, ScissorsDrawAlongTheEdgeAndBackToTheFirstPoint) {
  editor_->SetScissors(true);
  Click(OnDisc(0));
  Click(OnDisc(120));
  editor_->Hover(At(OnDisc(180)));
  EXPECT_GT(editor_->RubberLine().size(), 20u) << "the path, not a straight line";
  Click(OnDisc(240));
  editor_->Do(ContourAction::kCloseContour);
  ASSERT_EQ(editor_->Here().contours.size(), 1u);
  for (const Vec2& p : editor_->Here().contours[0]) EXPECT_NEAR(Norm(p - Vec2{60, 50}), 30, 2.5);
}

TEST_F(Editor, PointerAndSeriesAreDescribed) {
  editor_->Hover(At({12.25, 40}));
  EXPECT_EQ(PointerText(*editor_).rfind("pixel 12.2, 40.0", 0), 0u) << PointerText(*editor_);
  editor_->Hover(std::nullopt);
  EXPECT_TRUE(PointerText(*editor_).empty());
  EXPECT_NE(SeriesText(workspace_->Series()).find("120 x 100 pixels of 0.5 mm"), std::string::npos);
}

TEST_F(Editor, AScriptDoesWhatTheHandDoes) {
  DrawDisc();
  const std::string by_hand = workspace_->Document().Text();
  editor_->Do(ContourAction::kClearSlice);
  std::string script = "# the same disc\n";
  for (int i = 0; i < 8; ++i) {
    const Vec2 p = OnDisc(45 * i, 29);
    script += "click " + std::to_string(p.x) + " " + std::to_string(p.y) + "  # a point\n";
  }
  const auto steps = ParseContourScript(script + "\nclose\n", "script");
  ASSERT_TRUE(steps.ok()) << steps.error().Text();
  ASSERT_EQ(steps->size(), 9u);
  for (const ScriptStep& step : *steps) {
    const auto done = RunScriptStep(step, *editor_);
    ASSERT_TRUE(done.ok()) << done.error().Text();
    EXPECT_TRUE(*done);
  }
  EXPECT_EQ(workspace_->Document().Text(), by_hand);
}

TEST_F(Editor, EveryScriptVerbRuns) {
  const std::string saved = (folder_.Path() / "saved.json").string();
  const std::string script =
      "slice 2\nclick 30 50\nclick 60 20\nclick 90 50\nclick 60 80\nclose\nclick 55 45\nclick 65 45\n"
      "click 60 55\nclose-hole\nmove 0 1 60 21\ninsert h0 3 56 50\ndelete-point h0 3\nchoose 0 2\nchoose h0\n"
      "hole h0\nhole 1\nundo\nredo\npropagate 3\nclear\nclick 5 5\ndrop\nreach 6\norgan gallbladder\n"
      "add-organ spleen 700\nrename-organ milt\ndelete-organ\nscissors on\nscissors off\npointer 60 50\n"
      "view 60 50 3\nfit organ\nfit picture\nedge 30 50\nedge 60 20\ndrop\nslice 2\ndelete 0\nundo\n"
      "show reference on\nawait mesh\nsave " +
      saved + "\n";
  const auto steps = ParseContourScript(script, "script");
  ASSERT_TRUE(steps.ok()) << steps.error().Text();
  std::set<std::string> window_verbs;
  for (const ScriptStep& step : *steps) {
    const auto done = RunScriptStep(step, *editor_);
    ASSERT_TRUE(done.ok()) << done.error().Text();
    if (!*done) window_verbs.insert(step.verb);
  }
  EXPECT_EQ(window_verbs, (std::set<std::string>{"await", "show"}));
  const auto read = contours::ReadControlPoints(saved, contours::Completeness::kDraft);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->structures.size(), 2u);
  EXPECT_EQ(read->structures[0].slices.size(), 1u);
  EXPECT_EQ(read->structures[0].slices[0].holes.size(), 1u);
}

TEST_F(Editor, WrongScriptsNameTheLine) {
  for (const char* text : {"slice 1\nnonsense 3\n", "slice 1\nclick 3\n", "slice 1\nclick 1 2 3\n"}) {
    const auto steps = ParseContourScript(text, "my.script");
    ASSERT_FALSE(steps.ok()) << text;
    EXPECT_EQ(steps.error().code, base::ErrorCode::kScriptInvalid);
    EXPECT_NE(steps.error().message.find("my.script, line 2"), std::string::npos) << steps.error().message;
  }
  for (const char* text : {"click one 2", "slice 1.5", "move x 0 1 1", "move h-1 0 1 1", "insert 0 -1 1 1",
                           "close", "slice 99", "organ spleen", "view 1 1 1000", "undo"}) {
    const auto steps = ParseContourScript(text, "script");
    ASSERT_TRUE(steps.ok()) << text;
    const std::string before = workspace_->Document().Text();
    const auto done = RunScriptStep(steps->front(), *editor_);
    ASSERT_FALSE(done.ok()) << text;
    EXPECT_NE(done.error().message.find("line 1"), std::string::npos) << done.error().message;
    EXPECT_EQ(workspace_->Document().Text(), before);
  }
}

}  // namespace
}  // namespace trocar::editor
