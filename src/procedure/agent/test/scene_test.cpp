// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "small_scene.h"
#include "trocar/agent/surgeon.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/patient/patient.h"

namespace trocar::agent {

using host::FindDataFolder;
using instrument::kLeft;
using math::Vec3;
using scene::CalcScriptInput;
using scene::ClampSettings;
using scene::LiveSettings;
using scene::SmallScene;
namespace {

using base::ErrorCode;
using testing::HasSubstr;

class SceneFile : public SmallScene {
 protected:
  base::Error Failure() {
    auto scene = Read();
    return scene.ok() ? base::Error{} : scene.error();
  }
};

TEST_F(SceneFile, ReadsPatientPortsMaterialsAndScript) {
  const auto scene = Read();
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_EQ(scene->patient.organs.size(), 2u);
  EXPECT_EQ(scene->materials.size(), 4u);
  EXPECT_NEAR(scene->materials[1].wall_thickness, 0.0005, 1e-15);
  EXPECT_NEAR(scene->tick_seconds, 1.0 / 120, 1e-15);
  EXPECT_NEAR(scene->script.Duration(), 1.2, 1e-15);
  const auto& left = scene->instruments[kLeft];
  EXPECT_NEAR(
      math::Distance(instrument::CalcToolPose(left.p_world_port, left.home).translation, {0, 0.056, -0.095}),
      0.0, 1e-12);
}

TEST_F(SceneFile, ScriptMovesTheTipSmoothlyFromKeyToKey) {
  const auto scene = Read();
  ASSERT_TRUE(scene.ok());
  const auto tip = [&](double time) {
    return instrument::CalcToolPose(scene->instruments[kLeft].p_world_port,
                                    CalcScriptInput(*scene, time).hands[kLeft])
        .translation;
  };
  EXPECT_NEAR(math::Distance(tip(0.4), Vec3{-0.002, 0.056, -0.109}), 0.0, 1e-9);
  EXPECT_NEAR(math::Distance(tip(0.2), math::Lerp(tip(0.0), tip(0.4), 0.5)), 0.0, 1e-9);
  EXPECT_LT(math::Distance(tip(0.01), tip(0.0)), 1e-4) << "starts from rest";
  EXPECT_NEAR(math::Distance(tip(99), tip(1.2)), 0.0, 1e-12);
}

TEST_F(SceneFile, TremorIsSmallAndDependsOnTheSeedAlone) {
  auto scene = Read();
  ASSERT_TRUE(scene.ok());
  const auto tip = [&](double tremor, std::uint64_t seed) {
    scene->script.tremor = tremor;
    scene->seed = seed;
    return instrument::CalcToolPose(scene->instruments[kLeft].p_world_port,
                                    CalcScriptInput(*scene, 0.3).hands[kLeft])
        .translation;
  };
  const Vec3 steady = tip(0.0, 1);
  EXPECT_EQ(tip(0.0, 2), steady);
  EXPECT_EQ(tip(1e-4, 7), tip(1e-4, 7));
  EXPECT_NE(tip(1e-4, 7), tip(1e-4, 8));
  EXPECT_GT(math::Distance(tip(1e-4, 7), steady), 0.0);
  EXPECT_LE(math::Distance(tip(1e-4, 7), steady), 1e-4 * std::sqrt(3.0) + 1e-12);
}

TEST_F(SceneFile, NamesWhatIsWrongAndWhere) {
  Write("scene.json", SceneText("spoon"));
  EXPECT_EQ(Failure().code, ErrorCode::kUnknownName);
  EXPECT_THAT(Failure().message, HasSubstr("instruments.left"));
  std::string tray = SceneText();
  tray.insert(tray.find(R"("tool")"), R"("tray": ["hook", "spoon"], )");
  Write("scene.json", tray);
  EXPECT_EQ(Failure().code, ErrorCode::kUnknownName);
  EXPECT_THAT(Failure().message, HasSubstr("there is no tool \"spoon\""));
  Write("scene.json", SceneText("grasper", R"(, "tick_hertz": 60)"));
  EXPECT_THAT(Failure().message, HasSubstr("tick_hertz"));
  Write("scene.json", "{");
  EXPECT_EQ(Failure().code, ErrorCode::kJsonSyntax);
  std::filesystem::remove_all(folder_ / "patient");
  Write("scene.json", SceneText());
  EXPECT_EQ(Failure().code, ErrorCode::kFileMissing);
}

TEST_F(SceneFile, RefusesBadOperations) {
  const auto with_operation = [&](const std::string& fields) {
    Write("scene.json", SceneText("grasper", R"(, "operation": {)" + fields + "}"));
    return Failure();
  };
  EXPECT_EQ(with_operation("").code, ErrorCode::kNone);
  EXPECT_THAT(with_operation(R"("fat_spacing_mm": 1.0)").message, HasSubstr("at least 1.5"));
  EXPECT_EQ(with_operation(R"("fat": 2.0)").code, ErrorCode::kJsonField);
  const std::string hand = R"("assistant": {"port_mm": [-60, 0, 0], "lift_mm": [0, 9, 0], "at": ")";
  EXPECT_EQ(with_operation(hand + "fundus\"}").code, ErrorCode::kNone);
  EXPECT_EQ(with_operation(hand + "spleen\"}").code, ErrorCode::kUnknownName);
  EXPECT_THAT(with_operation(hand + "spleen\"}").message, HasSubstr("operation.assistant"));

