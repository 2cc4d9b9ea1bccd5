// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recorded_scene.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/files/scene_file.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/trace_file.h"

namespace trocar::record {
namespace {

using surgery::FactKind;

class TraceTest : public RecordedScene {
 protected:
  /// Snapshots of the small scene, changed by a test.
  void SetUp() override {
    RecordedScene::SetUp();
    simulation_.emplace(Make());
    snapshot_ = simulation_->GetSnapshot();
    builder_.emplace(*simulation_);
  }
  void Emit(FactKind kind, int hand, std::int32_t error = -1) {
    auto& event = snapshot_.events[snapshot_.event_count++ % snapshot_.events.size()];
    event = {};
    event.kind = kind;
    event.tick = snapshot_.tick;
    event.hand = hand;
    event.organ = -1;
    event.error = error;
    event.p_rest = {1, 2, 3};
  }
  void Add() {
    builder_->Add(snapshot_, controls_);
    ++snapshot_.tick;
  }
  Recording ReadIt() {
    auto recording = ReadRecording(File());
    EXPECT_TRUE(recording.ok());
    return std::move(*recording);
  }

  std::optional<simulation::Simulation> simulation_;
  simulation::Snapshot snapshot_;
  std::optional<TraceBuilder> builder_;
  std::array<scene::HandControls, instrument::kHandCount> controls_{};
};

TEST_F(TraceTest, TakesOverPoseForceAndState) {
  auto& right = snapshot_.instruments[instrument::kRight];
  right.X_world_tool = {{}, {0.01, 0.02, -0.1}};
  right.X_world_device = {{}, {0.01, 0.02, -0.103}};
  right.force = {0, 3, 4};
  right.joints.depth = 0.12;
  right.joints.spin = 0.3;
  right.is_grasping = right.is_touching = true;
  right.organ = 1;
  snapshot_.X_world_laparoscope = {{}, {0, 0, 0.05}};
  Add();
  const training::AttemptTrace trace = builder_->Calc();
  ASSERT_EQ(trace.Ticks(), 1u);
  const training::ToolSample& sample = trace.hands[instrument::kRight][0];
  EXPECT_EQ(sample.tip, (math::Vec3{0.01, 0.02, -0.1}));
  EXPECT_EQ(sample.axis, (math::Vec3{0, 0, -1}));
  EXPECT_DOUBLE_EQ(sample.force, 5.0);
  EXPECT_NEAR(sample.press, 0.003, 1e-15);
  EXPECT_DOUBLE_EQ(sample.insertion, 0.12);
  EXPECT_DOUBLE_EQ(sample.spin, 0.3);
  EXPECT_TRUE(sample.grasping);
  EXPECT_TRUE(sample.in_contact);
  EXPECT_TRUE(sample.in_view);
  EXPECT_EQ(trace.organ_names[static_cast<std::size_t>(sample.organ)], "gallbladder");
  EXPECT_EQ(trace.tool_names[static_cast<std::size_t>(sample.tool)], "grasper");
  EXPECT_EQ(trace.camera[0].lens, (math::Vec3{0, 0, 0.05}));
  EXPECT_EQ(trace.camera[0].direction, (math::Vec3{0, 0, -1}));
  EXPECT_EQ(trace.camera[0].roll, 0.0);
  EXPECT_EQ(trace.hands[instrument::kLeft][0].press, 0.0) << "it touches nothing";
}

TEST_F(TraceTest, RollIsHowFarThePictureLeans) {
  snapshot_.X_world_laparoscope = {math::RotationAbout({0, 0, 1}, 0.2), {}};
  Add();
  snapshot_.X_world_laparoscope = {math::RotationAbout({1, 0, 0}, 1.1), {}};  // looks up and ahead
  Add();
  const training::AttemptTrace trace = builder_->Calc();
  EXPECT_NEAR(std::fabs(trace.camera[0].roll), 0.2, 1e-12);
  EXPECT_NEAR(trace.camera[1].roll, 0.0, 1e-12);
}

TEST_F(TraceTest, KeepsEveryEventOnce) {
  Emit(FactKind::kGrasp, instrument::kLeft);  // before the attempt
  Add();
  Add();
  Emit(FactKind::kSlip, instrument::kLeft);
  Emit(FactKind::kGraspMissed, instrument::kRight);
  Add();
  for (int i = 0; i < 20; ++i) {
    Emit(FactKind::kGrasp, instrument::kRight);
    Add();
  }
  const training::AttemptTrace trace = builder_->Calc();
  ASSERT_EQ(trace.events.size(), 22u);
  EXPECT_EQ(trace.events[0].kind, "slip");
  EXPECT_NEAR(trace.events[0].time, 2 * trace.dt, 1e-15);
  EXPECT_EQ(trace.events[0].position, trace.hands[instrument::kLeft][2].tip);
  EXPECT_FALSE(trace.events[0].is_error);
  EXPECT_EQ(trace.events[21].kind, "grasp");
}

TEST_F(TraceTest, WhatGoesOnIsOneSpanAndAPauseParts) {
  const auto add = [&](FactKind kind, double amount) {
    surgery::Fact& fact = snapshot_.facts.at(snapshot_.fact_count++);
    fact = {};
    fact.kind = kind;
    fact.hand = instrument::kRight;
    fact.surface = 1;
    fact.amount = amount;
  };
  add(FactKind::kRinse, 1.0);  // before the attempt
  Add();
  for (int i = 0; i < 5; ++i) {
    snapshot_.fact_count = 0;
    add(FactKind::kRinse, 1.0);
    add(FactKind::kPinchDamage, i == 2 ? 9.0 : 4.0);
    Add();
  }
  snapshot_.fact_count = 0;
  for (int i = 0; i < 20; ++i) Add();
  add(FactKind::kRinse, 1.0);
  Add();
  const training::AttemptTrace trace = builder_->Calc();
  ASSERT_EQ(trace.facts.size(), 3u);
  EXPECT_EQ(trace.facts[0].kind, "rinse");
  EXPECT_EQ(trace.facts[0].part, "gallbladder");
  EXPECT_EQ(trace.facts[0].hand, instrument::kRight);
  EXPECT_NEAR(trace.facts[0].start, trace.dt, 1e-12);
  EXPECT_NEAR(trace.facts[0].end, 5 * trace.dt, 1e-12);
  EXPECT_EQ(trace.facts[0].amount, 5.0) << "a volume is summed up";
  EXPECT_EQ(trace.facts[1].kind, "pinch_damage");
  EXPECT_EQ(trace.facts[1].amount, 9.0) << "of a force the largest";
  EXPECT_EQ(trace.facts[2].kind, "rinse");
  EXPECT_EQ(trace.facts[2].start, trace.facts[2].end);
}

TEST_F(TraceTest, AnErrorOfTheOperationSaysWhichAndWhere) {
  auto found = files::FindOperation("cholecystectomy", {}, 1);
  ASSERT_TRUE(found.ok() && *found);
  auto made = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(**found)));
  ASSERT_TRUE(made.ok());
  simulation_ = std::move(*made);
  snapshot_ = simulation_->GetSnapshot();
  builder_.emplace(*simulation_);
  Add();
  Emit(FactKind::kVerdict, instrument::kRight,
       static_cast<int>(cholecystectomy::OperationError::kWrongStructureCut));
  Add();
  const training::AttemptTrace trace = builder_->Calc();
  ASSERT_EQ(trace.events.size(), 1u);
  EXPECT_EQ(trace.events[0].kind, "wrong_structure_cut");
  EXPECT_TRUE(trace.events[0].is_error);
  EXPECT_FALSE(trace.events[0].is_rule);
  EXPECT_EQ(trace.events[0].severity, surgery::Severity::kCritical);
  EXPECT_EQ(trace.events[0].position, (math::Vec3{1, 2, 3}));
  EXPECT_FALSE(trace.events[0].text.empty());
}

