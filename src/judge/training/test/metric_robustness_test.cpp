// SPDX-License-Identifier: Apache-2.0
// The same motion, measured in another way, gives the same metrics within the tolerance that each definition states.
#include <random>

#include "attempt_traces.h"
#include "trocar/training/metric_definition.h"

namespace trocar::training {

using math::Vec3;

namespace {

constexpr double kSeconds = 30.0;

/// Reaches between points of a working space, with rests: by its number in the row, minimum jerk.
struct ReachingHand {
  double phase;

  ToolSample operator()(double t) const {
    // every 1.5 s a reach of 1.0 s
    const double period = 1.5, at = t + phase;
    const double done = std::floor(at / period);
    const double share = MinimumJerk(at - period * done, 1.0);
    const Vec3 a = PointOf(static_cast<int>(done)), b = PointOf(static_cast<int>(done) + 1);
    ToolSample sample;
    sample.tip = a + share * (b - a);
    const Vec3 port{0.05, -0.1, 0.0};
    const Vec3 shaft = sample.tip - port;
    sample.insertion = math::Norm(shaft);
    sample.axis = shaft / sample.insertion;
    sample.spin = 0.5 * std::sin(0.9 * at);
    return sample;
  }
  static Vec3 PointOf(int number) {
    return {0.04 * std::sin(2.1 * number), 0.03 * std::cos(1.3 * number),
            -0.1 + 0.02 * std::sin(3.7 * number)};
  }
};

AttemptTrace MakeReaches(double rate, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> tremble(0.0, noise);
  const auto shaken = [&](double phase) -> HandMotion {
    return [&, phase](double t) {
      ToolSample sample = ReachingHand{phase}(t);
      if (noise > 0.0) {
        sample.tip = sample.tip + Vec3{tremble(random), tremble(random), tremble(random)};
        const Vec3 shaft = sample.tip - Vec3{0.05, -0.1, 0.0};
        sample.insertion = math::Norm(shaft);
        sample.axis = shaft / sample.insertion;
      }
      return sample;
    };
  };
  AttemptTrace trace = MakeTrace(kSeconds, shaken(0.0), shaken(0.4), rate);
  trace.ideal_path = {0.5, 0.5};
  trace.outcome.is_completed = true;
  for (std::size_t i = 0; i < trace.Ticks(); ++i) {
    const double t = static_cast<double>(i) * trace.dt;
    const Vec3 wobble = noise > 0.0 ? Vec3{tremble(random), tremble(random), tremble(random)} : Vec3{0, 0, 0};
    trace.camera.push_back(
        {Vec3{0.01 * std::sin(0.5 * t), 0.02 * std::cos(0.4 * t), 0} + wobble,
         {0.2 * std::sin(0.5 * t), std::sqrt(1 - 0.04 * std::sin(0.5 * t) * std::sin(0.5 * t)), 0},
         0.0});
  }
  return trace;
}

/// Compares each value with a stated tolerance; it must not be so wide that it says nothing.
void ExpectWithin(const AttemptMetrics& reference, const AttemptMetrics& other, bool is_noise,
                  const char* what) {
  int compared = 0;
  for (const MetricValue& v : reference.values) {
    const MetricDefinition* definition = FindMetric(v.metric);
    if (!definition->tolerance) continue;
    const double share = is_noise ? definition->tolerance->noise : definition->tolerance->rate;
    const double* value = other.Find(v.metric, v.hand, v.phase, v.tool);
    ASSERT_NE(value, nullptr) << what << ": " << v.metric;
    EXPECT_LE(std::fabs(*value - v.value), share * std::fabs(v.value) + 1e-12)
        << what << ": " << v.metric << " " << v.hand << " is " << *value << ", it was " << v.value << ": "
        << 100 * std::fabs(*value / v.value - 1) << " %";
    ++compared;
  }
  EXPECT_GE(compared, 30);
}

TEST(MetricRobustness, HoldsAtOtherSamplingRates) {
  const AttemptMetrics reference = Measure(MakeReaches(120.0, 0.0, 0));
  for (const double rate : {60.0, 240.0}) {
    ExpectWithin(reference, Measure(MakeReaches(rate, 0.0, 0)), false, rate < 100 ? "60 Hz" : "240 Hz");
  }
}

TEST(MetricRobustness, HoldsWithTrackerNoise) {
  const AttemptMetrics reference = Measure(MakeReaches(120.0, 0.0, 0));
  for (unsigned seed = 1; seed <= 5; ++seed)
    ExpectWithin(reference, Measure(MakeReaches(120.0, 2e-4, seed)), true, "noise");
}

// The tolerance is no fig leaf: without the low-pass the same noise leaves it.
TEST(MetricRobustness, DependsOnTheLowPass) {
  MetricSettings raw;
  raw.cutoff_hz = 60.0;
  const double quiet = ValueOf(Measure(MakeReaches(120.0, 0.0, 0), raw), "path_length");
  const double noisy = ValueOf(Measure(MakeReaches(120.0, 2e-4, 1), raw), "path_length");
  EXPECT_GT(noisy, (1 + 3 * FindMetric("path_length")->tolerance->noise) * quiet);
}

// Nor would jerk be: with the low-pass of all other metrics the noise weighs more than the motion.
TEST(MetricRobustness, TakesJerkBelowALowerCutoff) {
  MetricSettings as_others;
  as_others.jerk_cutoff_hz = as_others.cutoff_hz;
  for (const char* metric : {"motion_smoothness", "dimensionless_jerk", "log_dimensionless_jerk"}) {
    const double quiet = ValueOf(Measure(MakeReaches(120.0, 0.0, 0), as_others), metric);
    const double noisy = ValueOf(Measure(MakeReaches(120.0, 2e-4, 1), as_others), metric);
    EXPECT_GT(std::fabs(noisy / quiet - 1), 5 * FindMetric(metric)->tolerance->noise) << metric;
    EXPECT_LE(FindMetric(metric)->tolerance->noise, 0.16) << metric;
  }
}

}  // namespace
}  // namespace trocar::training
