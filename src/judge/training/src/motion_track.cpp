// SPDX-License-Identifier: Apache-2.0
#include "motion_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"
#include "trocar/training/signal.h"

namespace trocar::training {

using math::Vec3;

namespace {

/// One number of each sample, at the even rate and filtered.
template <typename Sample, typename Get>
std::vector<double> SmoothSignal(std::span<const Sample> samples, double dt, const MetricSettings& settings,
                                 double cutoff_hz, Get&& get) {
  std::vector<double> raw;
  raw.reserve(samples.size());
  for (const Sample& sample : samples) raw.push_back(get(sample));
  const double step = 1.0 / settings.sample_rate_hz;
  return FilterLowPass(ResampleEvenly(raw, dt, step), step, cutoff_hz);
}

template <typename Sample, typename Get>
std::vector<Vec3> SmoothVector(std::span<const Sample> samples, double dt, const MetricSettings& settings,
                               double cutoff_hz, Get&& get) {
  std::array<std::vector<double>, 3> part;
  for (int axis = 0; axis < 3; ++axis) {
    part[static_cast<std::size_t>(axis)] =
        SmoothSignal(samples, dt, settings, cutoff_hz, [&](const Sample& s) { return get(s)[axis]; });
  }
  std::vector<Vec3> joined(part[0].size());
  for (std::size_t k = 0; k < joined.size(); ++k) joined[k] = {part[0][k], part[1][k], part[2][k]};
  return joined;
}

/// Full turns are added where the angle wraps.
std::vector<double> Unwrap(std::span<const ToolSample> samples) {
  std::vector<double> spin;
  spin.reserve(samples.size());
  double turns = 0.0, before = samples.empty() ? 0.0 : samples.front().spin;
  for (const ToolSample& sample : samples) {
    turns -= std::round((sample.spin - before) / (2.0 * std::numbers::pi));
    before = sample.spin;
    spin.push_back(sample.spin + 2.0 * std::numbers::pi * turns);
  }
  return spin;
}

/// A value counts only when it is at least `noise` away from the last that counted; then it adds that distance.
template <typename T, typename CalcDistance>
std::vector<double> CalcSteps(const std::vector<T>& values, double noise, CalcDistance&& calc_distance) {
  std::vector<double> steps(values.size(), 0.0);
  if (values.empty()) return steps;
  T last = values.front();
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double distance = calc_distance(last, values[k]);
    if (distance < noise) continue;
    steps[k] = distance;
    last = values[k];
  }
  return steps;
}

double AngleBetween(const Vec3& a, const Vec3& b) {
  return math::Atan2(math::Norm(math::Cross(a, b)), math::Dot(a, b));
}
double CalcDifference(double a, double b) {
  return std::fabs(a - b);
}

/// |x'''|^2 by central third differences.
std::vector<double> CalcSquaredJerk(const std::vector<Vec3>& x, double step) {
  std::vector<double> squared(x.size(), 0.0);
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    const Vec3 jerk = (x[k + 2] - 2.0 * x[k + 1] + 2.0 * x[k - 1] - x[k - 2]) / (2.0 * step * step * step);
    squared[k] = math::SquaredNorm(jerk);
  }
  return squared;
}

std::vector<double> CalcSpeed(const std::vector<Vec3>& x, double step) {
  std::array<std::vector<double>, 3> velocity;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> part(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) part[k] = x[k][axis];
    velocity[static_cast<std::size_t>(axis)] = Differentiate(part, step);
  }
  std::vector<double> speed(x.size());
  for (std::size_t k = 0; k < speed.size(); ++k)
    speed[k] = math::Norm(Vec3{velocity[0][k], velocity[1][k], velocity[2][k]});
  return speed;
}

/// Speed from half a window before to half a window after, as far as there are samples.
std::vector<double> CalcSlowSpeed(const std::vector<Vec3>& x, const MetricSettings& settings) {
  const auto half = base::TruncateTo<std::size_t>(
      std::max(1.0, std::floor(0.5 * settings.idle_window * settings.sample_rate_hz + 0.5)));
  std::vector<double> speed(x.size(), 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t from = k - std::min(k, half), to = std::min(k + half, x.size() - 1);
    if (to > from)
      speed[k] = math::Distance(x[from], x[to]) * settings.sample_rate_hz / static_cast<double>(to - from);
  }
  return speed;
}

