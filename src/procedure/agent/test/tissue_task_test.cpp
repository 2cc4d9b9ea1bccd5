// SPDX-License-Identifier: Apache-2.0
// Tasks on tissue that the scene makes for itself: its file, the words that judge it, and those who do it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "task_monitor.h"
#include "task_play.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::agent {

using instrument::kRight;
using math::Vec3;
using scene::CalcScriptInput;
using scene::Condition;
using scene::ConditionKind;
using scene::Event;
using scene::Input;
using scene::ModelBand;
using scene::RegionMark;
using scene::Scene;
using scene::Task;
using scene::TaskPhase;
using simulation::OperationSnapshot;
using simulation::Simulation;
using simulation::TaskMonitor;
using surgery::ClipSnapshot;
using surgery::FactKind;
using surgery::PatternCut;

namespace {

namespace fs = std::filesystem;

// --- the file

/// The delivered task with one piece of its text replaced.
base::Result<Scene> ReadWith(const std::string& key, const std::string& what, const std::string& by) {
  const auto path = files::FindTask(key);
  auto text = host::ReadFile(*path);
  const std::size_t at = text->find(what);
  EXPECT_NE(at, std::string::npos) << what;
  text->replace(at, what.size(), by);
  const test::TemporaryFolder base;
  const fs::path folder = base.Path() / "scenes/tasks";
  fs::create_directories(folder);
  fs::create_directories(folder / "../../assets");
  fs::copy(path->parent_path() / "../../assets/materials", folder / "../../assets/materials");
  EXPECT_TRUE(host::WriteFile(folder / "task.json", *text).ok());
  return files::ReadTask(folder / "task.json");
}

TEST(TissueModelFile, MakesDuctsAndBandsAndAnOperation) {
  const auto scene = ReadWith("clip_and_cut", R"("sag_mm": 1.5)", R"("sag_mm": 2)");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_FALSE(scene->HasPatient()) << "a model is nobody's tissue";
  ASSERT_EQ(scene->patient.tubes.size(), 1u);
  const geometry::CentreLine& line = scene->patient.tubes[0].line;
  EXPECT_NEAR(line.points.front().x, -0.042, 1e-12);
  EXPECT_NEAR(line.points.back().x, 0.042, 1e-12);
  double lowest = 0;
  for (const Vec3& p : line.points) lowest = std::min(lowest, p.z);
  EXPECT_NEAR(lowest, -0.122, 1e-5);
  ASSERT_TRUE(scene->operation.has_value());
  EXPECT_EQ(scene->operation->fat_spacing, 0.0);
}

struct Bad {
  const char *key, *what, *by;
  base::ErrorCode code;
  std::vector<const char*> says;
};

using base::ErrorCode;

const Bad kBad[] = {
    {"clip_and_cut",
     R"("kind": "duct")",
     R"("kind": "hose")",
     ErrorCode::kUnknownName,
     {"scene.model.tubes[0]", "artery"}},
    {"clip_and_cut",
     R"("to_mm": ["{place_x} + 42")",
     R"("to_mm": ["{place_x} - 42")",
     ErrorCode::kSceneInvalid,
     {"model.tubes[0]", "5 mm apart"}},
    {"clip_and_cut",
     R"("model": {)",
     R"("patient": "x", "model": {)",
     ErrorCode::kSceneInvalid,
     {"scene", "leave them out"}},
    {"clip_and_cut",
     R"("model": {
      "tubes": [)",
     R"("model": {
      "bands": [], "pipes": [)",
     ErrorCode::kJsonField,
     {"pipes"}},
    {"clip_and_cut",
     R"("materials": [{"organ": "duct")",
     R"("materials": [{"organ": "liver")",
     ErrorCode::kNone,
     {}},
    {"clip_and_cut",
     R"("error": "clip_crossed")",
     R"("error": "clip_twisted")",
     ErrorCode::kUnknownName,
     {"rules.errors[1].when", "clip_twisted", "known are wrong_structure_clipped"}},
    {"clip_and_cut",
     R"("event": "clip_closed")",
     R"("event": "slip")",
     ErrorCode::kSceneInvalid,
     {"rules.errors[0].when", "have a place"}},
    {"clip_and_cut",
     R"("event": "tube_cut")",
     R"("event": "operation_error")",
     ErrorCode::kUnknownName,
     {"tube_cut"}},
    {"hook_dissection",
     R"("colour": "yellow")",
     R"("colour": "pink")",
     ErrorCode::kUnknownName,
     {"scene.model.bands[0]", "pink"}},
    {"hook_dissection",
     R"("name": "red_1")",
     R"("name": "yellow_1")",
     ErrorCode::kSceneInvalid,
     {"model.bands", "already"}},
    {"hook_dissection",
     R"("band": "yellow_1")",
     R"("band": "green")",
     ErrorCode::kUnknownName,
     {"rules.goals[0].steps[0]", "known are yellow_1"}},
    {"pattern_cut",
     R"("half_mm": [33, 33])",
     R"("half_mm": [33, 3])",
     ErrorCode::kJsonField,
     {"scene.model.sheets[0].half_mm[1]", "between 10.0 and 60.0"}},
    {"pattern_cut",
     R"("prestrain": 0.04)",
     R"("prestrain": 0.5)",
     ErrorCode::kJsonField,
     {"scene.model.sheets[0].prestrain", "0.2"}},
    {"pattern_cut",
     R"("circle_mm": "{radius}")",
     R"("circle_mm": 30)",
     ErrorCode::kSceneInvalid,
     {"scene.model.sheets[0]", "clear of the border"}},
    {"pattern_cut",
     R"("sheets": [)",
     R"("tubes": [{"name": "d", "from_mm": [0, 0, 0], "to_mm": [9, 0, 0], "radius_mm": 1}], "sheets": [)",
     ErrorCode::kSceneInvalid,
     {"scene.model", "either tubes or sheets"}},
    {"pattern_cut",
     R"("kind": "cut_free", "sheet": "sheet")",
     R"("kind": "cut_free", "sheet": "cloth")",
     ErrorCode::kUnknownName,
     {"rules.goals[0].steps[0]", "known are sheet"}},
    {"lift_and_grasp",
     R"("kind": "lifted")",
     R"("band": "x", "kind": "parted")",
     ErrorCode::kSceneInvalid,
     {"rules.goals[0].steps[0]", "give the scene a model"}},
};

TEST(TissueModelFile, BadOnesAreRefusedWithPathAndRemedy) {
  for (const Bad& bad : kBad) {
    auto scene = ReadWith(bad.key, bad.what, bad.by);
    if (bad.code == ErrorCode::kNone) {
      // the file is well, but the tissue cannot be made
      ASSERT_TRUE(scene.ok()) << scene.error().Text();
      const auto made = Simulation::Make(std::make_shared<Scene>(std::move(*scene)));
      ASSERT_FALSE(made.ok());
      EXPECT_NE(made.error().Text().find("no material for \"duct\""), std::string::npos)
          << made.error().Text();
      continue;
    }
    ASSERT_FALSE(scene.ok()) << bad.by;
    EXPECT_EQ(scene.error().code, bad.code) << scene.error().Text();
    for (const char* part : bad.says)
      EXPECT_NE(scene.error().Text().find(part), std::string::npos) << scene.error().Text();
  }
}

// --- the words

class TissueWords : public testing::Test {
 protected:
  TissueWords() {
    scene_.tick_seconds = 1.0 / 120;
    scene_.operation.emplace();
    scene_.model.emplace();
    scene_.model->bands.resize(2);
    Task task;
    task.regions = {{"mark", {0, 0, -0.1}, 0.002, {}, {}, RegionMark::kNone}};
    task.goals.resize(1);
    task.errors.resize(1);
    scene_.task = task;
    snapshot_.operation.clips.resize(4);
    snapshot_.operation.band_is_whole = {1, 1};
  }
  void Start(const Condition& condition) {
    scene_.task->goals[0].steps = {condition};
    scene_.task->errors[0].when = {condition};
    monitor_.Reset(scene_, snapshot_.task);
    snapshot_.instruments[0].X_world_device.translation = {1, 0, 0};
  }
  void Tick() {
    ++snapshot_.tick;
    monitor_.Update(scene_, snapshot_, snapshot_.task);
  }
  void Happens(FactKind kind, const Vec3& p_rest, int error = -1) {
    Event event{kind, snapshot_.tick, kRight, -1, 0};
    event.p_rest = p_rest;
    event.error = error;
    snapshot_.events[snapshot_.event_count++ % snapshot_.events.size()] = event;
  }
  bool IsDone() const { return snapshot_.task.goals[0].is_done; }

