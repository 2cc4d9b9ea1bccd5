// SPDX-License-Identifier: Apache-2.0
// The JSON schemas against every file that is delivered, and against files made wrong in one way.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/contours/control_points.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;
const fs::path kRoot = TROCAR_SOURCE_DIR;
constexpr int kMissing = 3;

class Schemas : public testing::Test {
 protected:
  void SetUp() override {
    if (CheckSchemas("--check") == kMissing)
      GTEST_SKIP() << "python3-jsonschema is not installed; run tools/install-packages --test";
  }
};

TEST_F(Schemas, AcceptEveryFileInAssetsAndScenes) {
  EXPECT_EQ(CheckSchemas(""), 0);
}

TEST_F(Schemas, AcceptMetricsTheirDefinitionsTracesAndTestVectors) {
  test::TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder.Path() / name).string(); };
  const Printed played = RunTrocar({"simulate", (kRoot / "scenes/demonstration.json").string(), "--ticks",
                                    "60", "--record", path("a.trocar")});
  ASSERT_EQ(played.status, 0) << played.err;
  const Printed measured =
      RunTrocar({"metrics", path("a.trocar"), "--json", "-o", path("m.json"), "--trace", path("t.json")});
  ASSERT_EQ(measured.status, 0) << measured.err;
  EXPECT_EQ(CheckSchemas("'" + path("m.json") + "' '" + path("t.json") + "'"), 0);
  EXPECT_EQ(CheckSchemas("'" + (kRoot / "docs/metrics.json").string() + "'"), 0);
  EXPECT_EQ(CheckSchemas((kRoot / "tests/metrics/vectors").string() + "/*.json"), 0);
}

TEST_F(Schemas, AcceptWhatTheProgramWrites) {
  test::TemporaryFolder folder;
  const fs::path phantom = folder.Path() / "phantom";
  const Printed printed =
      RunTrocar({"anatomy", "phantom", "--seed", "7", "--set", "hydrops=0.5", "--pixel-mm", "4", "--slice-mm",
                 "6", "--every", "2", "-o", phantom.string()});
  ASSERT_EQ(printed.status, 0) << printed.err;
  const auto check = [](const fs::path& file) { return CheckSchemas("'" + file.string() + "'"); };
  EXPECT_EQ(check(phantom / "patient" / "patient.json"), 0);
  EXPECT_EQ(check(phantom / "control_points.json"), 0);
  // as the contour window saves what is unfinished
  auto points = contours::ReadControlPoints(phantom / "control_points.json");
  ASSERT_TRUE(points.ok()) << points.error().Text();
  points->structures[0].slices[0].open = {{3.5, 4.5}, {6.0, 7.0}};
  points->structures.push_back({});
  points->structures.back().name = "spleen";
  points->structures.back().triangle_budget = 1500;
  ASSERT_TRUE(contours::WriteControlPoints(folder.Path() / "draft.json", *points).ok());
  EXPECT_EQ(check(folder.Path() / "draft.json"), 0);
}

TEST_F(Schemas, RefuseWhatIsNoJsonOrOfNoKnownFormat) {
  test::TemporaryFolder folder;
  const fs::path file = folder.Path() / "a.json";
  for (const char* text : {"", "{", "[]", "{}", R"({"format": "trocar-spleen"})", R"({"format": 7})"}) {
    ASSERT_TRUE(host::WriteFile(file, text).ok());
    EXPECT_EQ(CheckSchemas("'" + file.string() + "'"), 1) << text;
  }
  EXPECT_EQ(CheckSchemas("'" + (folder.Path() / "missing.json").string() + "'"), 1);
}

struct Broken {
  const char* name;
  const char* file;
  std::function<void(Json&)> change;
};

void PrintTo(const Broken& broken, std::ostream* out) {
  *out << broken.name;
}

class BrokenFile : public Schemas, public testing::WithParamInterface<Broken> {};

TEST_P(BrokenFile, IsRefused) {
  test::TemporaryFolder folder;
  const fs::path file = folder.Path() / "broken.json";
  Json json = Json::parse(*host::ReadFile(kRoot / GetParam().file));
  ASSERT_TRUE(host::WriteFile(file, json.dump()).ok());
  ASSERT_EQ(CheckSchemas("'" + file.string() + "'"), 0) << "the file is valid before it is broken";
  GetParam().change(json);
  ASSERT_TRUE(host::WriteFile(file, json.dump()).ok());
  EXPECT_EQ(CheckSchemas("'" + file.string() + "'"), 1);
}

constexpr const char* kPatientFile = "assets/patients/visible-human-male/patient/patient.json";
constexpr const char* kPoints = "assets/patients/visible-human-male/control_points.json";
constexpr const char* kScene = "scenes/demonstration.json";
constexpr const char* kMaterial = "assets/materials/liver.json";
constexpr const char* kTask = "scenes/tasks/object_transport.json";
constexpr const char* kCourseFile = "assets/courses/cholecystectomy.json";
constexpr const char* kLevels = "assets/proficiency/peg_transfer-normal.json";
constexpr const char* kScript = "scenes/demonstration.script.json";
constexpr const char* kRules = "assets/coach/rules.json";
constexpr const char* kValidity = "assets/validity.json";

