// SPDX-License-Identifier: Apache-2.0
#include <cstdarg>
#include <cstdio>

#include "trocar/session/haptic_record.h"

namespace trocar::session {

using instrument::kLeft;

namespace {

using haptics::Fault;

constexpr const char* kHandNames[instrument::kHandCount] = {"left", "right"};

__attribute__((format(printf, 1, 2))) std::string Format(const char* format, ...) {
  char text[320];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

unsigned long long Wide(std::uint64_t number) {
  return number;
}

const char* YesOrNo(bool is_true) {
  return is_true ? "true" : "false";
}

std::string ReasonJson(const char* key, Fault reason) {
  const haptics::FaultEntry& fault = haptics::FindFault(reason);
  return std::string(", \"") + key + "\": \"" + std::string(fault.name) + "\", \"" + key + "_code\": \"" +
         std::string(base::CodeText(fault.code)) + "\"";
}

std::string HandJson(const HapticHandSummary& hand) {
  return Format("{\"armed_s\": %.2f", hand.armed_time) +
         ReasonJson("not_armed_longest", hand.longest_reason) +
         ReasonJson("not_armed_at_the_end", hand.last_reason) +
         Format(
             ", \"clamped_ticks\": %llu, \"max_force\": %.3f, \"max_heat\": %.3f, \"times_warm\": %llu, "
             "\"times_lost\": %llu, \"bad_samples\": %llu, \"jumps\": %llu}",
             Wide(hand.clamped_ticks), hand.max_force, hand.max_heat, Wide(hand.times_warm),
             Wide(hand.times_lost), Wide(hand.bad_samples), Wide(hand.jumps));
}

std::string DescribeHand(const HapticHandSummary& hand) {
  std::string text = Format("force for %.1f s, at most %.2f N, %llu ticks held to the device's largest",
                            hand.armed_time, hand.max_force, Wide(hand.clamped_ticks));
  if (hand.longest_reason != Fault::kNone)
    text += "; most of the time without force because " +
            std::string(haptics::FindFault(hand.longest_reason).what);
  if (hand.last_reason != Fault::kNone && hand.last_reason != hand.longest_reason)
    text += ", at the end because " + std::string(haptics::FindFault(hand.last_reason).what);
  text += Format("; motors warm %llu times, device lost %llu times, %llu reports dropped",
                 Wide(hand.times_warm), Wide(hand.times_lost), Wide(hand.bad_samples + hand.jumps));
  return text;
}

}  // namespace

std::string FormatSummaryJson(const HapticSummary& summary) {
  std::string json = Format(
      "{\"seconds\": %.2f, \"ticks\": %llu, \"late_ticks\": %llu, \"overruns\": %llu, \"rate\": %.1f, "
      "\"lowest_rate\": %.1f, \"period_max_us\": %.0f, \"tick_cpu_max_us\": %.0f, \"real_time\": %s, "
      "\"supervised\": %s",
      summary.seconds, Wide(summary.ticks), Wide(summary.late_ticks), Wide(summary.overruns), summary.rate,
      summary.lowest_rate, 1e6 * summary.period_max, 1e6 * summary.cpu_max, YesOrNo(summary.is_real_time),
      YesOrNo(summary.is_supervised));
  for (const instrument::Hand hand : {kLeft, instrument::kRight}) {
    if (!summary.hands[hand].is_present) continue;
    json += std::string(", \"") + kHandNames[hand] + "\": " + HandJson(summary.hands[hand]);
  }
  return json + "}";
}

std::vector<std::array<std::string, 2>> DescribeSummary(const HapticSummary& summary) {
  std::vector<std::array<std::string, 2>> rows = {
      {"Loop", Format("%.0f ticks a second over %.1f s, %.0f in the worst second", summary.rate,
                      summary.seconds, summary.lowest_rate)},
      {"Worst tick", Format("%.2f ms after the one before it; %.0f us of processor time the most",
                            1e3 * summary.period_max, 1e6 * summary.cpu_max)},
      {"Late", Format("%llu ticks by more than half a period, %llu so late that the force had to go",
                      Wide(summary.late_ticks), Wide(summary.overruns))},
      {"Guards", std::string(summary.is_supervised ? "supervised" : "no supervisor, so no force") +
                     (summary.is_real_time ? ", real-time priority" : ", no real-time priority")}};
  for (const instrument::Hand hand : {kLeft, instrument::kRight}) {
    if (summary.hands[hand].is_present)
      rows.push_back({hand == kLeft ? "Left hand" : "Right hand", DescribeHand(summary.hands[hand])});
  }
  return rows;
}

}  // namespace trocar::session
