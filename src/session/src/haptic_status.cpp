// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "trocar/session/haptic_loop.h"

namespace trocar::session {
namespace {

std::string DescribeHand(const HapticHandStatus& hand, const char* name) {
  char text[64];
  std::string line = name;
  if (hand.state == haptics::ArmState::kUnarmed) {
    const haptics::FaultEntry& fault = haptics::FindFault(hand.reason);
    line += " off";
    if (!fault.what.empty()) line += ": " + std::string(fault.what) + " (" + std::string(fault.remedy) + ")";
  } else {
    std::snprintf(text, sizeof text, " %s %.2f N", std::string(haptics::ArmStateName(hand.state)).c_str(),
                  hand.force);
    line += text;
  }
  if (hand.is_warm) line += ", motors warm";
  return line;
}

}  // namespace

std::string DescribeHaptics(const HapticStatus& status) {
  char text[96];
  std::snprintf(text, sizeof text, "Force %.0f Hz%s:", status.rate,
                status.is_real_time ? "" : " (not real-time)");
  std::string line = text;
  if (status.check_pose == haptics::CheckPoseState::kAsking) {
    line += std::string(" check pose: bring the ") + (status.asked == kLeft ? "left" : "right") +
            " device to its place and hold its button.";
  }
  if (status.check_pose == haptics::CheckPoseState::kWrongDevice)
    line += " check pose: another device answered, are they swapped?";
  const char* separator = " ";
  for (const Hand hand : {kLeft, kRight}) {
    if (!status.hands[hand].is_present) continue;
    line += separator + DescribeHand(status.hands[hand], hand == kLeft ? "left" : "right");
    separator = "; ";
  }
  return line;
}

HapticHand MakeHapticHand(const Scene& scene, const Pose& X_world_laparoscope, Hand hand, double scale) {
  const InstrumentSetup& setup = scene.instruments[hand];
  HapticHand made;
  made.hand = hand;
  made.p_world_port = setup.p_world_port;
  made.max_jaw = setup.tool.max_jaw;
  made.map.X_world_device = {X_world_laparoscope.rotation,
                             instrument::CalcToolPose(setup.p_world_port, setup.home).translation};
  made.map.force_scale = scale;
  return made;
}

}  // namespace trocar::session
