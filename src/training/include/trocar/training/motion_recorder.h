// SPDX-License-Identifier: Apache-2.0
/// \file motion_recorder.h  What every tool did, tick by tick: the raw material of the metrics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::training {

using math::Vec3;

/// One tool at one tick.
struct ToolSample {
  Vec3 tip;                 ///< [m], world frame
  Vec3 axis{0, 0, -1};      ///< unit vector along the shaft, towards the tip
  double insertion = 0;     ///< depth along the shaft from the trocar [m]
  double jaw = 0;           ///< opening [rad]
  double spin = 0;          ///< about the shaft [rad]; may wrap
  double force = 0;         ///< magnitude on the tool [N], >= 0
  bool in_view = true;      ///< the tip lies inside the laparoscope's picture
  bool grasping = false;    ///< something is held
  bool in_contact = false;  ///< the tool touches tissue
};

enum class GraspEventKind : std::uint8_t {
  kAttempt,  ///< the jaws closed in order to grasp
  kSuccess,  ///< something was held after it
  kSlip,     ///< what was held slipped out, not let go on purpose
  kRelease   ///< what was held was let go
};

struct GraspEvent {
  std::uint64_t tick = 0;
  std::uint32_t tool = 0;  ///< index of the tool
  GraspEventKind kind = GraspEventKind::kAttempt;
};

/// A finished or running recording.
struct MotionRecording {
  double dt = 0;                               ///< time between ticks [s]
  std::vector<std::string> tool_names;         ///< (tools)
  std::vector<std::vector<ToolSample>> tools;  ///< (tools) of (ticks) each
  std::vector<GraspEvent> events;              ///< in order of time
  std::uint64_t held_ticks = 0;  ///< ticks in which a sample was not finite and the tool's last one was kept
  std::uint64_t dropped_ticks = 0;  ///< ticks, and events, not recorded: no room, or nothing finite yet

  std::size_t Ticks() const { return tools.empty() ? 0 : tools.front().size(); }
};

/// Settings of MotionRecorder.
struct RecorderSettings {
  double dt = 1.0 / 120.0;  ///< [s], > 0
  std::vector<std::string> tool_names = {"left", "right"};
  double reserve_seconds = 600.0;  ///< room made at the start [s], > 0
  std::size_t reserve_events = 4096;
};

/// Appends samples at a fixed step into room that was reserved before.
///
/// Inside a tick nothing is allocated: when the room is used up, ticks are dropped and counted. Outside of
/// ticks call Reserve() whenever SecondsLeft() runs low; 10 minutes of two tools at 120 Hz take about 14 MB.
class MotionRecorder {
 public:
  /// \pre dt > 0, reserve_seconds > 0 and at least one tool (TROCAR_ASSERT)
  /// \note Not real-time safe: allocates.
  explicit MotionRecorder(const RecorderSettings& settings = {});

  /// Records one tick, one sample per tool.
  /// \return false when the tick was dropped
  /// \pre samples.size() is the number of tools (TROCAR_ASSERT)
  /// \note Real-time safe: no allocation, lock or throw.
  bool Record(std::span<const ToolSample> samples) noexcept;

  /// Records an event of the tick that Record will append next.
  /// \return false when there was no room or no such tool
  /// \note Real-time safe: no allocation, lock or throw.
  bool RecordEvent(std::uint32_t tool, GraspEventKind kind) noexcept;

  /// Room that is left [s].
  /// \note Real-time safe.
  double SecondsLeft() const noexcept;

  /// Makes room for so many more seconds and events.
  /// \note Not real-time safe: allocates and copies.
  void Reserve(double seconds, std::size_t events);

  /// Forgets everything, keeps the room.
  /// \note Real-time safe: no allocation, lock or throw.
  void Clear() noexcept;

  const MotionRecording& Recording() const noexcept { return recording_; }

 private:
  MotionRecording recording_;
};

}  // namespace trocar::training
