// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/motion_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>

#include "trocar/math/random.h"

namespace trocar::training {
namespace {

constexpr double kPi = std::numbers::pi;

/// Records both tools as functions of time [s].
MotionRecording RecordMotion(
    double seconds, const std::function<ToolSample(double)>& left,
    const std::function<ToolSample(double)>& right = [](double) { return ToolSample{}; }) {
  MotionRecorder recorder({.reserve_seconds = seconds + 1.0});
  const double dt = recorder.Recording().dt;
  for (int tick = 0; tick <= std::lround(seconds / dt); ++tick) {
    const ToolSample samples[] = {left(tick * dt), right(tick * dt)};
    recorder.Record(samples);
  }
  return recorder.Recording();
}

ToolSample TipAt(const Vec3& tip) {
  ToolSample sample;
  sample.tip = tip;
  return sample;
}

/// Part of a minimum-jerk movement done at time t of T [-].
double MinimumJerk(double t, double duration) {
  const double s = std::clamp(t / duration, 0.0, 1.0);
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

MotionMetrics MeasureLeft(const MotionRecording& recording, const MetricSettings& settings = {}) {
  core::Result<SessionMetrics> session = CalcSessionMetrics(recording, settings);
  EXPECT_TRUE(session.ok());
  return session.value().tools[0];
}

TEST(MotionMetrics, MeasuresAStraightLine) {
  const MotionMetrics m = MeasureLeft(RecordMotion(4.0, [](double t) {
    ToolSample sample = TipAt({0.03 * t, 0.04 * t, 0});
    sample.insertion = 0.1 + 0.02 * t;
    return sample;
  }));
  EXPECT_NEAR(m.time, 4.0, 1e-12);
  EXPECT_NEAR(m.path_length, 0.2, 0.0005);
  EXPECT_FALSE(m.economy_of_motion) << "no shortest path was given";
  EXPECT_NEAR(m.depth_path, 0.08, 0.0005);
  EXPECT_NEAR(*m.mean_speed, 0.05, 0.0002);
  EXPECT_NEAR(*m.max_speed, 0.05, 0.0002);
  EXPECT_EQ(m.movements, 1);
  EXPECT_EQ(*m.idle_fraction, 0.0);
  EXPECT_EQ(m.angular_path, 0.0);
}

TEST(MotionMetrics, MeasuresACircle) {
  // two rounds of radius 3 cm in 8 s; the shaft sweeps a cone of 30 degrees, the spin goes half a turn and
  // wraps
  const double radius = 0.03, rate = 2.0 * kPi / 4.0, cone = kPi / 6.0;
  const MotionMetrics m = MeasureLeft(RecordMotion(8.0, [&](double t) {
    ToolSample sample = TipAt({radius * std::cos(rate * t), radius * std::sin(rate * t), 0.1});
    sample.axis = {std::sin(cone) * std::cos(rate * t), std::sin(cone) * std::sin(rate * t), -std::cos(cone)};
    sample.spin = std::remainder(kPi * t / 8.0 + 2.5, 2.0 * kPi);
    return sample;
  }));
  EXPECT_NEAR(m.path_length, 4.0 * kPi * radius, 0.001);
  EXPECT_NEAR(m.spin_path, kPi, 0.01);
  // a circle of latitude is longer than its chords along great circles by a hair
  EXPECT_NEAR(m.angular_path - m.spin_path, 4.0 * kPi * std::sin(cone), 0.02);
  MetricSettings given;
  given.ideal_path_lengths = {2.0 * kPi * radius};
  const MotionMetrics half = MeasureLeft(
      RecordMotion(8.0,
                   [&](double t) {
                     return TipAt({radius * std::cos(rate * t), radius * std::sin(rate * t), 0.1});
                   }),
      given);
  EXPECT_NEAR(*half.economy_of_motion, 0.5, 0.003);
}

TEST(MotionMetrics, LeavesWhatAnIdleToolCannotHaveUndefined) {
  const MotionMetrics m = MeasureLeft(RecordMotion(3.0, [](double) { return TipAt({0.1, 0.2, 0.3}); }));
  EXPECT_EQ(m.path_length, 0.0);
  EXPECT_EQ(m.movements, 0);
  EXPECT_EQ(*m.idle_fraction, 1.0);
  EXPECT_FALSE(m.economy_of_motion);
  EXPECT_FALSE(m.motion_smoothness);
  EXPECT_FALSE(m.sparc);
  EXPECT_FALSE(m.log_dimensionless_jerk);
  EXPECT_FALSE(m.grasp_efficiency);
}

// A still tool whose tracker trembles by 0.2 mm goes nowhere; without the rule it seems to travel far.
TEST(MotionMetrics, IgnoresTremorBelowTheNoiseStep) {
  math::Random random(41);
  const MotionRecording tremor = RecordMotion(20.0, [&](double) {
    return TipAt({random.Uniform(-1e-4, 1e-4), random.Uniform(-1e-4, 1e-4), random.Uniform(-1e-4, 1e-4)});
  });
  EXPECT_EQ(MeasureLeft(tremor).path_length, 0.0);
  MetricSettings plain;
  plain.noise_step = 0.0;
  EXPECT_GT(MeasureLeft(tremor, plain).path_length, 0.01);
}

// A slow advance of 1 mm/s is no noise although every single step of it is tiny.
TEST(MotionMetrics, DoesNotLoseSlowMotionToTheNoiseRule) {
  const MotionMetrics m = MeasureLeft(RecordMotion(30.0, [](double t) { return TipAt({0.001 * t, 0, 0}); }));
  EXPECT_NEAR(m.path_length, 0.03, 0.0006);
}

// Analytic: a minimum-jerk movement has MS = sqrt(360), LDLJ = -ln 204.8 and a SPARC of healthy reaching, if
// it is taken whole: its jerk is greatest at both ends, where a threshold of speed cuts.
TEST(MotionMetrics, KnowsAMinimumJerkMovement) {
  const MotionRecording reach = RecordMotion(2.0, [](double t) {
    return TipAt({0.2 * MinimumJerk(t, 2.0), 0, 0});
  });
  MetricSettings whole;
  whole.noise_step = 0.0;
  whole.cutoff_hz = 40.0;
  whole.movement_end_speed = 0.0;
  const MotionMetrics m = MeasureLeft(reach, whole);
  EXPECT_NEAR(m.path_length, 0.2, 1e-4);
  EXPECT_NEAR(*m.max_speed, 1.875 * 0.2 / 2.0, 1e-3);
  EXPECT_NEAR(*m.motion_smoothness, std::sqrt(360.0), 0.05 * std::sqrt(360.0));
  EXPECT_EQ(m.movements, 1);
  EXPECT_NEAR(*m.log_dimensionless_jerk, -std::log(204.8), 0.06);
  EXPECT_NEAR(*m.sparc, -1.41, 0.04);

  const MotionMetrics usual = MeasureLeft(reach);
  EXPECT_EQ(usual.movements, 1);
  EXPECT_GT(*usual.log_dimensionless_jerk, *m.log_dimensionless_jerk);
  EXPECT_NEAR(*usual.sparc, *m.sparc, 0.03);
  RecordProperty("ldlj_usual_settings", std::to_string(*usual.log_dimensionless_jerk));
}

TEST(MotionMetrics, CountsMovementsAndRests) {
  // three reaches of 1 s, each followed by a rest of 1 s
  const auto reaches = [](double t) {
    const double done = std::floor(t / 2.0);
    return TipAt({0.1 * (done + MinimumJerk(t - 2.0 * done, 1.0)), 0, 0});
  };
  const MotionMetrics m = MeasureLeft(RecordMotion(6.0, reaches));
  EXPECT_EQ(m.movements, 3);
  EXPECT_NEAR(*m.idle_fraction, 0.5, 0.08);
  EXPECT_NEAR(m.path_length, 0.3, 0.002);
  // slower than 20 mm/s is drifting, no movement
  EXPECT_EQ(MeasureLeft(RecordMotion(4.0, [](double t) { return TipAt({0.01 * t, 0, 0}); })).movements, 0);
  // a dip of speed that stays above 5 mm/s does not divide a movement
  const MotionMetrics dip = MeasureLeft(RecordMotion(4.0, [](double t) {
    return TipAt({0.04 * t + 0.03 / kPi * std::sin(kPi * t), 0, 0});
  }));
  EXPECT_EQ(dip.movements, 1);
  // nor does a short stop: peaks within 0.2 s count once
  MetricSettings gap;
  gap.movement_gap = 2.5;
  EXPECT_EQ(MeasureLeft(RecordMotion(6.0, reaches), gap).movements, 1);
}

TEST(SessionMetrics, SeesTwoHandsMoveTogetherOrInTurn) {
  const auto sway = [](double phase) {
    return [phase](double t) { return TipAt({0.05 * std::sin(2.0 * t + phase), 0, 0}); };
  };
  const SessionMetrics together = CalcSessionMetrics(RecordMotion(20.0, sway(0), sway(0))).value();
  EXPECT_GT(*together.bimanual_fraction, 0.95);
  EXPECT_NEAR(*together.bimanual_correlation, 1.0, 1e-9);
  const SessionMetrics in_turn = CalcSessionMetrics(RecordMotion(20.0, sway(0), sway(kPi / 2))).value();
  EXPECT_LT(*in_turn.bimanual_correlation, -0.8);
  const SessionMetrics one_hand = CalcSessionMetrics(RecordMotion(20.0, sway(0))).value();
  EXPECT_EQ(*one_hand.bimanual_fraction, 0.0);
  EXPECT_FALSE(one_hand.bimanual_correlation);
}

TEST(MotionMetrics, MeasuresForceViewAndGrasps) {
  MotionRecorder recorder({.dt = 0.01, .tool_names = {"grasper"}});
  // a triangle of force from 0 to 5 N and back in 2 s, twice; out of view in the second half
  for (int tick = 0; tick < 400; ++tick) {
    ToolSample sample;
    sample.force = 5.0 * (1.0 - std::fabs(std::fmod(tick * 0.01, 2.0) - 1.0));
    sample.in_view = tick < 200 || tick >= 300;
    sample.in_contact = sample.force > 1.0;
    sample.grasping = tick >= 100 && tick < 150;
    recorder.Record({&sample, 1});
    if (tick == 90 || tick == 99) recorder.RecordEvent(0, GraspEventKind::kAttempt);
    if (tick == 99) recorder.RecordEvent(0, GraspEventKind::kSuccess);
    if (tick == 149) recorder.RecordEvent(0, GraspEventKind::kSlip);
  }
  const MotionMetrics m = MeasureLeft(recorder.Recording());
  EXPECT_NEAR(m.max_force, 5.0, 1e-12);
  // above 3 N: a triangle 2 N high and 0.8 s wide, twice
  EXPECT_NEAR(m.force_excess, 1.6, 1e-3);
  EXPECT_EQ(m.force_exceedances, 2);
  EXPECT_EQ(m.out_of_view_count, 1);
  EXPECT_NEAR(m.out_of_view_time, 1.0, 1e-9);
  EXPECT_NEAR(m.grasping_time, 0.5, 1e-9);
  EXPECT_NEAR(m.contact_time, 3.2, 0.05);
  EXPECT_EQ(m.grasp_attempts, 2);
  EXPECT_EQ(m.grasp_successes, 1);
  EXPECT_EQ(m.grasp_slips, 1);
  EXPECT_EQ(*m.grasp_efficiency, 0.5);
}

// A force that trembles about the threshold exceeds it once, not at every tick.
TEST(MotionMetrics, CountsATremblingForceOnce) {
  const MotionMetrics m = MeasureLeft(RecordMotion(2.0, [](double t) {
    ToolSample sample;
    sample.force = 3.0 + 0.1 * std::sin(200.0 * t);
    return sample;
  }));
  EXPECT_EQ(m.force_exceedances, 1);
}

TEST(SessionMetrics, ServesNothingAndASingleTick) {
  MotionRecorder recorder;
  const SessionMetrics nothing = CalcSessionMetrics(recorder.Recording()).value();
  EXPECT_EQ(nothing.time, 0.0);
  ASSERT_EQ(nothing.tools.size(), 2u);
  EXPECT_FALSE(nothing.tools[0].idle_fraction);
  EXPECT_FALSE(nothing.bimanual_fraction);
  const ToolSample samples[2];
  recorder.Record(samples);
  const SessionMetrics one = CalcSessionMetrics(recorder.Recording()).value();
  EXPECT_FALSE(one.tools[0].mean_speed);
  EXPECT_EQ(nlohmann::json::parse(FormatMetricsJson(one))["tools"][0]["mean_speed_mm_s"], nullptr);
}

TEST(SessionMetrics, RefusesBadSettingsAndSamples) {
  const MotionRecording good = RecordMotion(0.1, [](double) { return ToolSample{}; });
  const auto code = [](const MotionRecording& recording, const MetricSettings& settings) {
    const auto result = CalcSessionMetrics(recording, settings);
    return result.ok() ? core::ErrorCode::kNone : result.error().code;
  };
  EXPECT_EQ(code(good, {}), core::ErrorCode::kNone);
  const std::function<void(MetricSettings&)> faults[] = {
      [](MetricSettings& s) { s.sample_rate_hz = 0; },
      [](MetricSettings& s) { s.cutoff_hz = std::nan(""); },
      [](MetricSettings& s) { s.noise_step = -1; },
      [](MetricSettings& s) { s.force_release = 0; },
      [](MetricSettings& s) { s.movement_end_speed = 1; },
      [](MetricSettings& s) { s.sparc.pad_level = kMaxPadLevel + 1; },
      [](MetricSettings& s) { s.ideal_path_lengths = {0.0}; },
  };
  for (const auto& fault : faults) {
    MetricSettings settings;
    fault(settings);
    EXPECT_EQ(code(good, settings), core::ErrorCode::kNumberNotFinite);
  }
  MotionRecording bad = good;
  bad.tools[1][3].tip.z = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(bad, {}), core::ErrorCode::kNumberNotFinite);
  bad = good;
  bad.tools[1].pop_back();
  EXPECT_EQ(code(bad, {}), core::ErrorCode::kNumberNotFinite);
  bad = good;
  bad.dt = 0;
  EXPECT_EQ(code(bad, {}), core::ErrorCode::kNumberNotFinite);
}

TEST(FormatMetricsJson, WritesEveryDefinedMetricAndNoOther) {
  const MotionRecording recording = RecordMotion(2.0, [](double t) {
    return TipAt({0.1 * MinimumJerk(t, 2.0), 0, 0});
  });
  const SessionMetrics session = CalcSessionMetrics(recording).value();
  const nlohmann::json json = nlohmann::json::parse(FormatMetricsJson(session));
  EXPECT_EQ(json["disclaimer"], "training feedback, not certified assessment");
  std::set<std::string> session_keys{"disclaimer", "tools"}, tool_keys{"tool"};
  for (const MetricDefinition& definition : MetricDefinitions()) {
    EXPECT_FALSE(definition.unit.empty() || definition.meaning.empty() || definition.source.empty())
        << definition.name;
    EXPECT_TRUE((definition.per_tool ? tool_keys : session_keys).insert(std::string(definition.name)).second);
  }
  const auto keys = [](const nlohmann::json& object) {
    std::set<std::string> names;
    for (const auto& [name, value] : object.items()) names.insert(name);
    return names;
  };
  EXPECT_EQ(keys(json), session_keys);
  ASSERT_EQ(json["tools"].size(), 2u);
  for (const nlohmann::json& tool : json["tools"]) EXPECT_EQ(keys(tool), tool_keys);
  EXPECT_NEAR(json["tools"][0]["path_length_mm"].get<double>(), 100.0, 1.0);
  EXPECT_EQ(json["tools"][0]["movements"], 1);
  EXPECT_EQ(json["tools"][1]["economy_of_motion"], nullptr);
}

TEST(FormatMetricsJson, NeverWritesNotANumber) {
  SessionMetrics session;
  session.time = std::nan("");
  session.tools.resize(1);
  session.tools[0].tool = "\xff\xfe not UTF-8";
  session.tools[0].max_force = std::numeric_limits<double>::infinity();
  const nlohmann::json json = nlohmann::json::parse(FormatMetricsJson(session));
  EXPECT_EQ(json["time_s"], nullptr);
  EXPECT_EQ(json["tools"][0]["max_force_n"], nullptr);
}

}  // namespace
}  // namespace trocar::training
