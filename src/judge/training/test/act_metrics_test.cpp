// SPDX-License-Identifier: Apache-2.0
// What was done: view, force, grasps, current, clips, errors, the task.
#include <numbers>

#include "attempt_traces.h"

namespace trocar::training {
namespace {

ToolSample Still(double) {
  return {};
}

AttemptEvent EventAt(double time, const char* kind, int hand) {
  AttemptEvent event;
  event.time = time;
  event.kind = kind;
  event.hand = hand;
  return event;
}

TEST(ActMetrics, MeasuresForceAndView) {
  // a triangle of force from 0 to 5 N and back in 2 s, twice; out of view in one second
  const AttemptMetrics m = Measure(MakeTrace(
      4.0,
      [](double t) {
        ToolSample sample;
        sample.force = 5.0 * (1.0 - std::fabs(std::fmod(t, 2.0) - 1.0));
        sample.in_view = t < 2.0 || t >= 3.0;
        sample.in_contact = sample.force > 1.0;
        sample.grasping = t >= 1.0 && t < 1.5;
        return sample;
      },
      Still, 100.0));
  EXPECT_NEAR(ValueOf(m, "max_force"), 5.0, 1e-12);
  // above 3 N: a triangle 2 N high and 0.8 s wide, twice
  EXPECT_NEAR(ValueOf(m, "force_excess"), 1.6, 1e-3);
  EXPECT_EQ(ValueOf(m, "force_exceedances"), 2);
  EXPECT_EQ(ValueOf(m, "out_of_view_count"), 1);
  EXPECT_NEAR(ValueOf(m, "out_of_view_time"), 1.0, 1e-9);
  EXPECT_NEAR(ValueOf(m, "out_of_view_fraction"), 0.25, 1e-9);
  EXPECT_NEAR(ValueOf(m, "grasping_time"), 0.5, 1e-9);
  EXPECT_NEAR(ValueOf(m, "contact_time"), 3.2, 0.05);
}

// A force that trembles about the threshold exceeds it once, not at every tick.
TEST(ActMetrics, CountsATremblingForceOnce) {
  const AttemptMetrics m = Measure(MakeTrace(2.0, [](double t) {
    ToolSample sample;
    sample.force = 3.0 + 0.1 * std::sin(200.0 * t);
    return sample;
  }));
  EXPECT_EQ(ValueOf(m, "force_exceedances"), 1);
}

TEST(ActMetrics, CountsHardContactsOfToolsThatHoldNothing) {
  const AttemptMetrics m = Measure(MakeTrace(5.0, [](double t) {
    ToolSample sample;
    sample.in_contact = t < 4.0;
    sample.grasping = t >= 3.0;
    // 3 mm, a dip that is no release, 4 mm; 1 mm; 8 mm while something is held
    sample.press = t < 0.5 ? 0.003 : t < 0.7 ? 0.0019 : t < 1.0 ? 0.004 : t < 3.0 ? 0.001 : 0.008;
    return sample;
  }));
  EXPECT_EQ(ValueOf(m, "hard_contacts"), 1);
  EXPECT_NEAR(ValueOf(m, "hard_contact_depth"), 0.004, 1e-12);
}

TEST(ActMetrics, CountsGraspsAndRegrasps) {
  AttemptTrace trace = MakeTrace(10.0, Still);
  trace.events = {EventAt(0.5, "grasp_missed", 0), EventAt(1.0, "grasp", 0),   EventAt(2.0, "slip", 0),
                  EventAt(3.0, "grasp", 0),        EventAt(4.0, "release", 0), EventAt(4.5, "grasp", 1),
                  EventAt(7.0, "grasp", 0),        EventAt(8.0, "tear", 0),    EventAt(8.0, "tear", -1)};
  const AttemptMetrics m = Measure(trace);
  EXPECT_EQ(ValueOf(m, "grasp_attempts"), 4);
  EXPECT_EQ(ValueOf(m, "grasp_successes"), 3);
  EXPECT_NEAR(ValueOf(m, "grasp_efficiency"), 0.75, 1e-12);
  EXPECT_EQ(ValueOf(m, "grasp_slips"), 1);
  EXPECT_EQ(ValueOf(m, "regrasps"), 1) << "1 s after the slip; 3 s after letting go is another grasp";
  EXPECT_EQ(ValueOf(m, "tears"), 1);
  EXPECT_EQ(ValueOf(m, "grasp_attempts", "right"), 1);
  EXPECT_EQ(ValueOf(m, "regrasps", "right"), 0) << "the other hand let go";
}

TEST(ActMetrics, MeasuresCurrent) {
  AttemptTrace trace = MakeTrace(10.0, Still, [](double t) {
    ToolSample sample;
    sample.pedal = t >= 1.0 && t < 5.0;
    sample.has_current = t >= 2.0 && t < 4.0;
    // near the duct in the last half second, out of view in the first
    if (sample.has_current) sample.duct_distance = t < 3.5 ? 0.01 : 0.003;
    sample.in_view = t >= 2.5;
    return sample;
  });
  trace.tool_names = {"hook"};
  const AttemptMetrics m = Measure(trace);
  EXPECT_NEAR(ValueOf(m, "cautery_time", "right"), 2.0, 0.01);
  EXPECT_NEAR(ValueOf(m, "cautery_without_contact", "right"), 2.0, 0.01);
  EXPECT_NEAR(ValueOf(m, "cautery_efficiency", "right"), 0.5, 0.005);
  EXPECT_NEAR(ValueOf(m, "safe_cautery", "right"), 0.5, 0.01);
  EXPECT_NEAR(ValueOf(m, "cautery_duct_distance", "right"), 0.003, 1e-12);
  EXPECT_EQ(m.Find("cautery_efficiency", "left"), nullptr) << "no pedal was pressed";
}

TEST(ActMetrics, JoinsCollisionsThatAreClose) {
  const AttemptMetrics m = Measure(MakeTrace(6.0, [](double t) {
    ToolSample sample;
    sample.touching_tool = (t >= 1.0 && t < 1.2) || (t >= 1.5 && t < 1.6) || (t >= 3.0 && t < 3.1);
    return sample;
  }));
  EXPECT_EQ(ValueOf(m, "instrument_collisions", ""), 2);
}

TEST(ActMetrics, JudgesClips) {
  constexpr double kRight = std::numbers::pi / 2;
  AttemptTrace trace = MakeTrace(10.0, Still);
  trace.is_operation = true;
  trace.clips = {{1.0, 1, "cystic_duct", false, false, 0.004, kRight - 0.1},
                 {2.0, 1, "cystic_duct", false, false, 0.003, kRight - 0.3},
                 {3.0, 1, "", true, false, {}, {}},
                 {4.0, 0, "common_bile_duct", false, true, {}, kRight}};
  const AttemptMetrics m = Measure(trace);
  EXPECT_EQ(ValueOf(m, "clips_placed", ""), 3);
  EXPECT_EQ(ValueOf(m, "clips_lost", ""), 1);
  EXPECT_EQ(ValueOf(m, "clips_misplaced", ""), 1);
  EXPECT_NEAR(ValueOf(m, "clip_gap", ""), 0.003, 1e-12);
  EXPECT_NEAR(ValueOf(m, "clip_angle_error", ""), 0.4 / 3, 1e-12);
  EXPECT_EQ(ValueOf(m, "clips_placed", "right"), 2);
  EXPECT_EQ(m.Find("clip_gap", "left"), nullptr) << "one clip alone";
}

TEST(ActMetrics, CountsErrorsBySeverityHandAndPhase) {
  AttemptTrace trace = MakeTrace(10.0, Still);
  trace.is_operation = true;
  trace.phases = {{"Preparation", 0, 5}, {"ClippingCutting", 5, 10}};
  const auto error = [&](double time, surgery::Severity severity, int hand) {
    AttemptEvent event = EventAt(time, "some_error", hand);
    event.is_error = true;
    event.severity = severity;
    trace.events.push_back(event);
  };
  error(1.0, surgery::Severity::kMinor, 0);
  error(2.0, surgery::Severity::kMajor, 1);
  error(5.0, surgery::Severity::kCritical, -1);
  error(6.0, surgery::Severity::kMinor, 0);
  const AttemptMetrics m = Measure(trace);
  EXPECT_EQ(ValueOf(m, "errors", ""), 4);
  EXPECT_EQ(ValueOf(m, "errors_minor", ""), 2);
  EXPECT_EQ(ValueOf(m, "errors_major", ""), 1);
  EXPECT_EQ(ValueOf(m, "errors_critical", ""), 1);
  EXPECT_EQ(ValueOf(m, "errors", "left"), 2);
  EXPECT_EQ(ValueOf(m, "errors", "", "Preparation"), 2);
  EXPECT_EQ(ValueOf(m, "errors_critical", "", "ClippingCutting"), 1) << "at its very beginning";
  EXPECT_EQ(m.Find("rules_broken"), nullptr) << "not a task";
  trace.is_operation = false;
  EXPECT_EQ(Measure(trace).Find("errors"), nullptr) << "nobody judged";
}

TEST(ActMetrics, SharesFluidsOutOverPhases) {
  AttemptTrace trace = MakeTrace(10.0, Still);
  trace.is_operation = true;
  trace.phases = {{"Preparation", 0, 4}, {"ClippingCutting", 4, 10}};
  for (int second = 0; second <= 10; ++second)
    trace.fluids.push_back({static_cast<double>(second), 2e-6 + 1e-6 * std::max(0, second - 3), 0});
  const AttemptMetrics m = Measure(trace);
  EXPECT_NEAR(ValueOf(m, "blood_lost", ""), 7e-6, 1e-15) << "what was lost before is not counted";
  EXPECT_NEAR(ValueOf(m, "blood_lost", "", "Preparation"), 1e-6, 1e-15);
  EXPECT_NEAR(ValueOf(m, "blood_lost", "", "ClippingCutting"), 6e-6, 1e-15);
  EXPECT_EQ(ValueOf(m, "bile_spilled", ""), 0.0);
}

TEST(ActMetrics, TellsHowATaskEnded) {
  AttemptTrace trace = MakeTrace(10.0, Still);
  trace.goals = {{"first", 3.0, 10}, {"second", {}, 10}, {"third", 4.0, 10}};
  trace.outcome = {"time_over", false, 66.5, 9.0};
  const AttemptMetrics m = Measure(trace);
  EXPECT_EQ(ValueOf(m, "goals_done", ""), 2);
  EXPECT_NEAR(ValueOf(m, "goals_done_fraction", ""), 2.0 / 3, 1e-12);
  EXPECT_EQ(ValueOf(m, "score", ""), 66.5);
  EXPECT_EQ(ValueOf(m, "task_time", ""), 9.0);
  EXPECT_EQ(m.Find("critical_view_time"), nullptr);
  EXPECT_EQ(m.Find("stones_lost"), nullptr) << "not an operation";
}

}  // namespace
}  // namespace trocar::training
