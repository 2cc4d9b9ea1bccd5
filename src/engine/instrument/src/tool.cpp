// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/math/elementary.h"
namespace trocar::instrument {

using math::Vec3;

namespace {

// Sizes: domain facts, section 1.3
std::array<Tool, 7> MakeTools() {
  Tool dissector;
  dissector.name = "maryland", dissector.kind = ToolKind::kDissector;
  dissector.jaw_length = 0.019, dissector.jaw_width = 0.003, dissector.jaw_thickness = 0.0015;
  Tool hook;
  hook.name = "hook", hook.kind = ToolKind::kHook;
  hook.jaw_length = 0.005, hook.jaw_width = 0.0012, hook.jaw_thickness = 0.0012, hook.max_jaw = 0;
  Tool scissors;
  scissors.name = "scissors", scissors.kind = ToolKind::kScissors;
  scissors.jaw_length = 0.015, scissors.jaw_width = 0.002, scissors.jaw_thickness = 0.0012;
  Tool clip_applier;
  clip_applier.name = "clip_applier", clip_applier.kind = ToolKind::kClipApplier;
  clip_applier.shaft_radius = 0.005, clip_applier.jaw_length = 0.012, clip_applier.jaw_width = 0.002;
  clip_applier.max_jaw = 0.7, clip_applier.clips = 15;  // 6 mm between the tips
  Tool suction;
  suction.name = "suction_irrigator", suction.kind = ToolKind::kSuctionIrrigator;
  suction.jaw_length = 0.010, suction.jaw_width = 0.005, suction.jaw_thickness = 0.0025, suction.max_jaw = 0;
  Tool bag;
  bag.name = "bag", bag.kind = ToolKind::kBag;
  bag.shaft_radius = 0.005, bag.jaw_length = 0.020, bag.jaw_width = 0.008, bag.max_jaw = 0;
  return {Tool{}, dissector, hook, scissors, clip_applier, suction, bag};
}

}  // namespace

const Tool* FindTool(std::string_view name) noexcept {
  static const std::array<Tool, 7> tools = MakeTools();
  const auto found =
      std::find_if(tools.begin(), tools.end(), [&](const Tool& tool) { return tool.name == name; });
  return found == tools.end() ? nullptr : &*found;
}

Vec3 JawHinge(const Tool& tool) noexcept {
  return {0, 0, tool.jaw_length};
}

Vec3 JawTip(const Tool& tool, double jaw, int side) noexcept {
  jaw = std::min(jaw, tool.max_jaw);
  return JawHinge(tool) + tool.jaw_length * Vec3{0, side * math::Sin(0.5 * jaw), -math::Cos(0.5 * jaw)};
}

ToolCapsules CalcCapsules(const Tool& tool, double jaw, double shaft_reach) noexcept {
  const Vec3 hinge = JawHinge(tool);
  const double radius = 0.5 * tool.jaw_width;
  const double reach = std::clamp(shaft_reach, 0.0, tool.shaft_length - tool.jaw_length);
  return {{JawTip(tool, jaw, +1), hinge, radius},
          {JawTip(tool, jaw, -1), hinge, radius},
          {hinge, hinge + Vec3{0, 0, reach}, tool.shaft_radius}};
}

math::Pose CalcPartPose(const Tool& tool, ToolPart::Kind kind, double jaw) noexcept {
  const bool is_upper = kind == ToolPart::Kind::kUpperJaw || kind == ToolPart::Kind::kUpperClip;
  if (!is_upper && kind != ToolPart::Kind::kLowerJaw && kind != ToolPart::Kind::kLowerClip) return {};
  // about +x, the direction -z turns to +y
  const math::Quaternion turn =
      math::RotationAbout({1, 0, 0}, (is_upper ? 0.5 : -0.5) * std::min(jaw, tool.max_jaw));
  const Vec3 hinge = JawHinge(tool);
  return {turn, hinge - math::Rotate(turn, hinge)};
}

}  // namespace trocar::instrument
