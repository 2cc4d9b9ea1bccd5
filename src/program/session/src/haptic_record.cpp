// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_record.h"

#include <algorithm>
#include <cstdio>

namespace trocar::session {

using instrument::kHandCount;

namespace {

using haptics::ArmState;
using haptics::Fault;

constexpr const char* kHandNames[kHandCount] = {"left", "right"};

void Append(std::string& json, const char* format, auto... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  json += text;
}

}  // namespace

std::string_view HapticEventName(HapticEventKind kind) noexcept {
  switch (kind) {
    case HapticEventKind::kArmed:
      return "armed";
    case HapticEventKind::kUnarmed:
      return "unarmed";
    case HapticEventKind::kLost:
      return "lost";
    case HapticEventKind::kBack:
      return "back";
    case HapticEventKind::kWarm:
      return "warm";
    case HapticEventKind::kCool:
      return "cool";
    case HapticEventKind::kConfirmed:
      return "confirmed";
    case HapticEventKind::kUnwatched:
      return "unwatched";
    case HapticEventKind::kWatched:
      return "watched";
    case HapticEventKind::kOverrun:
      return "overrun";
    case HapticEventKind::kBadSamples:
      return "bad_samples";
  }
  return "unknown";
}

void HapticRecord::Note(double time, HapticEventKind kind, int hand, Fault reason, std::uint64_t count) {
  if (events_.size() == kMaxEvents) {
    ++left_out_;
    return;
  }
  events_.push_back({time, kind, hand, reason, count});
}

void HapticRecord::NoteHand(double time, int hand, const HapticHandStatus& before,
                            const HapticHandStatus& now) {
  if (!now.is_present) return;
  const bool was_off = before.state == ArmState::kUnarmed, is_off = now.state == ArmState::kUnarmed;
  const bool was_lost = before.reason == Fault::kDeviceLost, is_lost = now.reason == Fault::kDeviceLost;
  if (is_lost && !was_lost) Note(time, HapticEventKind::kLost, hand, now.reason);
  if (was_lost && !is_lost) Note(time, HapticEventKind::kBack, hand);
  if (was_off && !is_off) Note(time, HapticEventKind::kArmed, hand);
  if (!was_off && is_off) Note(time, HapticEventKind::kUnarmed, hand, now.reason);
  if (now.is_warm != before.is_warm)
    Note(time, now.is_warm ? HapticEventKind::kWarm : HapticEventKind::kCool, hand);
  const std::uint64_t bad = now.counts.bad + now.counts.jumps;
  const std::uint64_t bad_before = before.counts.bad + before.counts.jumps;
  if (bad > bad_before) Note(time, HapticEventKind::kBadSamples, hand, Fault::kNone, bad - bad_before);
}

/// Adds what cannot be told from the first and the last status alone.
void HapticRecord::Sum(double time, const HapticStatus& status) {
  if (!has_last_) {
    first_ = status;
    first_time_ = last_time_ = time;
  }
  const double passed = time - last_time_;
  last_time_ = time;
  summary_.period_max = std::max(summary_.period_max, status.period_max);
  summary_.cpu_max = std::max(summary_.cpu_max, status.cpu_max);
  const bool has_rate = status.rate > 0;  // from the end of the first second on
  if (has_rate && (summary_.lowest_rate == 0 || status.rate < summary_.lowest_rate))
    summary_.lowest_rate = status.rate;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const HapticHandStatus& now = status.hands[hand];
    HapticHandSummary& sum = summary_.hands[hand];
    sum.max_heat = std::max(sum.max_heat, now.heat);
    if (now.is_warm && !(has_last_ && last_.hands[hand].is_warm)) ++sum.times_warm;
    const bool was_lost = has_last_ && last_.hands[hand].reason == Fault::kDeviceLost;
    if (now.is_present && now.reason == Fault::kDeviceLost && !was_lost) ++sum.times_lost;
    if (now.state == ArmState::kUnarmed) off_time_[hand][static_cast<std::size_t>(now.reason)] += passed;
  }
}

HapticSummary HapticRecord::CalcSummary() const {
  HapticSummary summary = summary_;
  if (!has_last_) return summary;
  summary.seconds = last_time_ - first_time_;
  summary.ticks = last_.ticks;
  summary.late_ticks = last_.late_ticks;
  summary.overruns = last_.overruns;
  const auto ticks = static_cast<double>(last_.ticks - first_.ticks);
  if (summary.seconds > 0) summary.rate = ticks / summary.seconds;
  summary.is_real_time = last_.is_real_time;
  summary.is_supervised = last_.is_supervised;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const HapticHandStatus& last = last_.hands[hand];
    HapticHandSummary& sum = summary.hands[hand];
    sum.is_present = last.is_present;
    const auto armed = static_cast<double>(last.armed_ticks - first_.hands[hand].armed_ticks);
    if (ticks > 0) sum.armed_time = armed / ticks * summary.seconds;
    sum.clamped_ticks = last.clamped_ticks;
    sum.max_force = last.max_force;
    sum.bad_samples = last.counts.bad;
    sum.jumps = last.counts.jumps;
    sum.last_reason = last.state == ArmState::kUnarmed ? last.reason : Fault::kNone;
    const auto longest = std::max_element(off_time_[hand].begin(), off_time_[hand].end());
    if (*longest > 0) sum.longest_reason = static_cast<Fault>(longest - off_time_[hand].begin());
  }
  return summary;
}

