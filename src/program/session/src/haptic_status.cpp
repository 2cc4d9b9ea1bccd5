// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include "trocar/host/translate.h"
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

using instrument::Hand;
using instrument::kLeft;
using instrument::kRight;
using scene::InstrumentSetup;

namespace {

std::string DescribeHand(const HapticHandStatus& hand, const char* name) {
  char text[64];
  std::string line = host::Translate(name);
  if (hand.state == haptics::ArmState::kUnarmed) {
    const haptics::FaultEntry& fault = haptics::FindFault(hand.reason);
    line += host::Translate(" off");
    if (!fault.what.empty())
      line += ": " + host::Translate(fault.what) + " (" + host::Translate(fault.remedy) + ")";
  } else {
    std::snprintf(text, sizeof text, " %.2f N", hand.force);
    line += " " + host::Translate(haptics::ArmStateName(hand.state)) + host::LocalNumber(text);
  }
  if (hand.is_warm) line += host::Translate(", motors warm");
  return line;
}

}  // namespace

std::string DescribeHaptics(const HapticStatus& status) {
  const std::string rate = std::to_string(std::lround(status.rate));
  std::string line = host::TranslateWith(
      status.is_real_time ? host::Mark("Force {1} Hz:") : host::Mark("Force {1} Hz (not real-time):"),
      {rate});
  if (status.check_pose == haptics::CheckPoseState::kAsking) {
    line += status.asked == kLeft
                ? host::Translate(" check pose: bring the left device to its place and hold its button.")
                : host::Translate(" check pose: bring the right device to its place and hold its button.");
  }
  if (status.check_pose == haptics::CheckPoseState::kWrongDevice)
    line += host::Translate(" check pose: another device answered, are they swapped?");
  const HapticHandStatus &left = status.hands[kLeft], &right = status.hands[kRight];
  const bool are_alike = left.is_present && right.is_present && left.state == haptics::ArmState::kUnarmed &&
                         right.state == left.state && right.reason == left.reason &&
                         right.is_warm == left.is_warm;
  if (are_alike) return line + " " + DescribeHand(left, host::Mark("both"));
  const char* separator = " ";
  for (const Hand hand : {kLeft, kRight}) {
    if (!status.hands[hand].is_present) continue;
    line += separator +
            DescribeHand(status.hands[hand], hand == kLeft ? host::Mark("left") : host::Mark("right"));
    separator = "; ";
  }
  return line;
}

std::string FormatHapticsJson(const HapticStatus& status) {
  char text[512];
  std::snprintf(
      text, sizeof text,
      "{\"ticks\": %llu, \"late_ticks\": %llu, \"overruns\": %llu, \"rate\": %.1f, \"period_p50_us\": %.0f, "
      "\"period_p99.9_us\": %.0f, \"period_max_us\": %.0f, \"tick_cpu_p99.9_us\": %.0f, \"real_time\": %s, "
      "\"supervised\": %s",
      static_cast<unsigned long long>(status.ticks), static_cast<unsigned long long>(status.late_ticks),
      static_cast<unsigned long long>(status.overruns), status.rate, 1e6 * status.period_p50,
      1e6 * status.period_p999, 1e6 * status.period_max, 1e6 * status.cpu_p999,
      status.is_real_time ? "true" : "false", status.is_supervised ? "true" : "false");
  std::string json = text;
  for (const Hand side : {kLeft, kRight}) {
    const HapticHandStatus& hand = status.hands[side];
    if (!hand.is_present) continue;
    const haptics::FaultEntry& fault = haptics::FindFault(hand.reason);
    std::snprintf(text, sizeof text,
                  ", \"%s\": {\"state\": \"%s\", \"reason\": \"%s\", \"code\": \"%s\", \"force\": %.4f, "
                  "\"heat\": %.4f, "
                  "\"warm\": %s, \"bad_samples\": %llu, \"jumps\": %llu, \"silences\": %llu}",
                  side == kLeft ? "left" : "right", std::string(haptics::ArmStateName(hand.state)).c_str(),
                  std::string(fault.name).c_str(), std::string(base::CodeText(fault.code)).c_str(),
                  hand.force, hand.heat, hand.is_warm ? "true" : "false",
                  static_cast<unsigned long long>(hand.counts.bad),
                  static_cast<unsigned long long>(hand.counts.jumps),
                  static_cast<unsigned long long>(hand.counts.silences));
    json += text;
  }
  return json + "}";
}

base::Result<HapticLoopSettings> MakeHapticSettings(const device::ForceDriver& driver,
                                                    const scene::Scene& scene,
                                                    const math::Pose& X_world_laparoscope,
                                                    const device::ButtonMap& buttons) {
  const int channels = driver.GetChannelCount();
  if (channels > instrument::kHandCount) {
    return base::Error{base::ErrorCode::kDeviceSettings,
                       driver.GetName() + " has more channels than a person has hands"};
  }
  HapticLoopSettings settings;
  settings.supervisor = SupervisorLink::FindProgram();
  settings.buttons = buttons;
  for (int channel = 0; channel < channels; ++channel) {
    const Hand hand = channels == 1 || channel == 1 ? kRight : kLeft;
    settings.hands.push_back(MakeHapticHand(scene, X_world_laparoscope, hand));
  }
  return settings;
}

HapticHand MakeHapticHand(const scene::Scene& scene, const math::Pose& X_world_laparoscope, Hand hand,
                          double scale) {
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
