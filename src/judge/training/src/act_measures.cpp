// SPDX-License-Identifier: Apache-2.0
#include "act_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace trocar::training {
namespace {

/// A state that begins above a limit and ends when the value has fallen well below it.
class Excess {
 public:
  Excess(double limit, double release) : limit_(limit), release_(release) {}
  /// \return whether one begins here
  bool Begins(double value) {
    if (!is_on_ && value > limit_) return is_on_ = true;
    if (value < release_) is_on_ = false;
    return false;
  }

 private:
  double limit_, release_;
  bool is_on_ = false;
};

struct TickSums {
  double out_of_view = 0, contact = 0, grasping = 0, force_excess = 0;   // s, N s
  double current = 0, pedal = 0, idle_pedal = 0, safe = 0, in_part = 0;  // s
  double max_force = 0, max_press = 0;                                   // N, m
  int out_of_view_count = 0, exceedances = 0, hard_contacts = 0, exchanges = 0;
  bool has_any = false;
  std::optional<double> duct_distance;  // least with current on [m]
};

/// What lasts until the next tick.
void AddHeldTick(const ToolSample& s, double dt, const MetricSettings& settings, TickSums& sums) {
  sums.in_part += dt;
  if (!s.in_view) sums.out_of_view += dt;
  if (s.in_contact) sums.contact += dt;
  if (s.grasping) sums.grasping += dt;
  sums.force_excess += std::max(0.0, s.force - settings.force_threshold) * dt;
  if (s.pedal || s.has_current) sums.pedal += dt;
  if (s.pedal && !s.has_current) sums.idle_pedal += dt;
  if (!s.has_current) return;
  sums.current += dt;
  const bool is_clear = s.duct_distance < 0.0 || s.duct_distance >= settings.safe_duct_distance;
  if (s.in_view && is_clear) sums.safe += dt;
}

TickSums SumTicks(const std::vector<ToolSample>& samples, double dt, const AttemptPart& part,
                  const MetricSettings& settings) {
  TickSums sums;
  Excess force(settings.force_threshold, settings.release_share * settings.force_threshold);
  Excess press(settings.hard_contact_depth, settings.release_share * settings.hard_contact_depth);
  bool was_in_view = true;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ToolSample& s = samples[i];
    const double pressed = s.in_contact && !s.grasping ? s.press : 0.0;
    // what begins has to be followed outside of the part, too
    const bool left_view = was_in_view && !s.in_view;
    const bool exceeds = force.Begins(s.force), presses = press.Begins(pressed);
    const bool is_exchanged = i > 0 && s.tool != samples[i - 1].tool;
    was_in_view = s.in_view;
    if (!part.has_tick[i]) continue;
    sums.has_any = true;
    sums.out_of_view_count += left_view;
    sums.exceedances += exceeds;
    sums.hard_contacts += presses;
    sums.exchanges += is_exchanged;
    sums.max_force = std::max(sums.max_force, s.force);
    sums.max_press = std::max(sums.max_press, pressed);
    if (s.has_current && s.duct_distance >= 0.0)
      sums.duct_distance = std::min(sums.duct_distance.value_or(s.duct_distance), s.duct_distance);
    if (i + 1 < samples.size()) AddHeldTick(s, dt, settings, sums);
  }
  return sums;
}

/// By kind and hand in a part. \param hand  -1 for any
int CountEvents(const AttemptTrace& trace, const AttemptPart& part, int hand, std::string_view kind) {
  return static_cast<int>(std::count_if(trace.events.begin(), trace.events.end(), [&](const AttemptEvent& e) {
    return e.kind == kind && (hand < 0 || e.hand == hand) && part.HasEvent(trace, e.time);
  }));
}

int CountRegrasps(const AttemptTrace& trace, const AttemptPart& part, int hand, double regrasp_time) {
  double let_go = -std::numeric_limits<double>::infinity();
  int count = 0;
  for (const AttemptEvent& event : trace.events) {
    if (event.hand != hand) continue;
    if (event.kind == "release" || event.kind == "slip") let_go = event.time;
    if (event.kind != "grasp") continue;
    if (event.time - let_go <= regrasp_time && part.HasEvent(trace, event.time)) ++count;
    let_go = -std::numeric_limits<double>::infinity();
  }
  return count;
}