void HapticRecord::Add(double time, const HapticStatus& status) {
  if (has_last_ && status.ticks == last_.ticks) return;
  if (!has_last_) last_.is_supervised = status.is_supervised;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const HapticHandStatus fresh;
    NoteHand(time, hand, has_last_ ? last_.hands[hand] : fresh, status.hands[hand]);
  }
  if (status.check_pose != last_.check_pose && status.check_pose == haptics::CheckPoseState::kConfirmed)
    Note(time, HapticEventKind::kConfirmed, -1);
  if (status.is_supervised != last_.is_supervised)
    Note(time, status.is_supervised ? HapticEventKind::kWatched : HapticEventKind::kUnwatched, -1);
  if (status.overruns > last_.overruns)
    Note(time, HapticEventKind::kOverrun, -1, Fault::kOverrun, status.overruns - last_.overruns);
  Sum(time, status);
  last_ = status;
  has_last_ = true;
  constexpr double kRounding = 1e-6;  // of times that are sums [s]
  if (time < next_ - kRounding) return;
  next_ = time + period_;
  if (samples_.size() == kMaxSamples) {
    for (std::size_t i = 0; i < kMaxSamples / 2; ++i) samples_[i] = samples_[2 * i];
    samples_.resize(kMaxSamples / 2);
    period_ *= 2;
  }
  Sample& sample = samples_.emplace_back();
  sample.time = time;
  sample.rate = static_cast<float>(status.rate);
  sample.period_p50 = static_cast<float>(status.period_p50);
  sample.period_p999 = static_cast<float>(status.period_p999);
  sample.period_max = static_cast<float>(status.period_max);
  sample.cpu_p999 = static_cast<float>(status.cpu_p999);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const HapticHandStatus& from = status.hands[hand];
    sample.hands[hand] = {from.state, static_cast<float>(from.force), static_cast<float>(from.heat)};
  }
}

std::string HapticRecord::FormatJson() const {
  std::string json = "{\"samples\": [";
  for (const Sample& sample : samples_) {
    Append(json,
           "%s\n  {\"time\": %.3f, \"rate\": %.1f, \"period_p50_us\": %.0f, \"period_p99.9_us\": %.0f, "
           "\"period_max_us\": %.0f, \"tick_cpu_p99.9_us\": %.0f",
           &sample == samples_.data() ? "" : ",", sample.time, sample.rate, 1e6 * sample.period_p50,
           1e6 * sample.period_p999, 1e6 * sample.period_max, 1e6 * sample.cpu_p999);
    for (int hand = 0; hand < kHandCount; ++hand) {
      if (!last_.hands[hand].is_present) continue;
      Append(json, ", \"%s\": {\"state\": \"%s\", \"force\": %.4f, \"heat\": %.4f}", kHandNames[hand],
             std::string(ArmStateName(sample.hands[hand].state)).c_str(), sample.hands[hand].force,
             sample.hands[hand].heat);
    }
    json += "}";
  }
  json += "],\n \"events\": [";
  for (const HapticEvent& event : events_) {
    Append(json, "%s\n  {\"time\": %.3f, \"event\": \"%s\"", &event == events_.data() ? "" : ",", event.time,
           std::string(HapticEventName(event.kind)).c_str());
    if (event.hand >= 0) Append(json, ", \"hand\": \"%s\"", kHandNames[event.hand]);
    if (event.reason != Fault::kNone) {
      const haptics::FaultEntry& fault = haptics::FindFault(event.reason);
      Append(json, ", \"reason\": \"%s\", \"code\": \"%s\"", std::string(fault.name).c_str(),
             std::string(base::CodeText(fault.code)).c_str());
    }
    if (event.count > 1) Append(json, ", \"count\": %llu", static_cast<unsigned long long>(event.count));
    json += "}";
  }
  Append(json, "],\n \"events_left_out\": %llu", static_cast<unsigned long long>(left_out_));
  if (has_last_) {
    json += ",\n \"last\": " + FormatHapticsJson(last_);
    json += ",\n \"summary\": " + FormatSummaryJson(CalcSummary());
  }
  return json + "}\n";
}

}  // namespace trocar::session
