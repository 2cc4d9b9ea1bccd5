// SPDX-License-Identifier: Apache-2.0
// Task files, good and bad.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::files {

using instrument::kLeft;
using scene::CalcLaparoscopePose;
using scene::ConditionKind;
using scene::FindView;
using scene::LaparoscopeSetup;
using scene::ObjectColour;
namespace {

namespace fs = std::filesystem;

/// A cube on a board, and the task to lift it.
constexpr const char* kTask = R"({
  "format": "trocar-task", "version": 1, "name": "Lift", "about": "Lift the cube.",
  "levels": ["easy", "normal"],
  "parameters": {"size": {"by_level": {"easy": 12, "normal": 8}}, "x": {"value": 3, "spread": 2}},
  "scene": {
    "instruments": {
      "left": {"tool": "maryland", "port_mm": [-70, -90, 0], "tip": {"at_mm": [-30, 10, -95]}},
      "right": {"tool": "maryland", "port_mm": [70, -90, 0], "tip": {"at_mm": [30, 10, -95]}}},
    "laparoscope": {"port_mm": [0, -110, -5], "target": {"at_mm": [0, 30, -135]}, "depth_mm": 50},
    "objects": [
      {"name": "cube", "mass_g": 3, "colour": "red", "at_mm": ["{x}", "-{x}", -136], "shapes": [{"kind": "box", "size_mm": ["{size}", 8, 8]}]},
      {"name": "board", "at_mm": [0, 30, -145], "shapes": [{"kind": "box", "size_mm": [170, 130, 10]}]}]},
  "regions": [{"name": "up", "centre_mm": [0, 0, -100], "radius_mm": 20}],
  "rules": {
    "time_limit_s": 60, "points_per_second_left": 1,
    "goals": [{"name": "Lift the {each}", "for_each": ["cube"], "steps": [{"kind": "lifted", "object": "{each}", "hand": "left", "height_mm": 10}]}],
    "errors": [{"name": "dropped", "about": "The cube fell", "when": {"kind": "dropped", "object": "cube"}}]}})";

class TaskFile : public testing::Test {
 protected:
  base::Result<scene::Scene> Read(const std::string& text, const TaskChoice& choice = {}) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / "task.json", text).ok());
    return ReadTask(folder_.Path() / "task.json", choice);
  }
  /// The good task with one piece of its text replaced.
  base::Result<scene::Scene> ReadWith(const std::string& what, const std::string& by) {
    std::string text = kTask;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return Read(text.replace(at, what.size(), by));
  }
  test::TemporaryFolder folder_;
};

TEST_F(TaskFile, IsReadWithItsSceneAndRules) {
  const auto scene = Read(kTask);
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_FALSE(scene->HasPatient());
  ASSERT_EQ(scene->objects.size(), 2u);
  EXPECT_NEAR(scene->objects[0].body.mass, 0.003, 1e-12);
  EXPECT_NEAR(scene->objects[0].body.shapes[0].size.x, 0.004, 1e-12);
  EXPECT_EQ(scene->objects[0].colour, ObjectColour::kRed);
  EXPECT_FALSE(scene->objects[1].Moves());
  ASSERT_TRUE(scene->task.has_value());
  ASSERT_EQ(scene->task->goals.size(), 1u);
  EXPECT_EQ(scene->task->goals[0].name, "Lift the cube");
  EXPECT_EQ(scene->task->goals[0].steps[0].object, 0);
  EXPECT_EQ(scene->task->goals[0].steps[0].hand, kLeft);
  EXPECT_NEAR(scene->task->goals[0].steps[0].amount, 0.010, 1e-12);
  EXPECT_EQ(scene->task->errors[0].when[0].kind, ConditionKind::kDropped);
}

TEST_F(TaskFile, LevelAndSeedChooseTheParameters) {
  const auto easy = Read(kTask, {"easy", 5, {}}), same = Read(kTask, {"easy", 5, {}}),
             other = Read(kTask, {"easy", 6, {}});
  ASSERT_TRUE(easy.ok() && same.ok() && other.ok());
  EXPECT_NEAR(easy->objects[0].body.shapes[0].size.x, 0.006, 1e-12);
  const math::Vec3 p = easy->objects[0].body.X_world_body.translation;
  EXPECT_EQ(p, same->objects[0].body.X_world_body.translation);
  EXPECT_NE(p, other->objects[0].body.X_world_body.translation);
  EXPECT_NEAR(p.x, 0.003, 0.002);
  EXPECT_EQ(p.y, -p.x) << "-{x}";
  EXPECT_EQ(easy->seed, 5u);
}

