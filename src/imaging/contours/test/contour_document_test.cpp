// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

ControlPoints MakePoints() {
  ControlPoints points;
  points.name = "test";
  points.provenance = "made by the test";
  points.image_pattern = "image-{slice:04}.png";
  points.first_slice = 10, points.last_slice = 30;
  points.width = 200, points.height = 100;
  points.pixel_mm = 0.5, points.slice_mm = 2.0;
  points.axes = {"left", "posterior", "superior"};
  Structure liver;
  liver.name = "liver";
  liver.triangle_budget = 1000;
  liver.slices = {{12, {{{10, 10}, {60, 10}, {60, 50}, {10, 50}}}, {{{20, 20}, {30, 20}, {25, 30}}}, {}},
                  {20, {{{10, 10}, {60, 10}, {60, 50}}, {{100, 20}, {120, 20}, {110, 40}}}, {}, {}}};
  points.structures = {liver};
  return points;
}

const ContourId kFirst{0, 12, false, 0}, kHole{0, 12, true, 0}, kSecond{0, 20, false, 1};

struct Command {
  const char* name;
  std::function<base::Status(ContourDocument&)> run;
};

// one of every command, each allowed on MakePoints with an open contour of three points in slice 15
std::vector<Command> EveryCommand() {
  return {
      {"AddPoint",
       [](ContourDocument& d) {
         return d.AddPoint(0, 16, {5, 6});
       }},
      {"AddPath",
       [](ContourDocument& d) {
         const std::vector<Vec2> path = {{1, 2}, {3, 4}, {9, 9}};
         return d.AddPath(0, 12, path);
       }},
      {"CloseContour", [](ContourDocument& d) { return d.CloseContour(0, 15); }},
      {"RemoveLastPoint", [](ContourDocument& d) { return d.RemoveLastPoint(0, 15); }},
      {"DropOpenContour", [](ContourDocument& d) { return d.DropOpenContour(0, 15); }},
      {"MovePoint",
       [](ContourDocument& d) {
         return d.MovePoint(kFirst, 2, {70, 55});
       }},
      {"InsertPoint",
       [](ContourDocument& d) {
         return d.InsertPoint(kHole, 3, {21, 26});
       }},
      {"DeletePoint", [](ContourDocument& d) { return d.DeletePoint(kFirst, 0); }},
      {"DeleteContour", [](ContourDocument& d) { return d.DeleteContour(kSecond); }},
      {"DeleteContourWithItsHole", [](ContourDocument& d) { return d.DeleteContour(kFirst); }},
      {"DeleteHole", [](ContourDocument& d) { return d.DeleteContour(kHole); }},
      {"ToggleHole", [](ContourDocument& d) { return d.ToggleHole(kSecond); }},
      {"ToggleHoleBack", [](ContourDocument& d) { return d.ToggleHole(kHole); }},
      {"SetContours",
       [](ContourDocument& d) {
         return d.SetContours(0, 13, {{{1, 1}, {9, 1}, {5, 8}}}, {}, "propagate");
       }},
      {"ClearSlice", [](ContourDocument& d) { return d.ClearSlice(0, 20); }},
      {"AddStructure", [](ContourDocument& d) { return d.AddStructure("gallbladder", 500); }},
      {"RenameStructure", [](ContourDocument& d) { return d.RenameStructure(0, "liver \"left\""); }},
      {"DeleteStructure", [](ContourDocument& d) { return d.DeleteStructure(0); }},
      {"SetAdaption", [](ContourDocument& d) { return d.SetAdaption(0, {.max_shift_px = 7}); }},
  };
}

ContourDocument MakeDocument() {
  ControlPoints points = MakePoints();
  points.structures[0].slices.insert(points.structures[0].slices.begin() + 1,
                                     {15, {}, {}, {{40, 40}, {50, 40}, {45, 60}}});
  return ContourDocument(std::move(points));
}

TEST(ContourDocument, UndoOfEveryCommandIsIdentityAndRedoDoesItAgain) {
  for (const Command& command : EveryCommand()) {
    SCOPED_TRACE(command.name);
    ContourDocument document = MakeDocument();
    const std::string before = document.Text();
    const auto status = command.run(document);
    ASSERT_TRUE(status.ok()) << status.error().Text();
    const std::string after = document.Text();
    EXPECT_NE(before, after);
    EXPECT_TRUE(document.IsDirty());
    const auto undone = document.Undo();
    ASSERT_TRUE(undone.has_value());
    EXPECT_FALSE(undone->what.empty());
    EXPECT_EQ(document.Text(), before);
    EXPECT_FALSE(document.IsDirty());
    ASSERT_TRUE(document.Redo().has_value());
    EXPECT_EQ(document.Text(), after);
    EXPECT_FALSE(document.CanRedo());
  }
}

