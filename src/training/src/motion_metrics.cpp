// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/motion_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "trocar/training/signal.h"

namespace trocar::training {
namespace {

/// One tool's motion at the even rate, filtered.
struct Track {
  std::vector<Vec3> tip;          // m
  std::vector<Vec3> axis;         // unit
  std::vector<double> insertion;  // m
  std::vector<double> spin;       // rad, unwrapped
  std::vector<double> speed;      // m/s, of the tip
};

/// Samples [first, last] of a track.
struct Movement {
  std::size_t first, last;
  std::size_t latest_peak;
};

template <typename Get>
std::vector<double> Smooth(const std::vector<ToolSample>& samples, double dt, const MetricSettings& settings,
                           Get&& get) {
  std::vector<double> raw;
  raw.reserve(samples.size());
  for (const ToolSample& sample : samples) raw.push_back(get(sample));
  const double step = 1.0 / settings.sample_rate_hz;
  return FilterLowPass(ResampleEvenly(raw, dt, step), step, settings.cutoff_hz);
}

std::vector<Vec3> Join(const std::vector<double>& x, const std::vector<double>& y,
                       const std::vector<double>& z) {
  std::vector<Vec3> joined(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) joined[i] = {x[i], y[i], z[i]};
  return joined;
}

Track MakeTrack(const std::vector<ToolSample>& samples, double dt, const MetricSettings& settings) {
  const auto smooth = [&](auto&& get) { return Smooth(samples, dt, settings, get); };
  Track track;
  track.tip = Join(smooth([](const ToolSample& s) { return s.tip.x; }),
                   smooth([](const ToolSample& s) { return s.tip.y; }),
                   smooth([](const ToolSample& s) { return s.tip.z; }));
  track.axis = Join(smooth([](const ToolSample& s) { return s.axis.x; }),
                    smooth([](const ToolSample& s) { return s.axis.y; }),
                    smooth([](const ToolSample& s) { return s.axis.z; }));
  for (Vec3& axis : track.axis) axis = math::Normalized(axis);
  track.insertion = smooth([](const ToolSample& s) { return s.insertion; });
  double turns = 0.0, before = samples.empty() ? 0.0 : samples.front().spin;
  track.spin = smooth([&](const ToolSample& s) {
    const double change = s.spin - before;
    turns -= std::round(change / (2.0 * std::numbers::pi));
    before = s.spin;
    return s.spin + 2.0 * std::numbers::pi * turns;
  });

  const double step = 1.0 / settings.sample_rate_hz;
  std::array<std::vector<double>, 3> v;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> x(track.tip.size());
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = track.tip[k][i];
    v[i] = Differentiate(x, step);
  }
  track.speed.resize(track.tip.size());
  for (std::size_t k = 0; k < track.speed.size(); ++k)
    track.speed[k] = math::Norm(Vec3{v[0][k], v[1][k], v[2][k]});
  return track;
}

/// Sum of the steps between values; a value counts only when it is at least `noise` away from the last that
/// counted.
template <typename T, typename CalcDistance>
double CalcPath(const std::vector<T>& values, double noise, CalcDistance&& calc_distance) {
  if (values.empty()) return 0.0;
  double path = 0.0;
  T last = values.front();
  for (const T& value : values) {
    const double distance = calc_distance(last, value);
    if (distance < noise || distance == 0.0) continue;
    path += distance;
    last = value;
  }
  return path;
}

double CalcAngle(const Vec3& a, const Vec3& b) {
  return std::atan2(math::Norm(math::Cross(a, b)), math::Dot(a, b));
}
double CalcDifference(double a, double b) {
  return std::fabs(a - b);
}

/// Integral of |x'''|^2 dt by central third differences [m^2/s^5].
double IntegrateSquaredJerk(const std::vector<Vec3>& x, double step) {
  double sum = 0.0;
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    const Vec3 jerk = (x[k + 2] - 2.0 * x[k + 1] + 2.0 * x[k - 1] - x[k - 2]) / (2.0 * step * step * step);
    sum += math::SquaredNorm(jerk);
  }
  return sum * step;
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

double CalcIdleFraction(const std::vector<double>& speed, const MetricSettings& settings) {
  const double shortest = settings.idle_duration * settings.sample_rate_hz;
  std::size_t idle = 0;
  for (std::size_t k = 0; k < speed.size();) {
    std::size_t end = k;
    while (end < speed.size() && speed[end] < settings.idle_speed) ++end;
    if (end > k && static_cast<double>(end - k) >= shortest) idle += end - k;
    k = std::max(end, k + 1);
  }
  return static_cast<double>(idle) / static_cast<double>(speed.size());
}

/// What comes from the recorded ticks: view, contact, grasps and forces.
void MeasureTicks(const std::vector<ToolSample>& samples, double dt, const MetricSettings& settings,
                  MotionMetrics& metrics) {
  bool was_in_view = true, above = false;
  for (const ToolSample& sample : samples) {
    if (!sample.in_view) metrics.out_of_view_time += dt;
    if (was_in_view && !sample.in_view) ++metrics.out_of_view_count;
    was_in_view = sample.in_view;
    if (sample.in_contact) metrics.contact_time += dt;
    if (sample.grasping) metrics.grasping_time += dt;
    metrics.max_force = std::max(metrics.max_force, sample.force);
    metrics.force_excess += std::max(0.0, sample.force - settings.force_threshold) * dt;
    if (!above && sample.force > settings.force_threshold) {
      above = true;
      ++metrics.force_exceedances;
    } else if (sample.force < settings.force_release * settings.force_threshold) {
      above = false;
    }
  }
}

void CountGrasps(std::span<const GraspEvent> events, std::uint32_t tool, MotionMetrics& metrics) {
  for (const GraspEvent& event : events) {
    if (event.tool != tool) continue;
    metrics.grasp_attempts += event.kind == GraspEventKind::kAttempt;
    metrics.grasp_successes += event.kind == GraspEventKind::kSuccess;
    metrics.grasp_slips += event.kind == GraspEventKind::kSlip;
  }
  if (metrics.grasp_attempts > 0) {
    metrics.grasp_efficiency = static_cast<double>(metrics.grasp_successes) / metrics.grasp_attempts;
  }
}

void MeasureMotion(const Track& track, const std::optional<double>& ideal, const MetricSettings& settings,
                   MotionMetrics& metrics) {
  const double step = 1.0 / settings.sample_rate_hz;
  metrics.path_length = CalcPath(track.tip, settings.noise_step, math::Distance);
  metrics.depth_path = CalcPath(track.insertion, settings.noise_step, CalcDifference);
  metrics.spin_path = CalcPath(track.spin, settings.angle_noise_step, CalcDifference);
  metrics.angular_path = CalcPath(track.axis, settings.angle_noise_step, CalcAngle) + metrics.spin_path;
  if (metrics.path_length > 0.0) {
    if (ideal) metrics.economy_of_motion = *ideal / metrics.path_length;
    if (metrics.time > 0.0) {
      const double t2 = metrics.time * metrics.time;
      metrics.motion_smoothness =
          std::sqrt(t2 * t2 * metrics.time / (2.0 * metrics.path_length * metrics.path_length) *
                    IntegrateSquaredJerk(track.tip, step));
    }
  }
  if (metrics.time > 0.0) {
    metrics.mean_speed = metrics.path_length / metrics.time;
    metrics.max_speed = *std::max_element(track.speed.begin(), track.speed.end());
    metrics.idle_fraction = CalcIdleFraction(track.speed, settings);
  }

  const std::vector<Movement> movements = FindMovements(track.speed, settings);
  metrics.movements = static_cast<int>(movements.size());
  OptionalMean sparc, jerk, log_jerk;
  for (const Movement& movement : movements) {
    const auto profile = std::span(track.speed).subspan(movement.first, movement.last - movement.first + 1);
    sparc.Add(CalcSparc(profile, settings.sample_rate_hz, settings.sparc));
    jerk.Add(CalcDimensionlessJerk(profile, settings.sample_rate_hz));
    log_jerk.Add(CalcLogDimensionlessJerk(profile, settings.sample_rate_hz));
  }
  metrics.sparc = sparc.Get();
  metrics.dimensionless_jerk = jerk.Get();
  metrics.log_dimensionless_jerk = log_jerk.Get();
}

std::optional<double> CalcCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double mean_a = 0.0, mean_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) mean_a += a[k] / n, mean_b += b[k] / n;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double da = a[k] - mean_a, db = b[k] - mean_b;
    aa += da * da, bb += db * db, ab += da * db;
  }
  // a spread below a micrometre a second is rounding, not motion
  constexpr double kConstantSpeed = 1e-6;
  if (!(aa > n * kConstantSpeed * kConstantSpeed) || !(bb > n * kConstantSpeed * kConstantSpeed))
    return std::nullopt;
  return std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
}