const Broken kBroken[] = {
    {"PatientUnit", kPatientFile, [](Json& j) { j["unit"] = "m"; }},
    {"PatientWithoutTubes", kPatientFile, [](Json& j) { j.erase("tubes"); }},
    {"PatientMeshLeadsOut", kPatientFile, [](Json& j) { j["organs"][0]["mesh"] = "../liver.ply"; }},
    {"PatientVertexNoWholeNumber", kPatientFile,
     [](Json& j) { j["organs"][0]["regions"][0]["vertices"][0] = 1.5; }},
    {"PatientRadiusZero", kPatientFile, [](Json& j) { j["tubes"][0]["radii"][0] = 0; }},
    {"PatientMisspelt", kPatientFile, [](Json& j) { j["landmark"] = Json::array(); }},
    {"PointsVersion", kPoints, [](Json& j) { j["version"] = 2; }},
    {"PointsAxis", kPoints, [](Json& j) { j["images"]["axes"]["row"] = "up"; }},
    {"PointsPatternLeadsOut", kPoints, [](Json& j) { j["images"]["pattern"] = "../{slice}.png"; }},
    {"PointsContourOfTwo", kPoints,
     [](Json& j) {
       j["structures"][0]["slices"][0]["contours"][0] = {{1, 2}, {3, 4}};
     }},
    {"PointsSliceOfNothing", kPoints,
     [](Json& j) { j["structures"][0]["slices"][0]["contours"] = Json::array(); }},
    {"PointsOpenContourOfNumbers", kPoints,
     [](Json& j) {
       j["structures"][0]["slices"][0]["open"] = {1, 2};
     }},
    {"PointsRadiusMissing", kPoints, [](Json& j) { j["tubes"][0]["points"][0].erase(3); }},
    {"SceneWithoutPatient", kScene, [](Json& j) { j.erase("patient"); }},
    {"SceneSolver", kScene, [](Json& j) { j["settings"]["solver"] = "magic"; }},
    {"SceneThirdHand", kScene, [](Json& j) { j["instruments"]["third"] = j["instruments"]["left"]; }},
    {"SceneStiffnessNegative", kScene, [](Json& j) { j["materials"][0]["young_modulus_pa"] = -1; }},
    {"MaterialWithoutASource", kMaterial, [](Json& j) { j["sources"].erase("density_kg_m3"); }},
    {"MaterialStiffnessNegative", kMaterial, [](Json& j) { j["young_modulus_pa"] = -1; }},
    {"MaterialMisspelt", kMaterial, [](Json& j) { j["densty_kg_m3"] = 1; }},
    {"TaskWithoutGoal", kTask, [](Json& j) { j["rules"]["goals"] = Json::array(); }},
    {"TaskUnknownRule", kTask, [](Json& j) { j["rules"]["goals"][0]["steps"][0]["kind"] = "thrown"; }},
    {"TaskUnknownTool", kTask, [](Json& j) { j["scene"]["instruments"]["left"]["tool"] = "tongs"; }},
    {"TaskShapeOfNoSize", kTask, [](Json& j) { j["scene"]["objects"][0]["shapes"][0].erase("kind"); }},
    {"TaskParameterMisspelt", kTask, [](Json& j) { j["rules"]["time_limit_s"] = "{Limit"; }},
    {"TaskLevelScoreOfNothing", kTask, [](Json& j) { j["level_scores"]["easy"] = 0; }},
    {"CourseStepOfNothing", kCourseFile, [](Json& j) { j["steps"][0].erase("operation"); }},
    {"CourseStepOfTwoThings", kCourseFile, [](Json& j) { j["steps"][0]["task"] = "wire_run"; }},
    {"CourseWithoutBriefing", kCourseFile, [](Json& j) { j["steps"][0].erase("briefing"); }},
    {"CourseUnknownMoment", kCourseFile, [](Json& j) { j["steps"][0]["until"] = "lunch"; }},
    {"CourseThresholdBothWays", kCourseFile,
     [](Json& j) { j["steps"][0]["own_thresholds"][0]["at_least"] = 0; }},
    {"CourseNoPass", kCourseFile, [](Json& j) { j["steps"][0]["consecutive_passes"] = 0; }},
    {"CourseMisspelt", kCourseFile, [](Json& j) { j["steps"][0]["due_day"] = 3; }},
    {"LevelsWithoutASource", kLevels, [](Json& j) { j["thresholds"][0].erase("source"); }},
    {"LevelsOfNoPurpose", kLevels, [](Json& j) { j["thresholds"][0]["purpose"] = "haste"; }},
    {"LevelsWithoutThreshold", kLevels, [](Json& j) { j["thresholds"] = Json::array(); }},
    {"RuleOfAnUnknownMeasure", kRules, [](Json& j) { j["rules"][0]["measure"] = "coach:humour"; }},
    {"RuleWithoutASource", kRules, [](Json& j) { j["rules"][0].erase("source"); }},
    {"RuleAbsoluteWithoutASentence", kRules, [](Json& j) { j["rules"][0]["absolute"] = 1; }},
    {"ValidityChanceAboveOne", kValidity, [](Json& j) { j["tasks"][0]["measures"][0]["auc"] = 1.5; }},
    {"ValidityWithoutAVerdict", kValidity, [](Json& j) { j["tasks"][0]["measures"][0].erase("separates"); }},
    {"ScriptFirstKeyWithOneHand", kScript, [](Json& j) { j["keys"][0].erase("right"); }},
    {"ScriptWithoutKeys", kScript, [](Json& j) { j["keys"] = Json::array(); }},
    {"ScriptJawTooWide", kScript, [](Json& j) { j["keys"][1]["left"]["jaw_deg"] = 120; }},
    {"ScriptPointOfTwoNumbers", kScript,
     [](Json& j) {
       j["keys"][1]["left"]["offset_mm"] = {1, 2};
     }},
};

INSTANTIATE_TEST_SUITE_P(Schemas, BrokenFile, testing::ValuesIn(kBroken),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace trocar::cli