/// What had run out until a time, between the samples along a straight line.
double FluidAt(const std::vector<FluidSample>& fluids, double FluidSample::*fluid, double time) {
  const auto after = std::find_if(fluids.begin(), fluids.end(),
                                  [&](const FluidSample& sample) { return sample.time >= time; });
  if (after == fluids.end()) return fluids.back().*fluid;
  if (after == fluids.begin()) return fluids.front().*fluid;
  const FluidSample &a = *(after - 1), &b = *after;
  return a.*fluid + (time - a.time) / (b.time - a.time) * (b.*fluid - a.*fluid);
}

double LostIn(const AttemptTrace& trace, const AttemptPart& part, double FluidSample::*fluid) {
  if (part.IsWhole()) return trace.fluids.back().*fluid - trace.fluids.front().*fluid;
  double lost = 0.0;
  for (const PhaseSpan& span : trace.phases) {
    if (span.name == part.phase)
      lost += FluidAt(trace.fluids, fluid, span.end) - FluidAt(trace.fluids, fluid, span.start);
  }
  return lost;
}

}  // namespace

void MeasureHandTicks(const AttemptTrace& trace, int hand, const AttemptPart& part,
                      const MetricSettings& settings, MetricList& list) {
  const TickSums sums = SumTicks(trace.hands[static_cast<std::size_t>(hand)], trace.dt, part, settings);
  if (!sums.has_any) return;
  const auto add = [&](std::string_view metric, const auto& value) {
    list.Add(metric, part, HandName(hand), value);
  };
  if (part.hand == hand) add("time", part.seconds);
  if (part.tool.empty()) add("tool_exchanges", sums.exchanges);
  add("out_of_view_count", sums.out_of_view_count);
  add("out_of_view_time", sums.out_of_view);
  if (sums.in_part > 0.0) add("out_of_view_fraction", sums.out_of_view / sums.in_part);
  add("contact_time", sums.contact);
  add("grasping_time", sums.grasping);
  add("max_force", sums.max_force);
  add("force_excess", sums.force_excess);
  add("force_exceedances", sums.exceedances);
  add("hard_contacts", sums.hard_contacts);
  add("hard_contact_depth", sums.max_press);
  if (!(sums.pedal > 0.0)) return;
  add("cautery_time", sums.current);
  add("cautery_without_contact", sums.idle_pedal);
  add("cautery_efficiency", sums.current / sums.pedal);
  if (sums.current > 0.0) add("safe_cautery", sums.safe / sums.current);
  add("cautery_duct_distance", sums.duct_distance);
}

void MeasureHandEvents(const AttemptTrace& trace, int hand, const AttemptPart& part,
                       const MetricSettings& settings, MetricList& list) {
  if (trace.Ticks() == 0) return;
  const auto add = [&](std::string_view metric, double value) {
    list.Add(metric, part, HandName(hand), value);
  };
  const int grasps = CountEvents(trace, part, hand, "grasp");
  const int attempts = grasps + CountEvents(trace, part, hand, "grasp_missed");
  add("grasp_attempts", attempts);
  add("grasp_successes", grasps);
  if (attempts > 0) add("grasp_efficiency", static_cast<double>(grasps) / attempts);
  add("grasp_slips", CountEvents(trace, part, hand, "slip"));
  add("regrasps", CountRegrasps(trace, part, hand, settings.regrasp_time));
  add("tears", CountEvents(trace, part, hand, "tear"));
  add("pinch_damages", CountEvents(trace, part, hand, "pinch_damage"));
}