TEST_F(TraceTest, HoldsTheLastSampleOfMissedTicks) {
  Add();
  Add();
  snapshot_.tick += 3;
  snapshot_.instruments[0].joints.depth = 0.5;
  Add();
  snapshot_.tick = 1;
  Add();  // is there already
  EXPECT_EQ(builder_->MissedTicks(), 3u);
  const training::AttemptTrace trace = builder_->Calc();
  ASSERT_EQ(trace.Ticks(), 6u);
  EXPECT_EQ(trace.camera.size(), 6u);
  EXPECT_NE(trace.hands[0][4].insertion, 0.5);
  EXPECT_EQ(trace.hands[0][5].insertion, 0.5);
}

TEST_F(TraceTest, AnAttemptWithoutTicksIsEmpty) {
  EXPECT_EQ(builder_->Calc().Ticks(), 0u);
}

// The trace of a recording is that of the running simulation, to the bit, and so are its metrics.
TEST_F(TraceTest, IsTheSameLiveAndReplayedWithAnyNumberOfThreads) {
  constexpr std::uint64_t kTicks = 300;
  Record(kTicks);
  auto simulation = Make();
  TraceBuilder live(simulation);
  live.Add(simulation.GetSnapshot());
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    const scene::Input input = InputOf(tick);
    simulation.Step(input);
    live.Add(simulation.GetSnapshot(), input.controls);
  }
  const std::string expected = training::FormatTraceJson(live.Calc());
  const auto metrics = training::CalcAttemptMetrics(live.Calc());
  ASSERT_TRUE(metrics.ok()) << metrics.error().Text();
  for (const int threads : {1, 2, 4}) {
    double done = 0;
    const auto replayed = TraceRecording(ReadIt(), threads, [&](double share) {
      EXPECT_GE(share, done);
      done = share;
    });
    ASSERT_TRUE(replayed.ok()) << replayed.error().Text();
    EXPECT_EQ(replayed->Ticks(), kTicks + 1);
    EXPECT_EQ(training::FormatTraceJson(*replayed), expected);
    EXPECT_EQ(training::CalcAttemptMetrics(*replayed)->values, metrics->values);
    EXPECT_GT(done, 0.5);
  }
  const double* path = metrics->Find("path_length", "left");
  ASSERT_NE(path, nullptr);
  EXPECT_GT(*path, 0.01) << "the hands wander";
}

TEST_F(TraceTest, RefusesARecordingThatReplaysToSomethingElse) {
  Record(300);
  Recording recording = ReadIt();
  for (std::size_t tick = 200; tick < 215; ++tick) recording.inputs[tick].hands[1].spin += 0.3;
  const auto trace = TraceRecording(std::move(recording), 1);
  ASSERT_FALSE(trace.ok());
  EXPECT_EQ(trace.error().code, base::ErrorCode::kRecordingInvalid);
  EXPECT_THAT(trace.error().message, testing::HasSubstr("differs"));
}

}  // namespace
}  // namespace trocar::record
