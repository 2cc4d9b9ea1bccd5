// SPDX-License-Identifier: Apache-2.0
#include "attempt_part.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "trocar/base/to_integer.h"

namespace trocar::training {
namespace {

/// Times of phases are multiples of the tick, give or take rounding [s].
constexpr double kTimeSlack = 1e-9;

/// Fills what follows from has_tick.
void CompletePart(AttemptPart& part, const AttemptTrace& trace, const MetricSettings& settings) {
  const std::size_t ticks = part.has_tick.size();
  const auto held = ticks > 0 ? std::count(part.has_tick.begin(), part.has_tick.end() - 1, 1) : 0;
  part.seconds = static_cast<double>(held) * trace.dt;
  if (ticks == 0) return;
  const double step = 1.0 / settings.sample_rate_hz;
  const auto count =
      base::FloorTo<std::size_t>(static_cast<double>(ticks - 1) * trace.dt / step + kTimeSlack) + 1;
  part.has_sample.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto tick = base::FloorTo<std::size_t>(static_cast<double>(k) * step / trace.dt + 0.5);
    part.has_sample[k] = part.has_tick[std::min(tick, ticks - 1)];
  }
}

void AddSpan(AttemptPart& part, const AttemptTrace& trace, const PhaseSpan& span) {
  const bool is_last = span.end >= trace.Seconds() - kTimeSlack;
  for (std::size_t i = 0; i < part.has_tick.size(); ++i) {
    const double time = static_cast<double>(i) * trace.dt;
    if (time >= span.start - kTimeSlack && (is_last || time < span.end - kTimeSlack)) part.has_tick[i] = 1;
  }
}

void AddPhases(const AttemptTrace& trace, std::vector<AttemptPart>& parts) {
  for (const PhaseSpan& span : trace.phases) {
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const AttemptPart& known) { return known.phase == span.name; });
    if (part == parts.end()) {
      parts.emplace_back();
      part = parts.end() - 1;
      part->phase = span.name;
      part->has_tick.assign(trace.Ticks(), 0);
    }
    AddSpan(*part, trace, span);
  }
}

void AddTools(const AttemptTrace& trace, std::vector<AttemptPart>& parts) {
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const std::vector<ToolSample>& samples = trace.hands[static_cast<std::size_t>(hand)];
    std::vector<std::int16_t> used;
    for (const ToolSample& sample : samples) {
      if (std::find(used.begin(), used.end(), sample.tool) == used.end()) used.push_back(sample.tool);
    }
    if (used.size() < 2) continue;
    for (const std::int16_t tool : used) {
      AttemptPart part;
      part.tool = trace.tool_names[static_cast<std::size_t>(tool)];
      part.hand = hand;
      for (const ToolSample& sample : samples) part.has_tick.push_back(sample.tool == tool);
      parts.push_back(std::move(part));
    }
  }
}

}  // namespace

bool AttemptPart::HasEvent(const AttemptTrace& trace, double time) const {
  if (has_tick.empty()) return false;
  const double tick =
      std::clamp(std::floor(time / trace.dt + 0.5), 0.0, static_cast<double>(has_tick.size() - 1));
  return has_tick[base::TruncateTo<std::size_t>(tick)] != 0;
}

std::vector<AttemptPart> FindParts(const AttemptTrace& trace, const MetricSettings& settings) {
  std::vector<AttemptPart> parts(1);
  parts[0].has_tick.assign(trace.Ticks(), 1);
  AddPhases(trace, parts);
  AddTools(trace, parts);
  std::erase_if(parts, [](const AttemptPart& part) {
    return !part.IsWhole() && std::find(part.has_tick.begin(), part.has_tick.end(), 1) == part.has_tick.end();
  });
  for (AttemptPart& part : parts) CompletePart(part, trace, settings);
  return parts;
}

std::string_view HandName(int hand) {
  return hand == instrument::kLeft ? "left" : "right";
}

}  // namespace trocar::training
