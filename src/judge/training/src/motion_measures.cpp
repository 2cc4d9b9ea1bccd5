// SPDX-License-Identifier: Apache-2.0
#include "motion_measures.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "trocar/math/elementary.h"
#include "trocar/training/smoothness.h"

namespace trocar::training {

using math::Vec3;

namespace {

using math::Atan2;
using math::Cbrt;

/// A spread of speed below it is that of a still hand [m/s].
constexpr double kConstantSpeed = 1e-3;
/// Sine of the angle below which two directions are one [-].
constexpr double kParallel = 1e-6;

double SumOf(const std::vector<double>& values, const std::vector<char>& is_in) {
  double sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_in[k]) sum += values[k];
  }
  return sum;
}

/// Mean of the values that exist; nothing if none does.
class OptionalMean {
 public:
  void Add(const std::optional<double>& value) {
    if (value) sum_ += *value, ++count_;
  }
  std::optional<double> Get() const { return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

class SeenRange {
 public:
  void Add(double value) {
    least_ = is_empty_ ? value : std::min(least_, value);
    most_ = is_empty_ ? value : std::max(most_, value);
    is_empty_ = false;
  }
  double Width() const { return most_ - least_; }

 private:
  double least_ = 0.0, most_ = 0.0;
  bool is_empty_ = true;
};

/// The space that the shaft swept, as angles about its mean direction over the whole attempt.
void MeasureSpace(const MotionTrack& track, const AttemptPart& part, std::string_view hand,
                  MetricList& list) {
  Vec3 sum;
  for (const Vec3& axis : track.axis) sum = sum + axis;
  const double norm = math::Norm(sum);
  if (!(norm > kParallel * static_cast<double>(track.axis.size()))) return;
  const Vec3 mean = sum / norm;
  Vec3 across = Vec3{1, 0, 0} - mean.x * mean;
  if (math::Norm(across) < kParallel) across = Vec3{0, 1, 0} - mean.y * mean;
  across = across / math::Norm(across);
  const Vec3 along = math::Cross(mean, across);
  SeenRange left_right, up_down, depth;
  for (std::size_t k = 0; k < track.Size(); ++k) {
    if (!part.has_sample[k]) continue;
    const double ahead = math::Dot(track.axis[k], mean);
    left_right.Add(Atan2(math::Dot(track.axis[k], across), ahead));
    up_down.Add(Atan2(math::Dot(track.axis[k], along), ahead));
    depth.Add(track.insertion[k]);
  }
  const double area = left_right.Width() * up_down.Width();
  list.Add("angular_area", part, hand, std::sqrt(area));
  list.Add("angular_volume", part, hand, Cbrt(area * depth.Width()));
}

void MeasureMovements(const MotionTrack& track, const AttemptPart& part, std::string_view hand,
                      const MetricSettings& settings, MetricList& list) {
  OptionalMean sparc, jerk, log_jerk;
  double straight = 0.0, path = 0.0;
  int count = 0;
  for (const Movement& movement : track.movements) {
    if (!part.has_sample[movement.first]) continue;
    ++count;
    const std::size_t length = movement.last - movement.first + 1;
    const auto profile = std::span(track.speed).subspan(movement.first, length);
    sparc.Add(CalcSparc(profile, settings.sample_rate_hz, settings.sparc));
    const auto slow_profile = std::span(track.jerk_speed).subspan(movement.first, length);
    jerk.Add(CalcDimensionlessJerk(slow_profile, settings.sample_rate_hz));
    log_jerk.Add(CalcLogDimensionlessJerk(slow_profile, settings.sample_rate_hz));
    straight += math::Distance(track.tip[movement.first], track.tip[movement.last]);
    for (std::size_t k = movement.first; k < movement.last; ++k)
      path += math::Distance(track.tip[k], track.tip[k + 1]);
  }
  if (path > 0.0) list.Add("movement_straightness", part, hand, straight / path);
  list.Add("movements", part, hand, count);
  list.Add("sparc", part, hand, sparc.Get());
  list.Add("dimensionless_jerk", part, hand, jerk.Get());
  list.Add("log_dimensionless_jerk", part, hand, log_jerk.Get());
}

std::optional<double> CalcCorrelation(const std::vector<double>& a, const std::vector<double>& b,
                                      const std::vector<char>& is_in) {
  double n = 0.0, mean_a = 0.0, mean_b = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (is_in[k]) n += 1.0, mean_a += a[k], mean_b += b[k];
  }
  if (n == 0.0) return std::nullopt;
  mean_a /= n, mean_b /= n;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!is_in[k]) continue;
    const double da = a[k] - mean_a, db = b[k] - mean_b;
    aa += da * da, bb += db * db, ab += da * db;
  }
  if (!(std::min(aa, bb) > n * kConstantSpeed * kConstantSpeed)) return std::nullopt;
  return std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
}

}  // namespace