TEST(ContourDocument, EveryStateReadsBackUnchanged) {
  for (const Command& command : EveryCommand()) {
    SCOPED_TRACE(command.name);
    ContourDocument document = MakeDocument();
    ASSERT_TRUE(command.run(document).ok());
    const auto read = ParseControlPoints(document.Text(), "text", Completeness::kDraft);
    ASSERT_TRUE(read.ok()) << read.error().Text();
    EXPECT_EQ(FormatControlPoints(*read), document.Text());
  }
}

TEST(ContourDocument, RefusedCommandsNameTheReasonAndChangeNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Command> refused = {
      {"no such organ",
       [](ContourDocument& d) {
         return d.AddPoint(1, 12, {1, 1});
       }},
      {"negative organ",
       [](ContourDocument& d) {
         return d.AddPoint(-1, 12, {1, 1});
       }},
      {"slice outside",
       [](ContourDocument& d) {
         return d.AddPoint(0, 31, {1, 1});
       }},
      {"no number",
       [nan](ContourDocument& d) {
         return d.AddPoint(0, 12, {nan, 1});
       }},
      {"nothing open", [](ContourDocument& d) { return d.CloseContour(0, 12); }},
      {"nothing to remove", [](ContourDocument& d) { return d.RemoveLastPoint(0, 12); }},
      {"nothing to drop", [](ContourDocument& d) { return d.DropOpenContour(0, 12); }},
      {"hole without contour", [](ContourDocument& d) { return d.CloseContour(0, 15, true); }},
      {"no contour",
       [](ContourDocument& d) {
         return d.MovePoint({0, 12, false, 1}, 0, {1, 1});
       }},
      {"negative contour",
       [](ContourDocument& d) {
         return d.DeleteContour({0, 12, false, -1});
       }},
      {"no point",
       [](ContourDocument& d) {
         return d.MovePoint(kFirst, 4, {1, 1});
       }},
      {"point moved to no number",
       [nan](ContourDocument& d) {
         return d.MovePoint(kFirst, 0, {1, nan});
       }},
      {"no place",
       [](ContourDocument& d) {
         return d.InsertPoint(kFirst, 5, {1, 1});
       }},
      {"two would remain", [](ContourDocument& d) { return d.DeletePoint(kHole, 0); }},
      {"two places would remain",
       [](ContourDocument& d) {
         return d.MovePoint(kHole, 0, {30, 20});
       }},
      {"only contour as hole", [](ContourDocument& d) { return d.ToggleHole(kFirst); }},
      {"contour of two",
       [](ContourDocument& d) {
         return d.SetContours(0, 13, {{{1, 1}, {2, 2}}}, {}, "x");
       }},
      {"only a hole",
       [](ContourDocument& d) {
         return d.SetContours(0, 13, {}, {{{1, 1}, {2, 2}, {3, 0}}}, "x");
       }},
      {"empty slice", [](ContourDocument& d) { return d.ClearSlice(0, 13); }},
      {"name used", [](ContourDocument& d) { return d.AddStructure("liver", 500); }},
      {"no name", [](ContourDocument& d) { return d.RenameStructure(0, ""); }},
      {"too few triangles", [](ContourDocument& d) { return d.AddStructure("gallbladder", 4); }},
      {"blur of nothing", [](ContourDocument& d) { return d.SetAdaption(0, {.blur_px = 0}); }},
  };
  for (const Command& command : refused) {
    SCOPED_TRACE(command.name);
    ContourDocument document = MakeDocument();
    const std::string before = document.Text();
    const auto status = command.run(document);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, base::ErrorCode::kEditRefused);
    EXPECT_FALSE(status.error().message.empty());
    EXPECT_EQ(document.Text(), before);
    EXPECT_FALSE(document.CanUndo());
    EXPECT_FALSE(document.IsDirty());
  }
}

TEST(ContourDocument, ContourOfTwoPointsIsNotClosed) {
  ContourDocument document(MakePoints());
  ASSERT_TRUE(document.AddPoint(0, 14, {1, 1}).ok());
  ASSERT_TRUE(document.AddPoint(0, 14, {5, 1}).ok());
  ASSERT_FALSE(document.CloseContour(0, 14).ok());
  ASSERT_TRUE(document.AddPoint(0, 14, {5, 9}).ok());
  EXPECT_TRUE(document.CloseContour(0, 14).ok());
  EXPECT_EQ(document.At(0, 14).contours.size(), 1u);
  EXPECT_EQ(document.ContouredSlices(0), (std::vector<int>{12, 14, 20}));
}