void MeasureCollisions(const AttemptTrace& trace, const AttemptPart& part, const MetricSettings& settings,
                       MetricList& list) {
  if (trace.Ticks() == 0) return;
  std::optional<double> last;
  int count = 0;
  for (std::size_t i = 0; i < trace.Ticks(); ++i) {
    if (!trace.hands[0][i].touching_tool && !trace.hands[1][i].touching_tool) continue;
    const double time = static_cast<double>(i) * trace.dt;
    if ((!last || time - *last > settings.collision_gap) && part.has_tick[i]) ++count;
    last = time;
  }
  list.Add("instrument_collisions", part, "", count);
}

void MeasureErrors(const AttemptTrace& trace, const AttemptPart& part, MetricList& list) {
  if (!trace.is_operation && trace.goals.empty()) return;
  for (int hand = -1; hand < instrument::kHandCount; ++hand) {
    std::array<int, 3> of_severity{};
    int rules = 0;
    for (const AttemptEvent& event : trace.events) {
      if (!event.is_error || (hand >= 0 && event.hand != hand) || !part.HasEvent(trace, event.time)) continue;
      ++of_severity[static_cast<std::size_t>(event.severity)];
      rules += event.is_rule;
    }
    const std::string_view name = hand < 0 ? "" : HandName(hand);
    list.Add("errors", part, name, of_severity[0] + of_severity[1] + of_severity[2]);
    list.Add("errors_minor", part, name, of_severity[0]);
    list.Add("errors_major", part, name, of_severity[1]);
    list.Add("errors_critical", part, name, of_severity[2]);
    if (!trace.goals.empty()) list.Add("rules_broken", part, name, rules);
  }
}

void MeasureClips(const AttemptTrace& trace, const AttemptPart& part, MetricList& list) {
  if (!trace.is_operation && trace.clips.empty()) return;
  for (int hand = -1; hand < instrument::kHandCount; ++hand) {
    int placed = 0, lost = 0, misplaced = 0, measured = 0;
    double deviation = 0.0;
    std::optional<double> gap;
    for (const ClipRecord& clip : trace.clips) {
      if ((hand >= 0 && clip.hand != hand) || !part.HasEvent(trace, clip.time)) continue;
      placed += !clip.is_lost;
      lost += clip.is_lost;
      misplaced += !clip.is_lost && clip.is_misplaced;
      if (clip.gap) gap = std::min(gap.value_or(*clip.gap), *clip.gap);
      if (!clip.angle) continue;
      deviation += std::fabs(0.5 * std::numbers::pi - *clip.angle);
      ++measured;
    }
    const std::string_view name = hand < 0 ? "" : HandName(hand);
    list.Add("clips_placed", part, name, placed);
    list.Add("clips_lost", part, name, lost);
    list.Add("clips_misplaced", part, name, misplaced);
    list.Add("clip_gap", part, name, gap);
    if (measured > 0) list.Add("clip_angle_error", part, name, deviation / measured);
  }
}

void MeasureFluids(const AttemptTrace& trace, const AttemptPart& part, MetricList& list) {
  if (!trace.is_operation || trace.fluids.empty() || !part.tool.empty()) return;
  list.Add("blood_lost", part, "", LostIn(trace, part, &FluidSample::blood));
  list.Add("bile_spilled", part, "", LostIn(trace, part, &FluidSample::bile));
}

void MeasureOutcome(const AttemptTrace& trace, const AttemptPart& part, MetricList& list) {
  if (!part.IsWhole()) return;
  if (trace.is_operation) {
    list.Add("stones_spilled", part, "", trace.stones_spilled);
    list.Add("stones_lost", part, "", trace.stones_lost);
    list.Add("critical_view_time", part, "", trace.critical_view_time);
  }
  if (trace.goals.empty()) return;
  const auto done = std::count_if(trace.goals.begin(), trace.goals.end(),
                                  [](const GoalRecord& goal) { return goal.time.has_value(); });
  list.Add("goals_done", part, "", static_cast<double>(done));
  list.Add("goals_done_fraction", part, "",
           static_cast<double>(done) / static_cast<double>(trace.goals.size()));
  list.Add("task_time", part, "", trace.outcome.task_time);
  list.Add("score", part, "", trace.outcome.score);
}

}  // namespace trocar::training