core::Status CheckInput(const MotionRecording& recording, const MetricSettings& settings) {
  const auto fail = [](const std::string& what) {
    return core::Error{core::ErrorCode::kNumberNotFinite, "metrics cannot be computed: " + what};
  };
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  const auto not_negative = [](double x) { return std::isfinite(x) && x >= 0.0; };
  if (!positive(recording.dt)) return fail("the time between ticks must be greater than 0 s");
  if (!positive(settings.sample_rate_hz)) return fail("sample_rate_hz must be greater than 0");
  if (!positive(settings.cutoff_hz)) return fail("cutoff_hz must be greater than 0");
  if (!(settings.force_release > 0.0 && settings.force_release <= 1.0))
    return fail("force_release must lie in (0, 1]");
  if (!(settings.movement_end_speed <= settings.movement_start_speed)) {
    return fail("movement_end_speed must not exceed movement_start_speed");
  }
  for (const double x : {settings.noise_step, settings.angle_noise_step, settings.movement_start_speed,
                         settings.movement_end_speed, settings.movement_gap, settings.idle_speed,
                         settings.idle_duration, settings.force_threshold}) {
    if (!not_negative(x))
      return fail("noise steps, speeds, durations and the force threshold must be at least 0");
  }
  if (settings.sparc.pad_level < 0 || settings.sparc.pad_level > kMaxPadLevel ||
      !positive(settings.sparc.cutoff_hz) || !not_negative(settings.sparc.amplitude_limit)) {
    return fail("SPARC needs a pad level of 0 to 6, a cutoff greater than 0 and a limit of at least 0");
  }
  for (const std::optional<double>& ideal : settings.ideal_path_lengths) {
    if (ideal && !positive(*ideal)) return fail("an ideal path length must be greater than 0 m");
  }
  for (const std::vector<ToolSample>& tool : recording.tools) {
    if (tool.size() != recording.Ticks()) return fail("the tools have different numbers of ticks");
    for (const ToolSample& s : tool) {
      if (!math::IsFinite(s.tip) || !math::IsFinite(s.axis) || !std::isfinite(s.insertion) ||
          !std::isfinite(s.spin) || !std::isfinite(s.jaw) || !std::isfinite(s.force)) {
        return fail(
            "a recorded sample is not finite; record with MotionRecorder, which holds the last good one");
      }
    }
  }
  return {};
}

}  // namespace