TEST_F(TaskFile, WhatVariesIsDrawnBesideWhatIsStandardised) {
  std::string text = kTask;
  const auto replace = [&](const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  };
  // a new parameter stands before the old one in the alphabet
  replace(
      R"("x": {"value": 3, "spread": 2})",
      R"("a": {"value": 0, "vary": 4}, "b": {"value": 1, "vary": 0}, "c": {"value": 2, "vary": 0}, "x": {"value": 3, "spread": 2})");
  replace(R"("at_mm": ["{x}", "-{x}", -136])",
          R"("at_mm": ["{a} + {x}", "2*{b}-{c} - {x}", " - 0.5*{c} - 135 "])");
  replace(R"("scene": {)", R"("shuffle": [[["b"], ["c"]]], "scene": {)");
  const auto place = [&](std::uint64_t seed, bool is_varied) {
    const auto scene = Read(text, {.level = "easy", .seed = seed, .is_varied = is_varied});
    EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().Text());
    return scene.ok() ? scene->objects[0].body.X_world_body.translation : math::Vec3{};
  };
  bool is_shuffled = false, is_kept = false;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto before = Read(kTask, {.level = "easy", .seed = seed});
    ASSERT_TRUE(before.ok());
    const math::Vec3 old = before->objects[0].body.X_world_body.translation, standard = place(seed, false),
                     varied = place(seed, true);
    // to the bit: neither "a" nor sums with 0 change what was
    EXPECT_EQ(standard.x, old.x);
    EXPECT_EQ(standard.z, 0.001 * -136);
    EXPECT_NEAR(varied.x, standard.x, 0.004);
    EXPECT_NE(varied.x, standard.x);
    EXPECT_EQ(varied, place(seed, true));
    const bool has_changed = std::abs(varied.z - 0.001 * -135.5) < 1e-12;  // c is 1 then, and b is 2
    EXPECT_NEAR(varied.y, standard.y + (has_changed ? 0.003 : 0.0), 1e-12);
    (has_changed ? is_shuffled : is_kept) = true;
  }
  EXPECT_TRUE(is_shuffled && is_kept);
}

TEST_F(TaskFile, IsReadAsASceneToo) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "task.json", kTask).ok());
  const auto scene = ReadScene(folder_.Path() / "task.json");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_TRUE(scene->task.has_value());
}

struct Bad {
  const char *what, *by;
  base::ErrorCode code;
  std::vector<const char*> says;  ///< the JSON path and the remedy
};