  Scene scene_;
  simulation::Snapshot snapshot_;
  TaskMonitor monitor_;
};

Condition Of(ConditionKind kind, std::vector<int> regions = {}) {
  Condition condition;
  condition.kind = kind;
  condition.regions = std::move(regions);
  return condition;
}

TEST_F(TissueWords, ClippedMeansTheWholeDuctUncrossedAndInItsPlace) {
  Start(Of(ConditionKind::kClipped, {0}));
  snapshot_.operation.clip_count = 1;
  ClipSnapshot& clip = snapshot_.operation.clips[0];
  clip.closure = 1.0;
  clip.p_rest = {0.003, 0, -0.1};
  Tick();
  EXPECT_FALSE(IsDone()) << "beside the mark";
  clip.p_rest = {0.001, 0, -0.1};
  clip.closure = 0.6;
  Tick();
  EXPECT_FALSE(IsDone()) << "around a part";
  clip.closure = 1.0;
  clip.is_crossed = true;
  Tick();
  EXPECT_FALSE(IsDone()) << "over another";
  clip.is_crossed = false;
  clip.is_lost = true;
  Tick();
  EXPECT_FALSE(IsDone()) << "lies in the box";
  clip.is_lost = false;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(TissueWords, DividedMeansACutThere) {
  Start(Of(ConditionKind::kDivided, {0}));
  snapshot_.operation.tube_cuts[0] = {0.01, 0, -0.1};
  snapshot_.operation.tube_cut_count = 1;
  Tick();
  EXPECT_FALSE(IsDone());
  snapshot_.operation.tube_cuts[1] = {0.0, 0, -0.1};
  Tick();
  EXPECT_FALSE(IsDone()) << "that one has not been made yet";
  snapshot_.operation.tube_cut_count = 2;
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(TissueWords, AnUnclippedCutIsOneWithTooFewGoodClips) {
  Condition few = Of(ConditionKind::kUnclippedCut);
  few.amount = 3;
  Start(few);
  for (ClipSnapshot& clip : snapshot_.operation.clips) clip.closure = 1.0;
  snapshot_.operation.clip_count = 4;
  snapshot_.operation.clips[3].closure = 0.5;
  Happens(FactKind::kTubeCut, {});
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 0u) << "three hold it";
  snapshot_.operation.clips[2].is_lost = true;
  Happens(FactKind::kTubeCut, {});
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u);
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u) << "a cut is a moment";
}