core::Result<SessionMetrics> CalcSessionMetrics(const MotionRecording& recording,
                                                const MetricSettings& settings) {
  if (core::Status status = CheckInput(recording, settings); !status.ok()) return status.error();
  SessionMetrics session;
  session.held_ticks = recording.held_ticks;
  session.dropped_ticks = recording.dropped_ticks;
  session.time = recording.Ticks() > 1 ? static_cast<double>(recording.Ticks() - 1) * recording.dt : 0.0;
  std::vector<Track> tracks;
  for (std::uint32_t tool = 0; tool < recording.tools.size(); ++tool) {
    MotionMetrics metrics;
    metrics.tool =
        tool < recording.tool_names.size() ? recording.tool_names[tool] : "tool " + std::to_string(tool + 1);
    metrics.time = session.time;
    tracks.push_back(MakeTrack(recording.tools[tool], recording.dt, settings));
    if (recording.Ticks() > 0) {
      const bool given = tool < settings.ideal_path_lengths.size();
      MeasureMotion(tracks.back(), given ? settings.ideal_path_lengths[tool] : std::nullopt, settings,
                    metrics);
    }
    MeasureTicks(recording.tools[tool], recording.dt, settings, metrics);
    CountGrasps(recording.events, tool, metrics);
    session.tools.push_back(std::move(metrics));
  }

  if (tracks.size() >= 2 && session.time > 0.0) {
    const std::vector<double>&a = tracks[0].speed, &b = tracks[1].speed;
    std::size_t both = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      both += a[k] >= settings.idle_speed && b[k] >= settings.idle_speed;
    session.bimanual_fraction = static_cast<double>(both) / static_cast<double>(a.size());
    session.bimanual_correlation = CalcCorrelation(a, b);
  }
  return session;
}