TEST_F(TaskFile, BadOnesAreRefusedWithPathAndRemedy) {
  using base::ErrorCode;
  const Bad kBad[] = {
      {R"("levels")", R"("shuffle": [[["x"], ["nobody"]]], "levels")", ErrorCode::kSceneInvalid, {"nobody"}},
      {R"("levels")",
       R"("shuffle": [[["x"], ["x", "size"]]], "levels")",
       ErrorCode::kSceneInvalid,
       {"equally many"}},
      {R"("spread": 2)", R"("spread": 2, "vary": -1)", ErrorCode::kJsonField, {"parameters.x", "vary"}},
      {R"("tool": "maryland", "port_mm": [-70)",
       R"("tool": "tongs", "port_mm": [-70)",
       ErrorCode::kUnknownName,
       {"scene.instruments.left", "tongs", "known are grasper"}},
      {R"("object": "cube"})",
       R"("object": "cub"})",
       ErrorCode::kUnknownName,
       {"rules.errors[0].when", "cub", "known are cube, board"}},
      {R"("kind": "lifted")",
       R"("kind": "thrown")",
       ErrorCode::kUnknownName,
       {"rules.goals[0].steps[0]", "thrown", "known are held, lifted"}},
      {R"("goals": [{"name": "Lift the {each}", "for_each": ["cube"], "steps": [{"kind": "lifted", "object": "{each}", "hand": "left", "height_mm": 10}]}])",
       R"("goals": [])",
       ErrorCode::kSceneInvalid,
       {"rules", "at least one goal"}},
      {R"("steps": [{"kind": "lifted", "object": "{each}", "hand": "left", "height_mm": 10}])",
       R"("steps": [])",
       ErrorCode::kSceneInvalid,
       {"rules.goals[0]", "at least one step"}},
      {R"("hand": "left")", R"("hand": "third")", ErrorCode::kUnknownName, {"left, right or any"}},
      {R"({"kind": "lifted", "object": "{each}", "hand": "left", "height_mm": 10})",
       R"({"kind": "placed", "object": "{each}", "region": "down"})",
       ErrorCode::kUnknownName,
       {"no region \"down\"", "known are up"}},
      {R"("radius_mm": 20})",
       R"("radius_mm": 20, "half_mm": [1, 1, 1]})",
       ErrorCode::kSceneInvalid,
       {"regions[0]", "either radius_mm"}},
      {R"("colour": "red")",
       R"("colour": "mauve")",
       ErrorCode::kUnknownName,
       {"scene.objects[0]", "mauve", "known are red"}},
      {R"("kind": "box", "size_mm": ["{size}", 8, 8])",
       R"("kind": "cone", "size_mm": [8, 8, 8])",
       ErrorCode::kUnknownName,
       {"scene.objects[0].shapes[0]", "cone", "known are box"}},
      {R"("{size}", 8, 8])",
       R"("{length}", 8, 8])",
       ErrorCode::kJsonField,
       {"scene.objects[0].shapes[0].size_mm"}},
      {R"("name": "board", "at_mm")",
       R"("name": "cube", "at_mm")",
       ErrorCode::kSceneInvalid,
       {"scene.objects[1]", "names must differ"}},
      {R"("time_limit_s": 60, )", "", ErrorCode::kSceneInvalid, {"rules", "needs a time_limit_s"}},
      {R"("easy": 12, )", "", ErrorCode::kJsonField, {"parameters.size.by_level.easy"}},
      {R"("points_per_second_left")",
       R"("points_per_second_lost")",
       ErrorCode::kJsonField,
       {"rules.points_per_second_lost", "known are"}},
      {R"({"at_mm": [-30, 10, -95]})",
       R"({"at": "fundus"})",
       ErrorCode::kUnknownName,
       {"scene.instruments.left.tip", "at_mm"}},
      {R"("objects": [)", R"("patient": "nobody", "objects": [)", ErrorCode::kFileMissing, {"nobody"}},
  };
  for (const Bad& bad : kBad) {
    const auto scene = ReadWith(bad.what, bad.by);
    ASSERT_FALSE(scene.ok()) << bad.by;
    EXPECT_EQ(scene.error().code, bad.code) << scene.error().Text();
    for (const char* text : bad.says)
      EXPECT_NE(scene.error().Text().find(text), std::string::npos) << scene.error().Text();
  }
}

TEST_F(TaskFile, TooManyObjectsAreRefused) {
  std::string many;
  for (int i = 0; i < 63; ++i)
    many +=
        R"({"name": "more_)" + std::to_string(i) + R"(", "shapes": [{"kind": "sphere", "radius_mm": 2}]}, )";
  const auto scene = ReadWith(R"({"name": "board")", many + R"({"name": "board")");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, base::ErrorCode::kSceneInvalid);
  EXPECT_NE(scene.error().Text().find("at most 64"), std::string::npos) << scene.error().Text();
}

TEST_F(TaskFile, UnknownLevelAndPatientWhereThereIsNone) {
  const auto level = Read(kTask, {"fiendish", 1, {}});
  ASSERT_FALSE(level.ok());
  EXPECT_NE(level.error().Text().find("known are easy, normal"), std::string::npos);
  EXPECT_FALSE(Read(kTask, {"normal", 1, "somewhere"}).ok());
}

TEST_F(TaskFile, TruncatedTextIsRefused) {
  const std::string whole = kTask;
  for (std::size_t length = 0; length < whole.size(); length += 37) {
    EXPECT_FALSE(Read(whole.substr(0, length)).ok()) << length;
  }
}

TEST(Tasks, AllDeliveredOnesAreReadAtEveryLevel) {
  const auto tasks = ListTasks();
  ASSERT_TRUE(tasks.ok()) << tasks.error().Text();
  EXPECT_GE(tasks->size(), 7u);
  for (const TaskEntry& task : *tasks) {
    for (const std::string& level : task.levels) {
      const auto scene = ReadTask(task.path, {level, 3, {}});
      EXPECT_TRUE(scene.ok()) << scene.error().Text();
    }
  }
  EXPECT_EQ(FindTask("pig_transfer").error().code, base::ErrorCode::kUnknownName);
  EXPECT_TRUE(FindTask("peg_transfer").ok());
}

/// The good task with an ideal path of that text for the left hand.
std::string WithPath(const std::string& stops) {
  std::string text = kTask;
  return text.replace(text.rfind('}'), 1, R"(, "ideal_path": {"left": [)" + stops + "]}}");
}