TEST(ContourDocument, PointsStayInThePictureAndOnTheFilesGrain) {
  ContourDocument document(MakePoints());
  ASSERT_TRUE(document.AddPoint(0, 14, {-20, 500}).ok());
  EXPECT_EQ(document.At(0, 14).open.front(), (Vec2{0, 99}));
  ASSERT_TRUE(document.MovePoint(kFirst, 0, {10.123456, 10.987654}).ok());
  EXPECT_EQ(document.Find(kFirst)[0], (Vec2{10.12, 10.99}));
}

TEST(ContourDocument, RandomSequencesUndoneToTheStartGiveTheSameBytes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    math::Random random(seed);
    const auto any = [&](int count) { return static_cast<int>(random.Uniform() * count); };
    ContourDocument document(MakePoints());
    const std::string start = document.Text();
    std::vector<std::string> texts = {start};
    int refused = 0;
    for (int step = 0; step < 300; ++step) {
      const int structure = any(static_cast<int>(document.Points().structures.size()) + 1);
      const int slice = 10 + any(6);
      const ContourId id{structure, slice, any(4) == 0, any(3)};
      const Vec2 p{random.Uniform() * 220 - 10, random.Uniform() * 120 - 10};
      const auto point = static_cast<std::size_t>(any(6));
      const std::uint64_t revision = document.Revision();
      const auto run = [&]() -> base::Status {
        switch (any(17)) {
          case 0:
          case 1:
          case 2:
          case 3:
            return document.AddPoint(structure, slice, p);
          case 4:
          case 5:
            return document.CloseContour(structure, slice, any(4) == 0);
          case 6:
            return document.DropOpenContour(structure, slice);
          case 7:
            return document.InsertPoint(id, point, p);
          case 8:
            return document.DeletePoint(id, point);
          case 9:
            return document.DeleteContour(id);
          case 10:
            return document.ToggleHole(id);
          case 11:
            return document.SetContours(structure, slice, {{p, {1, 1}, {2, 50}}}, {}, "set");
          case 12:
            return document.AddStructure("organ" + std::to_string(step), 500);
          case 13:
            return any(3) == 0 ? document.DeleteStructure(structure) : document.ClearSlice(structure, slice);
          case 14:
            return document.RenameStructure(structure, "name" + std::to_string(any(5)));
          case 15:
            return document.SetAdaption(structure, {.max_shift_px = random.Uniform() * 30});
          default: {
            document.BeginGesture();
            const auto status = document.MovePoint(id, point, p);
            (void)document.MovePoint(id, point, p + Vec2{1, 1});
            document.EndGesture();
            return status;
          }
        }
      };
      const auto status = run();
      refused += !status.ok();
      if (document.Revision() != revision && document.Text() != texts.back())
        texts.push_back(document.Text());
    }
    EXPECT_GT(texts.size(), 80u) << refused << " refused";
    const std::string last = document.Text();
    std::size_t back = texts.size() - 1;
    while (document.Undo()) {
      ASSERT_GT(back, 0u);
      ASSERT_EQ(document.Text(), texts[--back]);
    }
    EXPECT_EQ(back, 0u);
    EXPECT_EQ(document.Text(), start);
    EXPECT_FALSE(document.IsDirty());
    while (document.Redo()) {
    }
    EXPECT_EQ(document.Text(), last);
  }
}

TEST(ContourDocument, DragIsOneStep) {
  ContourDocument document(MakePoints());
  const std::string before = document.Text();
  document.BeginGesture();
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(document.MovePoint(kFirst, 0, {10.0 + i, 12.0}).ok());
  EXPECT_FALSE(document.CanUndo()) << "not while dragging";
  document.EndGesture();
  EXPECT_EQ(document.Find(kFirst)[0], (Vec2{59, 12}));
  const std::size_t bytes = document.HistoryBytes();
  EXPECT_LT(bytes, 2000u) << "the positions in between are not kept";
  ASSERT_TRUE(document.Undo().has_value());
  EXPECT_EQ(document.Text(), before);
  EXPECT_FALSE(document.CanUndo());
}

