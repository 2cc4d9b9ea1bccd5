// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::instrument {

using math::Vec3;

namespace {

/// A kind of tool: what it can do, and its usual sizes (domain facts, section 1.3).
struct Row {
  ToolAbilities can;
  Tool tool;
};

std::vector<Row> MakeRows() {
  Row grasper;
  grasper.can.takes = true;
  Row dissector;
  dissector.can.takes = dissector.can.spreads = true, dissector.can.electrode = Electrode::kJaws;
  dissector.can.pedals.cut = dissector.can.pedals.coagulate = true;
  dissector.tool.name = "maryland", dissector.tool.kind = ToolKind::kDissector;
  dissector.tool.jaw_length = 0.019, dissector.tool.jaw_width = 0.003, dissector.tool.jaw_thickness = 0.0015;
  Row hook;
  hook.can.electrode = Electrode::kToe, hook.can.blade = Blade::kHeel;
  hook.can.pedals.cut = hook.can.pedals.coagulate = true;
  hook.tool.name = "hook", hook.tool.kind = ToolKind::kHook;
  hook.tool.jaw_length = 0.005, hook.tool.jaw_width = hook.tool.jaw_thickness = 0.0012, hook.tool.max_jaw = 0;
  Row scissors;
  scissors.can.bites = true, scissors.can.blade = Blade::kJaws;
  scissors.tool.name = "scissors", scissors.tool.kind = ToolKind::kScissors;
  scissors.tool.jaw_length = 0.015, scissors.tool.jaw_width = 0.002, scissors.tool.jaw_thickness = 0.0012;
  Row clips;
  clips.can.bites = clips.can.holds_clips = true;
  clips.tool.name = "clip_applier", clips.tool.kind = ToolKind::kClipApplier;
  clips.tool.shaft_radius = 0.005, clips.tool.jaw_length = 0.012, clips.tool.jaw_width = 0.002;
  clips.tool.max_jaw = 0.7, clips.tool.clips = 15;  // 6 mm between the tips
  Row suction;
  suction.can.sucks = suction.can.pedals.rinse = suction.can.pedals.aspirate = true;
  suction.tool.name = "suction_irrigator", suction.tool.kind = ToolKind::kSuctionIrrigator;
  suction.tool.jaw_length = 0.010, suction.tool.jaw_width = 0.005, suction.tool.jaw_thickness = 0.0025;
  suction.tool.max_jaw = 0;
  Row bag;
  bag.can.is_bag = true;
  bag.tool.name = "bag", bag.tool.kind = ToolKind::kBag;
  bag.tool.shaft_radius = 0.005, bag.tool.jaw_length = 0.020, bag.tool.jaw_width = 0.008,
  bag.tool.max_jaw = 0;
  // 45 mm cartridges, of which one is fired before the tool has to come out
  Row stapler;
  stapler.can.bites = stapler.can.staples = stapler.can.pedals.cut = true;
  stapler.tool.name = "linear_stapler", stapler.tool.kind = ToolKind::kLinearStapler;
  stapler.tool.shaft_radius = 0.006, stapler.tool.jaw_length = 0.045, stapler.tool.jaw_width = 0.008;
  stapler.tool.jaw_thickness = 0.004, stapler.tool.max_jaw = 0.5, stapler.tool.clips = 1;
  return {grasper, dissector, hook, scissors, clips, suction, bag, stapler};
}

const std::vector<Row>& Rows() {
  static const std::vector<Row> rows = MakeRows();
  return rows;
}

}  // namespace

const ToolAbilities& AbilitiesOf(ToolKind kind) noexcept {
  return Rows()[static_cast<std::size_t>(kind)].can;
}

std::span<const Tool> AllTools() noexcept {
  static const std::vector<Tool> tools = [] {
    std::vector<Tool> made;
    for (const Row& row : Rows()) made.push_back(row.tool);
    return made;
  }();
  return tools;
}

const Tool* FindTool(std::string_view name) noexcept {
  const auto tools = AllTools();
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
