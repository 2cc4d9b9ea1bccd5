// SPDX-License-Identifier: Apache-2.0
// How tools and laparoscope were moved: against closed formulas.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "attempt_traces.h"
#include "trocar/math/random.h"

namespace trocar::training {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(MotionMetrics, MeasuresAStraightLine) {
  const AttemptMetrics m = Measure(MakeTrace(4.0, [](double t) {
    ToolSample sample = TipAt({0.03 * t, 0.04 * t, 0});
    sample.insertion = 0.1 + 0.02 * t;
    return sample;
  }));
  EXPECT_NEAR(ValueOf(m, "time", ""), 4.0, 1e-12);
  EXPECT_NEAR(ValueOf(m, "path_length"), 0.2, 0.0005);
  EXPECT_EQ(m.Find("economy_of_motion", "left"), nullptr) << "no shortest path was given";
  EXPECT_NEAR(ValueOf(m, "depth_path"), 0.08, 0.0005);
  EXPECT_NEAR(ValueOf(m, "mean_speed"), 0.05, 0.0002);
  EXPECT_NEAR(ValueOf(m, "max_speed"), 0.05, 0.0002);
  EXPECT_NEAR(ValueOf(m, "movement_straightness"), 1.0, 1e-9);
  EXPECT_EQ(ValueOf(m, "movements"), 1);
  EXPECT_EQ(ValueOf(m, "idle_fraction"), 0.0);
  EXPECT_EQ(ValueOf(m, "angular_path"), 0.0);
  EXPECT_EQ(ValueOf(m, "angular_area"), 0.0);
}

TEST(MotionMetrics, MeasuresACircle) {
  // two rounds of radius 3 cm in 8 s; the shaft sweeps a cone of 30 degrees, the spin goes half a turn and wraps
  const double radius = 0.03, rate = 2.0 * kPi / 4.0, cone = kPi / 6.0;
  AttemptTrace trace = MakeTrace(8.0, [&](double t) {
    ToolSample sample = TipAt({radius * std::cos(rate * t), radius * std::sin(rate * t), 0.1});
    sample.axis = {std::sin(cone) * std::cos(rate * t), std::sin(cone) * std::sin(rate * t), -std::cos(cone)};
    sample.spin = std::remainder(kPi * t / 8.0 + 2.5, 2.0 * kPi);
    sample.insertion = 0.1 + 0.01 * std::sin(rate * t);
    return sample;
  });
  const AttemptMetrics m = Measure(trace);
  EXPECT_NEAR(ValueOf(m, "path_length"), 4.0 * kPi * radius, 0.001);
  EXPECT_NEAR(ValueOf(m, "spin_path"), kPi, 0.01);
  // a circle of latitude is longer than its chords along great circles by a hair
  EXPECT_NEAR(ValueOf(m, "angular_path") - ValueOf(m, "spin_path"), 4.0 * kPi * std::sin(cone), 0.02);
  EXPECT_NEAR(ValueOf(m, "angular_area"), 2.0 * cone, 0.01);
  EXPECT_NEAR(ValueOf(m, "angular_volume"), std::cbrt(4.0 * cone * cone * 0.02), 0.003);
  EXPECT_LT(ValueOf(m, "movement_straightness"), 0.01) << "it comes back to where it began";
  trace.ideal_path = {2.0 * kPi * radius};
  EXPECT_EQ(Measure(trace).Find("economy_of_motion", "left"), nullptr) << "it was not completed";
  trace.outcome.is_completed = true;
  EXPECT_NEAR(ValueOf(Measure(trace), "economy_of_motion"), 0.5, 0.003);
  EXPECT_EQ(Measure(trace).Find("economy_of_motion", "right"), nullptr) << "of that hand nothing is stated";
}

TEST(MotionMetrics, LeavesWhatAnIdleToolCannotHaveUndefined) {
  const AttemptMetrics m = Measure(MakeTrace(3.0, [](double) { return TipAt({0.1, 0.2, 0.3}); }));
  EXPECT_EQ(ValueOf(m, "path_length"), 0.0);
  EXPECT_EQ(ValueOf(m, "movements"), 0);
  EXPECT_EQ(ValueOf(m, "idle_fraction"), 1.0);
  for (const char* undefined : {"economy_of_motion", "movement_straightness", "motion_smoothness", "sparc",
                                "log_dimensionless_jerk", "grasp_efficiency", "cautery_efficiency"})
    EXPECT_EQ(m.Find(undefined, "left"), nullptr) << undefined;
  EXPECT_EQ(m.Find("bimanual_correlation"), nullptr);
}

// A still tool whose tracker trembles by 0.2 mm goes nowhere; without the rule it seems to travel far.
TEST(MotionMetrics, IgnoresTremorBelowTheNoiseStep) {
  math::Random random(41);
  const AttemptTrace tremor = MakeTrace(20.0, [&](double) {
    return TipAt({random.Uniform(-1e-4, 1e-4), random.Uniform(-1e-4, 1e-4), random.Uniform(-1e-4, 1e-4)});
  });
  EXPECT_EQ(ValueOf(Measure(tremor), "path_length"), 0.0);
  MetricSettings plain;
  plain.noise_step = 0.0;
  EXPECT_GT(ValueOf(Measure(tremor, plain), "path_length"), 0.01);
}

// A slow advance of 1 mm/s is no noise although every single step of it is tiny.
TEST(MotionMetrics, DoesNotLoseSlowMotionToTheNoiseRule) {
  const AttemptMetrics m = Measure(MakeTrace(30.0, [](double t) { return TipAt({0.001 * t, 0, 0}); }));
  EXPECT_NEAR(ValueOf(m, "path_length"), 0.03, 0.0006);
}

// Analytic: a minimum-jerk movement has MS = sqrt(360), LDLJ = -ln 204.8 and a SPARC of healthy reaching, if
// it is taken whole: its jerk is greatest at both ends, where a threshold of speed cuts.
TEST(MotionMetrics, KnowsAMinimumJerkMovement) {
  const AttemptTrace reach = MakeTrace(2.0, [](double t) {
    return TipAt({0.2 * MinimumJerk(t, 2.0), 0, 0});
  });
  MetricSettings whole;
  whole.noise_step = 0.0;
  whole.cutoff_hz = whole.jerk_cutoff_hz = 40.0;
  whole.movement_end_speed = 0.0;
  const AttemptMetrics m = Measure(reach, whole);
  EXPECT_NEAR(ValueOf(m, "path_length"), 0.2, 1e-4);
  EXPECT_NEAR(ValueOf(m, "max_speed"), 1.875 * 0.2 / 2.0, 1e-3);
  EXPECT_NEAR(ValueOf(m, "motion_smoothness"), std::sqrt(360.0), 0.05 * std::sqrt(360.0));
  EXPECT_EQ(ValueOf(m, "movements"), 1);
  EXPECT_NEAR(ValueOf(m, "log_dimensionless_jerk"), -std::log(204.8), 0.06);
  EXPECT_NEAR(ValueOf(m, "sparc"), -1.41, 0.04);

  const AttemptMetrics usual = Measure(reach);
  EXPECT_EQ(ValueOf(usual, "movements"), 1);
  EXPECT_GT(ValueOf(usual, "log_dimensionless_jerk"), ValueOf(m, "log_dimensionless_jerk"));
  EXPECT_NEAR(ValueOf(usual, "sparc"), ValueOf(m, "sparc"), 0.03);
}

TEST(MotionMetrics, CountsMovementsAndRests) {
  // three reaches of 1 s, each followed by a rest of 1 s
  const auto reaches = [](double t) {
    const double done = std::floor(t / 2.0);
    return TipAt({0.1 * (done + MinimumJerk(t - 2.0 * done, 1.0)), 0, 0});
  };
  const AttemptMetrics m = Measure(MakeTrace(6.0, reaches));
  EXPECT_EQ(ValueOf(m, "movements"), 3);
  EXPECT_NEAR(ValueOf(m, "idle_fraction"), 0.5, 0.08);
  EXPECT_NEAR(ValueOf(m, "path_length"), 0.3, 0.002);
  // slower than 20 mm/s is drifting, no movement
  EXPECT_EQ(ValueOf(Measure(MakeTrace(4.0,
                                      [](double t) {
                                        return TipAt({0.01 * t, 0, 0});
                                      })),
                    "movements"),
            0);
  // a dip of speed that stays above 5 mm/s does not divide a movement
  const AttemptMetrics dip = Measure(MakeTrace(4.0, [](double t) {
    return TipAt({0.04 * t + 0.03 / kPi * std::sin(kPi * t), 0, 0});
  }));
  EXPECT_EQ(ValueOf(dip, "movements"), 1);
  // nor does a short stop: peaks within 0.2 s count once
  MetricSettings gap;
  gap.movement_gap = 2.5;
  EXPECT_EQ(ValueOf(Measure(MakeTrace(6.0, reaches), gap), "movements"), 1);
}

TEST(MotionMetrics, SeesTwoHandsMoveTogetherOrInTurn) {
  const auto sway = [](double phase) {
    return [phase](double t) { return TipAt({0.05 * std::sin(2.0 * t + phase), 0, 0}); };
  };
  const AttemptMetrics together = Measure(MakeTrace(20.0, sway(0), sway(0)));
  EXPECT_GT(ValueOf(together, "bimanual_fraction", ""), 0.95);
  EXPECT_NEAR(ValueOf(together, "bimanual_correlation", ""), 1.0, 1e-9);
  const AttemptMetrics in_turn = Measure(MakeTrace(20.0, sway(0), sway(kPi / 2)));
  EXPECT_LT(ValueOf(in_turn, "bimanual_correlation", ""), -0.8);
  const AttemptMetrics one_hand = Measure(MakeTrace(20.0, sway(0)));
  EXPECT_EQ(ValueOf(one_hand, "bimanual_fraction", ""), 0.0);
  EXPECT_EQ(one_hand.Find("bimanual_correlation"), nullptr);
}

TEST(MotionMetrics, MeasuresTheLaparoscope) {
  AttemptTrace trace = MakeTrace(10.0, [](double) { return ToolSample{}; });
  for (std::size_t i = 0; i < trace.Ticks(); ++i) {
    const double t = static_cast<double>(i) * trace.dt;
    trace.camera.push_back({{0, 0.01 * t, 0}, {0, std::cos(0.1 * t), -std::sin(0.1 * t)}, 0.02 * (t - 5.0)});
  }
  const AttemptMetrics m = Measure(trace);
  EXPECT_NEAR(ValueOf(m, "path_length", "camera"), 0.1, 0.0006);
  EXPECT_NEAR(ValueOf(m, "view_angular_path", "camera"), 1.0, 0.005);
  EXPECT_NEAR(ValueOf(m, "view_roll_mean", "camera"), 0.05, 1e-4);
  EXPECT_NEAR(ValueOf(m, "view_roll_max", "camera"), 0.1, 1e-9);
  EXPECT_EQ(m.Find("movements", "camera"), nullptr);
}

// What is summed over phases is what is summed over the whole.
TEST(MotionMetrics, PhasesAddUpToTheWhole) {
  AttemptTrace trace = MakeTrace(9.0, [](double t) {
    ToolSample sample = TipAt({0.05 * std::sin(2.0 * t), 0.03 * std::cos(3.0 * t), -0.1});
    sample.insertion = 0.1 + 0.02 * std::sin(t);
    sample.spin = t;
    sample.force = 4.0 * std::fabs(std::sin(t));
    return sample;
  });
  trace.phases = {{"Preparation", 0.0, 2.5}, {"ClippingCutting", 2.5, 7.0}, {"Preparation", 7.0, 9.0}};
  const AttemptMetrics m = Measure(trace);
  for (const char* metric : {"path_length", "depth_path", "angular_path", "spin_path", "movements",
                             "force_excess", "force_exceedances", "grasp_attempts"}) {
    EXPECT_NEAR(ValueOf(m, metric),
                ValueOf(m, metric, "left", "Preparation") + ValueOf(m, metric, "left", "ClippingCutting"),
                1e-9)
        << metric;
  }
  EXPECT_NEAR(ValueOf(m, "time", "", "Preparation"), 4.5, 1e-9);
  EXPECT_NEAR(ValueOf(m, "time", "", "ClippingCutting"), 4.5, 1e-9);
  EXPECT_EQ(m.Find("time", "", "GallbladderDissection"), nullptr);
}

TEST(MotionMetrics, ToolsAreMeasuredAlone) {
  const AttemptMetrics m = Measure(MakeTrace(4.0, [](double t) {
    ToolSample sample = TipAt({t < 2.0 ? 0.05 * t : 0.1, 0, 0});
    sample.tool = t < 2.0 ? 0 : 1;
    return sample;
  }));
  EXPECT_NEAR(ValueOf(m, "path_length", "left", "", "grasper"), 0.1, 0.001);
  EXPECT_LT(ValueOf(m, "path_length", "left", "", "hook"), 0.005);
  EXPECT_NEAR(ValueOf(m, "time", "left", "", "hook"), 2.0, 1e-9);
  EXPECT_EQ(ValueOf(m, "tool_exchanges"), 1);
  EXPECT_EQ(m.Find("path_length", "right", "", "grasper"), nullptr) << "it used no other";
}

TEST(AttemptMetrics, ServesNothingAndASingleTick) {
  AttemptTrace trace;
  trace.dt = 0.01;
  const AttemptMetrics nothing = Measure(trace);
  EXPECT_EQ(ValueOf(nothing, "time", ""), 0.0);
  EXPECT_EQ(nothing.Find("path_length", "left"), nullptr);
  trace.hands = {std::vector<ToolSample>(1), std::vector<ToolSample>(1)};
  const AttemptMetrics one = Measure(trace);
  EXPECT_EQ(one.Find("mean_speed", "left"), nullptr);
  EXPECT_EQ(ValueOf(one, "path_length"), 0.0);
}

TEST(AttemptMetrics, RefusesBadSettingsAndSamples) {
  const AttemptTrace good = MakeTrace(0.1, [](double) { return ToolSample{}; });
  const auto code = [](const AttemptTrace& trace, const MetricSettings& settings) {
    const auto result = CalcAttemptMetrics(trace, settings);
    return result.ok() ? base::ErrorCode::kNone : result.error().code;
  };
  EXPECT_EQ(code(good, {}), base::ErrorCode::kNone);
  const std::function<void(MetricSettings&)> faults[] = {
      [](MetricSettings& s) { s.sample_rate_hz = 0; },
      [](MetricSettings& s) { s.cutoff_hz = std::nan(""); },
      [](MetricSettings& s) { s.jerk_cutoff_hz = 0; },
      [](MetricSettings& s) { s.noise_step = -1; },
      [](MetricSettings& s) { s.release_share = 0; },
      [](MetricSettings& s) { s.idle_window = 0; },
      [](MetricSettings& s) { s.movement_end_speed = 1; },
      [](MetricSettings& s) { s.safe_duct_distance = std::nan(""); },
      [](MetricSettings& s) { s.sparc.pad_level = kMaxPadLevel + 1; },
  };
  for (const auto& fault : faults) {
    MetricSettings settings;
    fault(settings);
    EXPECT_EQ(code(good, settings), base::ErrorCode::kNumberNotFinite);
  }
  const std::function<void(AttemptTrace&)> spoils[] = {
      [](AttemptTrace& t) { t.hands[1][3].tip.z = std::numeric_limits<double>::infinity(); },
      [](AttemptTrace& t) { t.hands[1].pop_back(); },
      [](AttemptTrace& t) { t.hands[0][0].force = -1; },
      [](AttemptTrace& t) { t.hands[0][0].tool = 2; },
      [](AttemptTrace& t) { t.camera.resize(3); },
      [](AttemptTrace& t) { t.events.resize(1), t.events[0].time = std::nan(""); },
      [](AttemptTrace& t) {
        t.phases.push_back({"", 0, 1});
      },
      [](AttemptTrace& t) { t.dt = 0; },
      [](AttemptTrace& t) { t.ideal_path = {0.0}; },
  };
  for (const auto& spoil : spoils) {
    AttemptTrace bad = good;
    spoil(bad);
    EXPECT_EQ(code(bad, {}), base::ErrorCode::kNumberNotFinite);
  }
}

}  // namespace
}  // namespace trocar::training