std::vector<Movement> FindMovements(const std::vector<double>& speed, const MetricSettings& settings) {
  std::vector<Movement> movements;
  const double gap = settings.movement_gap * settings.sample_rate_hz;
  for (std::size_t k = 0; k < speed.size(); ++k) {
    if (speed[k] <= settings.movement_end_speed) continue;
    const std::size_t first = k;
    std::size_t peak = k;
    for (; k < speed.size() && speed[k] > settings.movement_end_speed; ++k) {
      if (speed[k] > speed[peak]) peak = k;
    }
    if (speed[peak] <= settings.movement_start_speed) continue;
    if (!movements.empty() && static_cast<double>(peak - movements.back().latest_peak) < gap) {
      movements.back().last = k - 1;
      movements.back().latest_peak = peak;
    } else {
      movements.push_back({first, k - 1, peak});
    }
  }
  return movements;
}

std::vector<char> FindRests(const std::vector<double>& speed, const MetricSettings& settings) {
  std::vector<char> is_resting(speed.size(), 0);
  const double shortest = settings.idle_duration * settings.sample_rate_hz;
  for (std::size_t k = 0; k < speed.size();) {
    std::size_t end = k;
    while (end < speed.size() && speed[end] < settings.idle_speed) ++end;
    if (static_cast<double>(end - k) >= shortest)
      for (std::size_t i = k; i < end; ++i) is_resting[i] = 1;
    k = std::max(end, k + 1);
  }
  return is_resting;
}

/// Everything that follows from tip and axis.
void MeasureTrack(MotionTrack& track, const MetricSettings& settings) {
  const double step = 1.0 / settings.sample_rate_hz;
  for (Vec3& axis : track.axis) axis = math::Normalized(axis);
  track.speed = CalcSpeed(track.tip, step);
  track.slow_speed = CalcSlowSpeed(track.tip, settings);
  track.tip_step = CalcSteps(track.tip, settings.noise_step, math::Distance);
  track.axis_step = CalcSteps(track.axis, settings.angle_noise_step, AngleBetween);
  track.is_resting = FindRests(track.slow_speed, settings);
  track.movements = FindMovements(track.speed, settings);
}

}  // namespace

MotionTrack MakeMotionTrack(std::span<const ToolSample> samples, double dt, const MetricSettings& settings) {
  MotionTrack track;
  const double cutoff_hz = settings.cutoff_hz, step = 1.0 / settings.sample_rate_hz;
  const auto tip_of = [](const ToolSample& s) { return s.tip; };
  track.tip = SmoothVector(samples, dt, settings, cutoff_hz, tip_of);
  track.axis = SmoothVector(samples, dt, settings, cutoff_hz, [](const ToolSample& s) { return s.axis; });
  track.insertion =
      SmoothSignal(samples, dt, settings, cutoff_hz, [](const ToolSample& s) { return s.insertion; });
  const std::vector<double> unwrapped = Unwrap(samples);
  const std::vector<double> spin =
      SmoothSignal(std::span(unwrapped), dt, settings, cutoff_hz, [](double angle) { return angle; });
  MeasureTrack(track, settings);
  const std::vector<Vec3> slow_tip = SmoothVector(samples, dt, settings, settings.jerk_cutoff_hz, tip_of);
  track.jerk_speed = CalcSpeed(slow_tip, step);
  track.squared_jerk = CalcSquaredJerk(slow_tip, step);
  track.depth_step = CalcSteps(track.insertion, settings.noise_step, CalcDifference);
  track.spin_step = CalcSteps(spin, settings.angle_noise_step, CalcDifference);
  return track;
}

MotionTrack MakeMotionTrack(std::span<const CameraSample> samples, double dt,
                            const MetricSettings& settings) {
  MotionTrack track;
  track.tip =
      SmoothVector(samples, dt, settings, settings.cutoff_hz, [](const CameraSample& s) { return s.lens; });
  track.axis = SmoothVector(samples, dt, settings, settings.cutoff_hz,
                            [](const CameraSample& s) { return s.direction; });
  MeasureTrack(track, settings);
  return track;
}

}  // namespace trocar::training