void MeasureHandMotion(const MotionTrack& track, const std::optional<double>& ideal_path,
                       const AttemptPart& part, std::string_view hand, const MetricSettings& settings,
                       MetricList& list) {
  if (track.Size() == 0) return;
  const double path = SumOf(track.tip_step, part.has_sample);
  list.Add("path_length", part, hand, path);
  if (ideal_path && part.IsWhole() && path > 0.0)
    list.Add("economy_of_motion", part, hand, *ideal_path / path);
  list.Add("depth_path", part, hand, SumOf(track.depth_step, part.has_sample));
  const double spin = SumOf(track.spin_step, part.has_sample);
  list.Add("angular_path", part, hand, SumOf(track.axis_step, part.has_sample) + spin);
  list.Add("spin_path", part, hand, spin);
  MeasureSpace(track, part, hand, list);
  MeasureMovements(track, part, hand, settings, list);
  if (!(part.seconds > 0.0)) return;
  list.Add("mean_speed", part, hand, path / part.seconds);
  double fastest = 0.0, samples = 0.0, resting = 0.0;
  for (std::size_t k = 0; k < track.Size(); ++k) {
    if (!part.has_sample[k]) continue;
    fastest = std::max(fastest, track.speed[k]);
    samples += 1.0;
    resting += track.is_resting[k];
  }
  if (samples > 0.0) {
    list.Add("max_speed", part, hand, fastest);
    list.Add("idle_fraction", part, hand, resting / samples);
  }
  if (path > 0.0) {
    const double jerk = SumOf(track.squared_jerk, part.has_sample) / settings.sample_rate_hz;
    const double square = part.seconds * part.seconds;
    list.Add("motion_smoothness", part, hand,
             std::sqrt(square * square * part.seconds / (2.0 * path * path) * jerk));
  }
}

void MeasurePlainPath(std::span<const ToolSample> samples, const std::optional<double>& ideal_path,
                      const AttemptPart& part, std::string_view hand, MetricList& list) {
  double path = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (part.has_tick[i]) path += math::Distance(samples[i - 1].tip, samples[i].tip);
  }
  list.Add("path_sum", part, hand, path);
  if (ideal_path && part.IsWhole() && path > 0.0) list.Add("economy_sum", part, hand, *ideal_path / path);
}

void MeasureBimanual(const MotionTrack& left, const MotionTrack& right, const AttemptPart& part,
                     const MetricSettings& settings, MetricList& list) {
  if (!(part.seconds > 0.0)) return;
  double samples = 0.0, both = 0.0;
  for (std::size_t k = 0; k < left.Size(); ++k) {
    if (!part.has_sample[k]) continue;
    samples += 1.0;
    both += left.slow_speed[k] >= settings.idle_speed && right.slow_speed[k] >= settings.idle_speed;
  }
  if (samples == 0.0) return;
  list.Add("bimanual_fraction", part, "", both / samples);
  list.Add("bimanual_correlation", part, "", CalcCorrelation(left.speed, right.speed, part.has_sample));
}

void MeasureCamera(const MotionTrack& track, const AttemptTrace& trace, const AttemptPart& part,
                   MetricList& list) {
  if (track.Size() == 0) return;
  list.Add("path_length", part, "camera", SumOf(track.tip_step, part.has_sample));
  list.Add("view_angular_path", part, "camera", SumOf(track.axis_step, part.has_sample));
  double ticks = 0.0, sum = 0.0, most = 0.0, path = 0.0;
  for (std::size_t i = 0; i < trace.camera.size(); ++i) {
    if (!part.has_tick[i]) continue;
    if (i > 0) path += math::Distance(trace.camera[i - 1].lens, trace.camera[i].lens);
    const double roll = std::fabs(trace.camera[i].roll);
    ticks += 1.0, sum += roll, most = std::max(most, roll);
  }
  list.Add("path_sum", part, "camera", path);
  if (ticks == 0.0) return;
  list.Add("view_roll_mean", part, "camera", sum / ticks);
  list.Add("view_roll_max", part, "camera", most);
}

}  // namespace trocar::training