// Stops are what the file names, at the start, with straight lines between; the first line begins at the tip.
TEST_F(TaskFile, KnowsAnIdealPath) {
  const auto none = Read(kTask);
  ASSERT_TRUE(none.ok() && none->task);
  EXPECT_EQ(CalcIdealPathLength(*none->task, 0), 0.0);
  const auto scene = Read(WithPath(R"({"object": "{each}", "offset_mm": [0, 0, 4]})"));
  EXPECT_EQ(scene.error().code, base::ErrorCode::kUnknownName)
      << "{each} stands for nothing outside of a group";
  const auto good = Read(WithPath(
      R"({"for_each": ["cube"], "stops": [{"object": "{each}", "offset_mm": [0, 0, 4]}, {"region": "up"}]},
         {"at_mm": [0, 0, -90]})"));
  ASSERT_TRUE(good.ok()) << good.error().Text();
  const auto& path = good->task->ideal_path[kLeft];
  ASSERT_EQ(path.size(), 4u);
  const math::Vec3 cube = good->objects[0].body.X_world_body.translation;
  EXPECT_LT(math::Distance(path[0], {-0.03, 0.01, -0.095}), 1e-12) << "where the tip starts";
  EXPECT_LT(math::Distance(path[1], cube + math::Vec3{0, 0, 0.004}), 1e-12);
  EXPECT_NEAR(CalcIdealPathLength(*good->task, 0),
              math::Distance(path[0], path[1]) + math::Distance(path[1], {0, 0, -0.1}) + 0.01, 1e-12);
  EXPECT_EQ(CalcIdealPathLength(*good->task, 1), 0.0) << "the right hand has none";
  for (const char* bad :
       {R"({"region": "down"})", R"({"band": "red"})", R"({"circle": "sheet"})", R"({"object": "cup"})"})
    EXPECT_EQ(Read(WithPath(bad)).error().code, base::ErrorCode::kUnknownName) << bad;
  for (const char* bad :
       {R"({"object": "cube", "grip": 1})", R"({"region": "up", "at_mm": [0, 0, 0]})", "{}", ""})
    EXPECT_EQ(Read(WithPath(bad)).error().code, base::ErrorCode::kSceneInvalid) << bad;
}

// Every delivered task in which a tip has a way to go states it; the two of the laparoscope do not.
TEST(DeliveredTasks, StateTheirIdealPaths) {
  const auto tasks = ListTasks();
  ASSERT_TRUE(tasks.ok());
  for (const TaskEntry& entry : *tasks) {
    const auto scene = ReadTask(entry.path, {"normal", 1, {}});
    ASSERT_TRUE(scene.ok());
    const bool is_of_camera = entry.key.starts_with("camera_navigation");
    EXPECT_EQ(CalcIdealPathLength(*scene->task, 1) > 0.05, !is_of_camera) << entry.key;
  }
  const auto length = [](const char* task, std::size_t hand) {
    return CalcIdealPathLength(*ReadTask(*FindTask(task), {"normal", 1, {}})->task, hand);
  };
  // six rings up and across, six back: each 16 mm up and 16 mm down, with the ways between
  EXPECT_GT(length("peg_transfer", 0), 12 * (0.016 + 0.03));
  EXPECT_LT(length("peg_transfer", 0), 12 * 0.14);
  // round the circle: its radius lies in 19 to 21 mm, and the tip starts within 60 mm of it
  EXPECT_GT(length("pattern_cut", 1), 2 * M_PI * 0.019);
  EXPECT_LT(length("pattern_cut", 1), 2 * M_PI * 0.021 + 0.06);
  EXPECT_EQ(length("pattern_cut", 0), 0.0);
}

TEST(FindView, ShowsThePointInTheMiddleAtItsDistance) {
  LaparoscopeSetup setup;
  setup.p_world_port = {0, -0.11, -0.005};
  for (const double angle : {0.0, M_PI / 6}) {
    setup.view_angle = angle;
    const math::Vec3 p{0.03, 0.04, -0.13}, facing = math::Normalized(math::Vec3{-0.5, -0.4, 0.77});
    const auto joints = FindView(setup, {p, 0.06, facing});
    ASSERT_TRUE(joints.has_value());
    const math::Vec3 seen = math::Inverse(CalcLaparoscopePose(setup, *joints)) * p;
    EXPECT_NEAR(seen.x, 0, 2e-4);
    EXPECT_NEAR(seen.y, 0, 2e-4);
    EXPECT_NEAR(seen.z, -0.06, 2e-4);
  }
  EXPECT_FALSE(FindView(setup, {{0, -0.11, -0.015}, 0.06, {}}).has_value())
      << "too near to the wall for that distance";
}

}  // namespace
}  // namespace trocar::files