TEST_F(TissueWords, EventsHaveAPlaceAndSurgerysErrorsAName) {
  Condition astray = Of(ConditionKind::kEvent, {0});
  astray.event = static_cast<int>(FactKind::kClipClosed);
  astray.is_outside = true;
  Start(astray);
  Happens(FactKind::kClipClosed, {0, 0, -0.1});
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 0u);
  Happens(FactKind::kClipClosed, {0.01, 0, -0.1});
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u);

  Condition partial = Of(ConditionKind::kOperationError);
  partial.error = static_cast<int>(cholecystectomy::OperationError::kClipPartial);
  Start(partial);
  Happens(FactKind::kVerdict, {}, static_cast<int>(cholecystectomy::OperationError::kClipCrossed));
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 0u);
  Happens(FactKind::kVerdict, {}, static_cast<int>(cholecystectomy::OperationError::kClipPartial));
  Tick();
  EXPECT_EQ(snapshot_.task.errors[0], 1u);
}

TEST_F(TissueWords, PartedMeansThatBand) {
  Condition parted = Of(ConditionKind::kParted);
  parted.band = 1;
  Start(parted);
  snapshot_.operation.band_is_whole = {0, 1};
  Tick();
  EXPECT_FALSE(IsDone());
  snapshot_.operation.band_is_whole = {0, 0};
  Tick();
  EXPECT_TRUE(IsDone());
}