  patient::Patient patient = MakePatient();
  patient.tubes.clear();
  ASSERT_TRUE(files::WritePatient(folder_ / "patient", patient).ok());
  EXPECT_THAT(with_operation("").message, HasSubstr("has no ducts"));
}

// the scripted surgeons need more of a patient, and of a tray, than the operation itself
TEST_F(SceneFile, IsNoCholecystectomyWithoutItsDuctsAndTools) {
  Write("scene.json", SceneText("grasper", R"(, "operation": {})"));
  auto scene = Read();
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  for (const SurgeonEntry& entry : ListSurgeons()) EXPECT_FALSE(entry.suits(*scene)) << entry.name;
  EXPECT_FALSE(MakeSurgeon("expert", std::make_shared<const scene::Scene>(std::move(*scene)), 1).ok());
}

TEST_F(SceneFile, RefusesBadScripts) {
  const auto with_keys = [&](const std::string& keys) {
    Write("script.json", R"({"format": "trocar-script", "version": 1, "keys": [)" + keys + "]}");
    return Failure().code;
  };
  const std::string good = R"({"time_s": 0, "left": {"at": "fundus"}, "right": {"at": "fundus"}})";
  EXPECT_EQ(with_keys(good), ErrorCode::kNone);
  EXPECT_EQ(with_keys(""), ErrorCode::kScriptInvalid);
  EXPECT_EQ(with_keys(good + "," + good), ErrorCode::kScriptInvalid) << "time does not rise";
  EXPECT_EQ(with_keys(R"({"time_s": 0, "left": {"at": "fundus"}})"), ErrorCode::kScriptInvalid);
  EXPECT_EQ(with_keys(R"({"time_s": 0, "left": {"at": "spleen"}, "right": {"at": "fundus"}})"),
            ErrorCode::kUnknownName);
  EXPECT_EQ(with_keys(R"({"time_s": NaN, "left": {"at": "fundus"}, "right": {"at": "fundus"}})"),
            ErrorCode::kJsonSyntax);
  EXPECT_EQ(
      with_keys(R"({"time_s": 0, "left": {"at": "fundus", "offset_mm": [1, 2]}, "right": {"at": "fundus"}})"),
      ErrorCode::kJsonField);
}

TEST_F(SceneFile, ReadsTheBoundsOfTheSolver) {
  const auto with = [this](const std::string& bounds) {
    std::string text = SceneText();
    const std::string before = R"("settings": {)";
    text.insert(text.find(before) + before.size(), bounds + ", ");
    Write("scene.json", text);
    return Read();
  };
  const auto scene = with(R"("max_newton_steps": 3, "max_linear_total": 20, "follow_snap_through": false)");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_EQ(scene->settings.solver.newton.max_steps, 3);
  EXPECT_EQ(scene->settings.solver.newton.max_linear_total, 20);
  EXPECT_FALSE(scene->settings.solver.newton.follows_snap_through);
  const auto wrong = with(R"("max_linear_total": 0)");
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.error().Text(), HasSubstr("max_linear_total"));
}

TEST(ClampSettings, BoundsEverySettingAndSwallowsNan) {
  LiveSettings settings;
  settings.stiffness_scale = 1e9;
  settings.gravity = -1;
  settings.head_up = std::nan("");
  settings.solver.max_iterations = -5;
  settings.solver.newton.max_linear_total = 0;
  const LiveSettings clamped = ClampSettings(settings);
  EXPECT_EQ(clamped.stiffness_scale, 20.0);
  EXPECT_EQ(clamped.gravity, 0.0);
  EXPECT_EQ(clamped.head_up, 0.0);
  EXPECT_EQ(clamped.solver.max_iterations, 1);
  EXPECT_EQ(clamped.solver.newton.max_linear_total, 1);
  EXPECT_EQ(ClampSettings({}), LiveSettings{});
}

TEST(FindDataFolder, SaysWhatItTried) {
  ::setenv("TROCAR_DATA_DIR", "/nowhere-at-all", 1);
  const auto folder = FindDataFolder();
  ::unsetenv("TROCAR_DATA_DIR");
  ASSERT_FALSE(folder.ok());
  EXPECT_EQ(folder.error().code, ErrorCode::kFileMissing);
  EXPECT_THAT(folder.error().message, HasSubstr("/nowhere-at-all"));
}

}  // namespace
}  // namespace trocar::agent