TEST(ContourDocument, DragBackOrCancelledIsNothing) {
  ContourDocument document(MakePoints());
  const std::string before = document.Text();
  document.BeginGesture();
  ASSERT_TRUE(document.MovePoint(kFirst, 0, {30, 30}).ok());
  ASSERT_TRUE(document.MovePoint(kFirst, 0, {10, 10}).ok());
  document.EndGesture();
  EXPECT_FALSE(document.CanUndo());
  EXPECT_FALSE(document.IsDirty());
  document.BeginGesture();
  ASSERT_TRUE(document.InsertPoint(kFirst, 1, {30, 9}).ok());
  ASSERT_TRUE(document.MovePoint(kFirst, 1, {35, 5}).ok());
  document.CancelGesture();
  EXPECT_EQ(document.Text(), before);
  EXPECT_FALSE(document.CanUndo());
  EXPECT_FALSE(document.IsDirty());
}

TEST(ContourDocument, HistoryIsBoundedAndForgetsTheOldestFirst) {
  ContourDocument document(MakePoints(), 4000);
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(document.MovePoint(kFirst, 0, {10.0 + 0.1 * (i + 1), 12.0}).ok());
    ASSERT_LE(document.HistoryBytes(), 4000u);
  }
  int steps = 0;
  while (document.Undo()) ++steps;
  EXPECT_GE(steps, 2);
  EXPECT_LT(steps, 20);
  EXPECT_NEAR(document.Find(kFirst)[0].x, 10.0 + 0.1 * (200 - steps), 1e-9);
  EXPECT_TRUE(document.IsDirty()) << "the saved state is no longer reachable";
}

TEST(ContourDocument, ANewStepForgetsWhatWasUndone) {
  ContourDocument document(MakePoints());
  ASSERT_TRUE(document.MovePoint(kFirst, 0, {11, 11}).ok());
  ASSERT_TRUE(document.Undo().has_value());
  ASSERT_TRUE(document.MovePoint(kFirst, 0, {12, 12}).ok());
  EXPECT_FALSE(document.CanRedo());
  EXPECT_EQ(document.UndoText(), "move a point");
}

TEST(ContourDocument, IsDirtyAgainstTheLastSave) {
  ContourDocument document(MakePoints());
  ASSERT_TRUE(document.AddPoint(0, 14, {1, 1}).ok());
  document.MarkSaved();
  EXPECT_FALSE(document.IsDirty());
  ASSERT_TRUE(document.Undo().has_value());
  EXPECT_TRUE(document.IsDirty());
  ASSERT_TRUE(document.Redo().has_value());
  EXPECT_FALSE(document.IsDirty());
  ASSERT_TRUE(document.Undo().has_value());
  ASSERT_TRUE(document.AddPoint(0, 14, {2, 2}).ok());
  EXPECT_TRUE(document.IsDirty()) << "another way from the same state is not the saved one";
  document.MarkUnsaved();
  ASSERT_TRUE(document.Undo().has_value());
  EXPECT_TRUE(document.IsDirty());
}

TEST(ControlPointDrafts, OnlyDraftsMayBeUnfinished) {
  ContourDocument document(MakePoints());
  const auto is_patient = [&] { return ParseControlPoints(document.Text(), "text").ok(); };
  EXPECT_TRUE(is_patient());
  ASSERT_TRUE(document.AddPoint(0, 12, {1, 1}).ok());
  const auto open = ParseControlPoints(document.Text(), "text");
  ASSERT_FALSE(open.ok());
  EXPECT_EQ(open.error().code, base::ErrorCode::kContourTooShort);
  EXPECT_NE(open.error().message.find("not closed"), std::string::npos);
  ASSERT_TRUE(document.DropOpenContour(0, 12).ok());
  ASSERT_TRUE(document.AddStructure("gallbladder", 500).ok());
  EXPECT_FALSE(is_patient());
  EXPECT_TRUE(ParseControlPoints(document.Text(), "text", Completeness::kDraft).ok());
}

TEST(ControlPointDrafts, DraftsAreStillChecked) {
  ContourDocument document(MakePoints());
  std::string text = document.Text();
  const auto replace = [&text](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return ParseControlPoints(changed, "text", Completeness::kDraft);
  };
  EXPECT_FALSE(replace("[[[10, 10], [60, 10], [60, 50], [10, 50]]]", "[]").ok()) << "a hole in nothing";
  EXPECT_FALSE(replace("[[[10, 10], [60, 10], [60, 50], [10, 50]]]", "[[[10, 10], [60, 10]]]").ok());
  EXPECT_FALSE(replace("\"slice\": 20,", "\"slice\": 20, \"open\": [[500, 10]],").ok());
  EXPECT_FALSE(replace("\"slice\": 20,", "\"slice\": 20, \"opened\": [[5, 10]],").ok());
  EXPECT_TRUE(replace("\"slice\": 20,", "\"slice\": 20, \"open\": [[5, 10]],").ok());
}

}  // namespace
}  // namespace trocar::contours
