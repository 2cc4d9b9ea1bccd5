// SPDX-License-Identifier: Apache-2.0
#include "motion_log.h"

#include <algorithm>
#include <cmath>

namespace trocar::cli {
namespace {

using scene::EventKind;
using training::GraspEventKind;

training::RecorderSettings MakeSettings(const scene::Scene& scene, double seconds) {
  training::RecorderSettings settings;
  settings.dt = scene.tick_seconds;
  settings.tool_names = {"left", "right"};
  settings.reserve_seconds = seconds;
  return settings;
}

}  // namespace

MotionLog::MotionLog(const scene::Scene& scene, double seconds)
    : field_of_view_(scene.laparoscope.field_of_view), recorder_(MakeSettings(scene, seconds)) {
  times_.reserve(static_cast<std::size_t>(seconds / scene.tick_seconds) + 1);
}

void MotionLog::Record(const simulation::Snapshot& snapshot) {
  // events of this tick; the ring holds the newest only
  const auto ring = static_cast<std::uint64_t>(snapshot.events.size());
  for (std::uint64_t n =
           std::max(known_events_, snapshot.event_count > ring ? snapshot.event_count - ring : 0);
       n < snapshot.event_count; ++n) {
    const scene::Event& event = snapshot.events[n % ring];
    if (event.hand < 0) continue;
    const auto tool = static_cast<std::uint32_t>(event.hand);
    switch (event.kind) {
      case EventKind::kGrasp:
        recorder_.RecordEvent(tool, GraspEventKind::kAttempt);
        recorder_.RecordEvent(tool, GraspEventKind::kSuccess);
        break;
      case EventKind::kGraspMissed:
        recorder_.RecordEvent(tool, GraspEventKind::kAttempt);
        break;
      case EventKind::kSlip:
        recorder_.RecordEvent(tool, GraspEventKind::kSlip);
        break;
      case EventKind::kRelease:
        recorder_.RecordEvent(tool, GraspEventKind::kRelease);
        break;
      case EventKind::kStateRestored:
      case EventKind::kOrganFrozen:
      case EventKind::kTear:
      case EventKind::kPinchDamage:
      case EventKind::kToolsTouch:
      case EventKind::kExchangeRefused:
      case EventKind::kClipClosed:
      case EventKind::kTubeCut:
      case EventKind::kNoClipsLeft:
      case EventKind::kUsedOutside:
      case EventKind::kClipSlipped:
      case EventKind::kStoneSpilled:
      case EventKind::kStoneTaken:
      case EventKind::kStoneRetrieved:
      case EventKind::kOperationError:
        break;
    }
  }
  known_events_ = snapshot.event_count;

  std::array<training::ToolSample, scene::kHandCount> samples;
  for (std::size_t hand = 0; hand < samples.size(); ++hand) {
    const simulation::InstrumentSnapshot& instrument = snapshot.instruments[hand];
    training::ToolSample& sample = samples[hand];
    sample.tip = instrument.X_world_tool.translation;
    sample.axis = math::Rotate(instrument.X_world_tool.rotation, {0, 0, -1});
    sample.insertion = instrument.joints.depth;
    sample.jaw = instrument.joints.jaw;
    sample.spin = instrument.joints.spin;
    sample.force = math::Norm(instrument.force);
    sample.in_view = simulation::IsInView(snapshot.X_world_laparoscope, field_of_view_, sample.tip);
    sample.grasping = instrument.is_grasping;
    sample.in_contact = instrument.is_touching;
  }
  if (recorder_.Record(samples)) times_.push_back(snapshot.time);
}

}  // namespace trocar::cli