TEST_F(TissueWords, ASheetIsFreeOffItsLineOrOfTheWrongArea) {
  scene_.model->sheets.resize(1);
  snapshot_.operation.sheets.resize(1);
  PatternCut& sheet = snapshot_.operation.sheets[0];
  const auto is_true = [&](ConditionKind kind, double amount) {
    Condition condition = Of(kind);
    condition.sheet = 0;
    condition.amount = amount;
    Start(condition);
    Tick();
    return IsDone();
  };
  EXPECT_FALSE(is_true(ConditionKind::kCutFree, 0));
  sheet.is_free = true;
  EXPECT_TRUE(is_true(ConditionKind::kCutFree, 0));
  sheet.farthest = 0.0015;
  EXPECT_FALSE(is_true(ConditionKind::kCutOffLine, 0.002));
  sheet.farthest = 0.0021;
  EXPECT_TRUE(is_true(ConditionKind::kCutOffLine, 0.002));
  sheet.off_area = 90e-6;
  EXPECT_FALSE(is_true(ConditionKind::kCutAreaOff, 100e-6));
  sheet.off_area = 110e-6;
  EXPECT_TRUE(is_true(ConditionKind::kCutAreaOff, 100e-6));
}

// --- those who do it

TEST(NoviceOnTissue, DoesTasksOnTissueMoreSlowly) {
  for (const char* key : {"clip_and_cut", "hook_dissection"}) {
    const auto scene = ReadDelivered(key, {"easy", 1, {}});
    const auto expert = PlayTask(scene, "expert", 1), novice = PlayTask(scene, "novice", 1);
    ASSERT_TRUE(expert.ok() && novice.ok());
    EXPECT_EQ(novice->task.phase, TaskPhase::kCompleted) << novice->doing;
    EXPECT_GT(novice->task.time, expert->task.time);
  }
}

class TissueTask : public testing::TestWithParam<const char*> {};

TEST_P(TissueTask, IsDoneByTheExpertAtEveryLevel) {
  std::uint64_t seed = 2;
  for (const char* level : {"easy", "normal", "hard"}) {
    const auto scene = ReadDelivered(GetParam(), {level, seed, {}});
    const auto played = PlayTask(scene, "expert", seed);
    ASSERT_TRUE(played.ok()) << played.error().Text();
    EXPECT_EQ(played->task.phase, TaskPhase::kCompleted) << level << " stopped at " << played->doing;
    EXPECT_EQ(played->task.error_count, 0u) << level;
    ++seed;
  }
}

TEST_P(TissueTask, BeginsAnewAfterAReset) {
  const auto scene = ReadDelivered(GetParam());
  auto made = Simulation::Make(scene);
  ASSERT_TRUE(made.ok());
  const std::uint64_t start = made->Hash();
  const auto play = [&] {
    auto surgeon = MakeSurgeon("expert", scene, 1);
    while (made->GetSnapshot().time < 8) made->Step((*surgeon)->Act(made->GetSnapshot()));
    return made->Hash();
  };
  const std::uint64_t first = play();
  made->Reset();
  EXPECT_EQ(made->Hash(), start);
  EXPECT_EQ(play(), first);
}

INSTANTIATE_TEST_SUITE_P(Delivered, TissueTask,
                         testing::Values("clip_and_cut", "hook_dissection", "pattern_cut"),
                         [](const auto& one) { return std::string(one.param); });

TEST(ClipAndCut, LeavesThreeGoodClipsOnTheirMarksAndTwoStumps) {
  const auto scene = ReadDelivered("clip_and_cut");
  auto simulation = Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  auto surgeon = MakeSurgeon("expert", scene, 1);
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < 200)
    simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
  const OperationSnapshot& now = simulation->GetSnapshot().operation;
  ASSERT_EQ(now.clip_count, 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(now.clips[i].IsGood());
    EXPECT_LT(std::abs(now.clips[i].p_rest.x - scene->task->regions[i].centre.x), 0.0018);
    EXPECT_LT(math::Distance(now.clips[i].p_rest, now.clips[i].X_world_clip.translation), 0.01);
  }
  ASSERT_EQ(now.tube_cut_count, 1u);
  EXPECT_GT(now.tube_cuts[0].x, scene->task->regions[1].centre.x);
  EXPECT_LT(now.tube_cuts[0].x, scene->task->regions[2].centre.x);
}

/// Steps for some seconds, and counts the events of one kind.
int CountEvents(Simulation& simulation, const Input& input, double seconds, FactKind kind) {
  int count = 0;
  for (int tick = 0; tick < static_cast<int>(seconds * 120); ++tick) {
    const std::uint64_t before = simulation.GetSnapshot().event_count;
    simulation.Step(input);
    const simulation::Snapshot& now = simulation.GetSnapshot();
    for (std::uint64_t n = before; n < now.event_count; ++n)
      count += now.events[n % now.events.size()].kind == kind;
  }
  return count;
}