std::string_view MetricsDisclaimer() noexcept {
  return "training feedback, not certified assessment";
}

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillimetres = 1000.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;

Json Number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json Number(const std::optional<double>& value, double scale = 1.0) {
  return value ? Number(*value * scale) : Json(nullptr);
}

/// A definition and how to read its value.
struct SessionRow {
  MetricDefinition definition;
  Json (*get)(const SessionMetrics&);
};
struct ToolRow {
  MetricDefinition definition;
  Json (*get)(const MotionMetrics&);
};

constexpr auto kHigher = BetterWhen::kHigher;
constexpr auto kLower = BetterWhen::kLower;
constexpr auto kNeither = BetterWhen::kNeither;

const SessionRow kSessionRows[] = {
    {{"time_s", "s", "Duration of the recording.", kLower, "common", false},
     [](const SessionMetrics& m) { return Number(m.time); }},
    {{"held_ticks", "-", "Ticks in which a tool's reading was not finite and its last one was kept.", kLower,
      "Trocar", false},
     [](const SessionMetrics& m) { return Json(m.held_ticks); }},
    {{"dropped_ticks", "-", "Ticks and events that were not recorded.", kLower, "Trocar", false},
     [](const SessionMetrics& m) { return Json(m.dropped_ticks); }},
    {{"bimanual_fraction", "-", "Part of the time in which both tools move.", kHigher, "Hofstad et al. 2013",
      false},
     [](const SessionMetrics& m) { return Number(m.bimanual_fraction); }},
    {{"bimanual_correlation", "-", "Correlation of the two tools' speeds.", kHigher, "Hofstad et al. 2013",
      false},
     [](const SessionMetrics& m) { return Number(m.bimanual_correlation); }},
};

