// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/attempt_metrics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "act_measures.h"
#include "attempt_part.h"
#include "motion_measures.h"
#include "motion_track.h"
#include "trocar/base/assert.h"
#include "trocar/host/csv_field.h"
#include "trocar/training/metric_definition.h"

namespace trocar::training {
namespace {

base::Error RefuseMetrics(const std::string& what) {
  return {base::ErrorCode::kNumberNotFinite, "metrics cannot be computed: " + what};
}

bool IsPositive(double x) {
  return std::isfinite(x) && x > 0.0;
}
bool IsNotNegative(double x) {
  return std::isfinite(x) && x >= 0.0;
}

base::Status CheckSettings(const MetricSettings& settings) {
  if (!IsPositive(settings.sample_rate_hz)) return RefuseMetrics("sample_rate_hz must be greater than 0");
  if (!IsPositive(settings.cutoff_hz)) return RefuseMetrics("cutoff_hz must be greater than 0");
  if (!IsPositive(settings.jerk_cutoff_hz)) return RefuseMetrics("jerk_cutoff_hz must be greater than 0");
  if (!IsPositive(settings.idle_window)) return RefuseMetrics("idle_window must be greater than 0");
  if (!(settings.release_share > 0.0 && settings.release_share <= 1.0))
    return RefuseMetrics("release_share must lie in (0, 1]");
  if (!(settings.movement_end_speed <= settings.movement_start_speed))
    return RefuseMetrics("movement_end_speed must not exceed movement_start_speed");
  for (const double x : {settings.noise_step, settings.angle_noise_step, settings.movement_start_speed,
                         settings.movement_end_speed, settings.movement_gap, settings.idle_speed,
                         settings.idle_duration, settings.force_threshold, settings.hard_contact_depth,
                         settings.regrasp_time, settings.collision_gap, settings.safe_duct_distance}) {
    if (!IsNotNegative(x))
      return RefuseMetrics(
          "noise steps, speeds, durations, distances and the force threshold must be at least 0");
  }
  if (settings.sparc.pad_level < 0 || settings.sparc.pad_level > kMaxPadLevel ||
      !IsPositive(settings.sparc.cutoff_hz) || !IsNotNegative(settings.sparc.amplitude_limit))
    return RefuseMetrics(
        "SPARC needs a pad level of 0 to 6, a cutoff greater than 0 and a limit of at least 0");
  return {};
}

bool IsSound(const ToolSample& s, const AttemptTrace& trace) {
  const bool is_finite = math::IsFinite(s.tip) && math::IsFinite(s.axis) && std::isfinite(s.insertion) &&
                         std::isfinite(s.spin) && std::isfinite(s.jaw) && std::isfinite(s.duct_distance);
  const bool has_tool = s.tool >= 0 && (static_cast<std::size_t>(s.tool) < trace.tool_names.size() ||
                                        (s.tool == 0 && trace.tool_names.empty()));
  return is_finite && IsNotNegative(s.force) && IsNotNegative(s.press) && has_tool;
}

base::Status CheckTrace(const AttemptTrace& trace) {
  if (!IsPositive(trace.dt)) return RefuseMetrics("the time between ticks must be greater than 0 s");
  for (const auto& hand : trace.hands) {
    if (hand.size() != trace.Ticks()) return RefuseMetrics("the hands have different numbers of ticks");
    if (!std::all_of(hand.begin(), hand.end(), [&](const ToolSample& s) { return IsSound(s, trace); }))
      return RefuseMetrics("a sample is not finite, a force or a depth is negative, or a tool has no name");
  }
  if (!trace.camera.empty() && trace.camera.size() != trace.Ticks())
    return RefuseMetrics("the laparoscope has another number of ticks than the hands");
  for (const CameraSample& s : trace.camera) {
    if (!math::IsFinite(s.lens) || !math::IsFinite(s.direction) || !std::isfinite(s.roll))
      return RefuseMetrics("a sample of the laparoscope is not finite");
  }
  for (const AttemptEvent& event : trace.events) {
    if (!std::isfinite(event.time)) return RefuseMetrics("the time of an event is not finite");
  }
  for (const std::optional<double>& ideal : trace.ideal_path) {
    if (ideal && !IsPositive(*ideal)) return RefuseMetrics("an ideal path must be longer than 0 m");
  }
  for (const PhaseSpan& span : trace.phases) {
    if (!std::isfinite(span.start) || !std::isfinite(span.end) || span.name.empty())
      return RefuseMetrics("a phase has no name or no time");
  }
  return {};
}

/// Definitions first, then as measured: whole, phases, tools.
void SortByDefinition(std::vector<MetricValue>& values) {
  std::unordered_map<std::string_view, std::size_t> place;
  for (const MetricDefinition& definition : MetricDefinitions()) place.emplace(definition.id, place.size());
  for (const MetricValue& value : values) TROCAR_ASSERT(place.contains(value.metric));
  std::stable_sort(values.begin(), values.end(), [&](const MetricValue& a, const MetricValue& b) {
    return place.at(a.metric) < place.at(b.metric);
  });
}

std::string UnitOf(const MetricValue& value) {
  const MetricDefinition* definition = FindMetric(value.metric);
  return definition != nullptr ? definition->unit : "";
}

}  // namespace

base::Result<AttemptMetrics> CalcAttemptMetrics(const AttemptTrace& trace, const MetricSettings& settings) {
  if (const auto status = CheckSettings(settings); !status.ok()) return status.error();
  if (const auto status = CheckTrace(trace); !status.ok()) return status.error();
  std::vector<MotionTrack> tracks;
  for (const auto& hand : trace.hands) tracks.push_back(MakeMotionTrack(hand, trace.dt, settings));
  const MotionTrack camera = MakeMotionTrack(trace.camera, trace.dt, settings);
  MetricList list;
  for (const AttemptPart& part : FindParts(trace, settings)) {
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      if (part.hand >= 0 && part.hand != hand) continue;
      const auto h = static_cast<std::size_t>(hand);
      // whoever stopped half way has not gone the whole path
      const auto ideal_path = trace.outcome.is_completed ? trace.ideal_path[h] : std::nullopt;
      MeasureHandMotion(tracks[h], ideal_path, part, HandName(hand), settings, list);
      MeasureHandTicks(trace, hand, part, settings, list);
      MeasureHandEvents(trace, hand, part, settings, list);
    }
    if (part.hand >= 0) continue;
    list.Add("time", part, "", part.seconds);
    MeasureBimanual(tracks[0], tracks[1], part, settings, list);
    MeasureCamera(camera, trace, part, list);
    MeasureCollisions(trace, part, settings, list);
    MeasureErrors(trace, part, list);
    MeasureClips(trace, part, list);
    MeasureFluids(trace, part, list);
    MeasureOutcome(trace, part, list);
  }
  AttemptMetrics metrics{list.Take()};
  // what overflowed is undefined, too
  std::erase_if(metrics.values, [](const MetricValue& value) { return !std::isfinite(value.value); });
  SortByDefinition(metrics.values);
  return metrics;
}

std::string FormatMetricsJson(const AttemptMetrics& metrics) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const MetricValue& value : metrics.values) {
    nlohmann::ordered_json entry = {{"metric", value.metric}};
    if (!value.hand.empty()) entry["hand"] = value.hand;
    if (!value.phase.empty()) entry["phase"] = value.phase;
    if (!value.tool.empty()) entry["tool"] = value.tool;
    entry["value"] = value.value;
    entry["unit"] = UnitOf(value);
    list.push_back(std::move(entry));
  }
  // names that are not UTF-8 are mended rather than thrown about
  return list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string FormatMetricsCsv(const AttemptMetrics& metrics) {
  std::string text = "metric,hand,phase,tool,value,unit\n";
  for (const MetricValue& value : metrics.values) {
    text += value.metric + "," + value.hand + "," + host::FormatCsvField(value.phase) + "," +
            host::FormatCsvField(value.tool) + "," + nlohmann::ordered_json(value.value).dump() + "," +
            UnitOf(value) + "\n";
  }
  return text;
}

}  // namespace trocar::training
