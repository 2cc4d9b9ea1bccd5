// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/motion_recorder.h"

#include <algorithm>
#include <cmath>

#include "trocar/core/assert.h"

namespace trocar::training {
namespace {

bool IsFinite(const ToolSample& s) {
  return math::IsFinite(s.tip) && math::IsFinite(s.axis) && std::isfinite(s.insertion) &&
         std::isfinite(s.jaw) && std::isfinite(s.spin) && std::isfinite(s.force);
}

}  // namespace

MotionRecorder::MotionRecorder(const RecorderSettings& settings) {
  TROCAR_ASSERT(settings.dt > 0.0 && settings.reserve_seconds > 0.0 && !settings.tool_names.empty());
  recording_.dt = settings.dt;
  recording_.tool_names = settings.tool_names;
  recording_.tools.resize(settings.tool_names.size());
  Reserve(settings.reserve_seconds, settings.reserve_events);
}

bool MotionRecorder::Record(std::span<const ToolSample> samples) noexcept {
  TROCAR_ASSERT(samples.size() == recording_.tools.size());
  bool all_finite = true;
  for (const ToolSample& sample : samples) all_finite = all_finite && IsFinite(sample);
  const bool first = recording_.Ticks() == 0;
  for (const std::vector<ToolSample>& tool : recording_.tools) {
    if (tool.size() == tool.capacity() || (first && !all_finite)) {
      ++recording_.dropped_ticks;
      return false;
    }
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::vector<ToolSample>& tool = recording_.tools[i];
    tool.push_back(IsFinite(samples[i]) ? samples[i] : ToolSample(tool.back()));
  }
  if (!all_finite) ++recording_.held_ticks;
  return true;
}

bool MotionRecorder::RecordEvent(std::uint32_t tool, GraspEventKind kind) noexcept {
  if (tool >= recording_.tools.size() || recording_.events.size() == recording_.events.capacity()) {
    ++recording_.dropped_ticks;
    return false;
  }
  recording_.events.push_back({recording_.Ticks(), tool, kind});
  return true;
}

double MotionRecorder::SecondsLeft() const noexcept {
  std::size_t room = recording_.tools.front().capacity() - recording_.tools.front().size();
  for (const std::vector<ToolSample>& tool : recording_.tools)
    room = std::min(room, tool.capacity() - tool.size());
  return static_cast<double>(room) * recording_.dt;
}

void MotionRecorder::Reserve(double seconds, std::size_t events) {
  const auto ticks = static_cast<std::size_t>(std::ceil(seconds / recording_.dt));
  for (std::vector<ToolSample>& tool : recording_.tools) tool.reserve(tool.size() + ticks);
  recording_.events.reserve(recording_.events.size() + events);
}

void MotionRecorder::Clear() noexcept {
  for (std::vector<ToolSample>& tool : recording_.tools) tool.clear();
  recording_.events.clear();
  recording_.held_ticks = recording_.dropped_ticks = 0;
}

}  // namespace trocar::training