const ToolRow kToolRows[] = {
    {{"path_length_mm", "mm", "Length of the tip's path.", kLower, "Chmarra et al. 2008", true},
     [](const MotionMetrics& m) { return Number(m.path_length * kMillimetres); }},
    {{"economy_of_motion", "-",
      "Shortest path divided by the path taken; retracting before advancing lowers it and is not wrong.",
      kHigher, "Chmarra et al. 2008", true},
     [](const MotionMetrics& m) { return Number(m.economy_of_motion); }},
    {{"depth_path_mm", "mm", "Depth perception: distance travelled along the shaft, in and out.", kLower,
      "Oropesa et al. 2013", true},
     [](const MotionMetrics& m) { return Number(m.depth_path * kMillimetres); }},
    {{"angular_path_deg", "deg", "Sum of the shaft's changes of direction and of spin.", kLower, "LapSim",
      true},
     [](const MotionMetrics& m) { return Number(m.angular_path * kDegrees); }},
    {{"spin_path_deg", "deg", "Sum of the changes of spin about the shaft.", kLower, "LapSim", true},
     [](const MotionMetrics& m) { return Number(m.spin_path * kDegrees); }},
    {{"mean_speed_mm_s", "mm/s", "Path length divided by time.", kNeither, "Oropesa et al. 2013", true},
     [](const MotionMetrics& m) { return Number(m.mean_speed, kMillimetres); }},
    {{"max_speed_mm_s", "mm/s", "Highest speed of the tip.", kLower, "Trocar", true},
     [](const MotionMetrics& m) { return Number(m.max_speed, kMillimetres); }},
    {{"motion_smoothness", "-", "Integrated squared jerk, normalised by duration and path length.", kLower,
      "Oropesa et al. 2013", true},
     [](const MotionMetrics& m) { return Number(m.motion_smoothness); }},
    {{"movements", "-", "Number of separate movements.", kLower, "Oropesa et al. 2013", true},
     [](const MotionMetrics& m) { return Json(m.movements); }},
    {{"sparc", "-", "Spectral arc length of the speed, mean of the movements; closer to zero is smoother.",
      kHigher, "Balasubramanian et al. 2015", true},
     [](const MotionMetrics& m) { return Number(m.sparc); }},
    {{"dimensionless_jerk", "-",
      "Dimensionless jerk of the speed, mean of the movements; closer to zero is smoother.", kHigher,
      "Balasubramanian et al. 2015", true},
     [](const MotionMetrics& m) { return Number(m.dimensionless_jerk); }},
    {{"log_dimensionless_jerk", "-",
      "Logarithm of the dimensionless jerk, mean of the movements; higher is smoother.", kHigher,
      "Balasubramanian et al. 2015", true},
     [](const MotionMetrics& m) { return Number(m.log_dimensionless_jerk); }},
    {{"idle_fraction", "-", "Part of the time at rest, in rests of half a second or more.", kLower,
      "Oropesa et al. 2013", true},
     [](const MotionMetrics& m) { return Number(m.idle_fraction); }},
    {{"out_of_view_count", "-", "Times that the tip was moved out of the picture.", kLower, "common", true},
     [](const MotionMetrics& m) { return Json(m.out_of_view_count); }},
    {{"out_of_view_time_s", "s", "Time with the tip out of the picture.", kLower, "common", true},
     [](const MotionMetrics& m) { return Number(m.out_of_view_time); }},
    {{"contact_time_s", "s", "Time in touch with tissue.", kNeither, "Trocar", true},
     [](const MotionMetrics& m) { return Number(m.contact_time); }},
    {{"grasping_time_s", "s", "Time with something held.", kNeither, "Trocar", true},
     [](const MotionMetrics& m) { return Number(m.grasping_time); }},
    {{"grasp_attempts", "-", "Times that the jaws were closed in order to grasp.", kLower, "common", true},
     [](const MotionMetrics& m) { return Json(m.grasp_attempts); }},
    {{"grasp_successes", "-", "Times that something was held after it.", kNeither, "common", true},
     [](const MotionMetrics& m) { return Json(m.grasp_successes); }},
    {{"grasp_slips", "-", "Times that what was held slipped out.", kLower, "common", true},
     [](const MotionMetrics& m) { return Json(m.grasp_slips); }},
    {{"grasp_efficiency", "-", "Successful grasps divided by attempts.", kHigher, "common", true},
     [](const MotionMetrics& m) { return Number(m.grasp_efficiency); }},
    {{"max_force_n", "N", "Greatest force on the tool.", kLower, "Golahmadi et al. 2021", true},
     [](const MotionMetrics& m) { return Number(m.max_force); }},
    {{"force_excess_n_s", "N s", "Integral over time of the force above the threshold.", kLower,
      "Golahmadi et al. 2021", true},
     [](const MotionMetrics& m) { return Number(m.force_excess); }},
    {{"force_exceedances", "-", "Times that the force rose above the threshold.", kLower,
      "Golahmadi et al. 2021", true},
     [](const MotionMetrics& m) { return Json(m.force_exceedances); }},
};

constexpr std::size_t kDefinitionCount = std::size(kSessionRows) + std::size(kToolRows);

}  // namespace

std::span<const MetricDefinition> MetricDefinitions() noexcept {
  static const std::array<MetricDefinition, kDefinitionCount> definitions = [] {
    std::array<MetricDefinition, kDefinitionCount> all{};
    std::size_t i = 0;
    for (const SessionRow& row : kSessionRows) all[i++] = row.definition;
    for (const ToolRow& row : kToolRows) all[i++] = row.definition;
    return all;
  }();
  return definitions;
}

std::string FormatMetricsJson(const SessionMetrics& metrics) {
  Json json;
  json["disclaimer"] = MetricsDisclaimer();
  for (const SessionRow& row : kSessionRows) json[std::string(row.definition.name)] = row.get(metrics);
  json["tools"] = Json::array();
  for (const MotionMetrics& tool : metrics.tools) {
    Json entry;
    entry["tool"] = tool.tool;
    for (const ToolRow& row : kToolRows) entry[std::string(row.definition.name)] = row.get(tool);
    json["tools"].push_back(std::move(entry));
  }
  // names that are not UTF-8 are mended rather than thrown about
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace trocar::training