TEST(ImpossibleActs, AnEmptyClipApplierSaysSoEachTimeItIsClosed) {
  const auto scene = ReadDelivered("clip_and_cut");
  auto simulation = Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  Input input = CalcScriptInput(*scene, 0);
  const int clips = scene->instruments[kRight].tool.clips;
  const auto close = [&] {
    int count = 0;
    for (const double jaw : {0.7, 0.0}) {
      input.hands[kRight].jaw = jaw;
      count += CountEvents(*simulation, input, 0.15, FactKind::kNoClipsLeft);
    }
    return count;
  };
  for (int i = 0; i < clips; ++i) EXPECT_EQ(close(), 0) << i;
  EXPECT_EQ(simulation->GetSnapshot().operation.clips_left[kRight], 0);
  EXPECT_EQ(close(), 1);
  EXPECT_EQ(close(), 1);
  EXPECT_EQ(simulation->GetSnapshot().operation.clip_count, static_cast<std::size_t>(clips))
      << "and makes no clip";
}

TEST(ImpossibleActs, ToolsThatAreOutOfTheirTrocarsSaySoOnceATry) {
  const auto scene = ReadDelivered("hook_dissection");
  auto simulation = Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  Input input = CalcScriptInput(*scene, 0);
  input.controls[kRight].coagulate = true;
  EXPECT_EQ(CountEvents(*simulation, input, 0.5, FactKind::kUsedOutside), 0) << "it is in";
  input.controls[kRight].coagulate = false;
  input.hands[kRight].depth = 0;
  EXPECT_EQ(CountEvents(*simulation, input, 0.5, FactKind::kUsedOutside), 0) << "and does nothing";
  input.controls[kRight].coagulate = true;
  EXPECT_EQ(CountEvents(*simulation, input, 0.5, FactKind::kUsedOutside), 1);
  EXPECT_FALSE(simulation->GetSnapshot().operation.has_current[kRight]);
}

TEST(HookDissection, CurrentPartsWhatItTouchesAndNothingElse) {
  const auto scene = ReadDelivered("hook_dissection", {"hard", 1, {}});
  auto simulation = Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  // the hook rests on the first band without current, then with it
  const ModelBand& band = scene->model->bands[0];
  const Vec3 p = math::Lerp(band.from, band.to, 0.5);
  Input input = CalcScriptInput(*scene, 0);
  const Vec3& port = scene->instruments[kRight].p_world_port;
  const double spin = FindSpin(port, p, {1, 0, 0});
  input.hands[kRight] = instrument::FindJoints(port, p, spin, 0);
  for (int tick = 0; tick < 240; ++tick) simulation->Step(input);
  const auto& whole = simulation->GetSnapshot().operation.band_is_whole;
  EXPECT_EQ(std::count(whole.begin(), whole.end(), 0), 0);
  input.controls[kRight].coagulate = true;
  int ticks = 0;
  while (whole[0] != 0 && ticks < 360) simulation->Step(input), ++ticks;
  EXPECT_LT(ticks, 360);
  EXPECT_GT(ticks, 5) << "heat takes its time";
  EXPECT_EQ(std::count(whole.begin(), whole.end(), 0), 1);
}

// --- a task on a patient

// The first steps of the operation, without its tray: whoever misses takes the tissue in another try.
TEST(TaskOnPatient, ExpertTakesLiftsAndTurnsTheGallbladder) {
  const auto data = host::FindDataFolder();
  auto scene = files::ReadTask(*data / "scenes/study/gallbladder_retraction.json");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  ASSERT_TRUE(scene->HasPatient());
  const auto shared = std::make_shared<const Scene>(std::move(*scene));
  const auto played = PlayTask(shared, "expert", 1, 60);
  ASSERT_TRUE(played.ok()) << played.error().Text();
  EXPECT_EQ(played->task.phase, TaskPhase::kCompleted)
      << played->doing << " after " << played->seconds << " s";
  EXPECT_EQ(CountErrors(*shared, played->task, "slipped"), 0u);
  EXPECT_EQ(CountErrors(*shared, played->task, "pinched"), 0u);
}

}  // namespace
}  // namespace trocar::agent
