// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/tool.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/geometry/tube.h"

namespace trocar::instrument {
namespace {

/// Closed loft through rectangular sections along z: half width (x) and y from `low` to `high` at each
/// section.
struct Section {
  double z, half_width, low, high;
};

geometry::TriangleMesh MakeLoft(const std::vector<Section>& sections) {
  geometry::TriangleMesh mesh;
  for (const Section& s : sections) {
    mesh.positions.insert(mesh.positions.end(), {{-s.half_width, s.low, s.z},
                                                 {s.half_width, s.low, s.z},
                                                 {s.half_width, s.high, s.z},
                                                 {-s.half_width, s.high, s.z}});
  }
  const auto count = static_cast<std::uint32_t>(sections.size());
  for (std::uint32_t ring = 0; ring + 1 < count; ++ring) {
    for (std::uint32_t side = 0; side < 4; ++side) {
      const std::uint32_t next = (side + 1) % 4, low = 4 * ring, high = low + 4;
      mesh.triangles.push_back({low + side, low + next, high + next});
      mesh.triangles.push_back({low + side, high + next, high + side});
    }
  }
  const std::uint32_t last = 4 * (count - 1);
  mesh.triangles.insert(mesh.triangles.end(),
                        {{0, 2, 1}, {0, 3, 2}, {last, last + 1, last + 2}, {last, last + 2, last + 3}});
  return mesh;
}

/// Upper jaw: rounded nose, flat inner face with shallow teeth, thicker towards the hinge.
geometry::TriangleMesh MakeUpperJaw(const Tool& tool) {
  constexpr int kTeeth = 9;
  std::vector<Section> sections;
  const double half_width = 0.5 * tool.jaw_width;
  sections.push_back({0.0, 0.35 * half_width, 0.15 * tool.jaw_thickness, 0.5 * tool.jaw_thickness});
  const int steps = 2 * kTeeth;
  for (int i = 1; i <= steps; ++i) {
    const double along = static_cast<double>(i) / steps;
    const double nose = std::sqrt(std::min(1.0, along / 0.15));
    const double tooth = (i % 2 == 0 ? 0.0 : 0.18) * tool.jaw_thickness;
    sections.push_back({along * tool.jaw_length, half_width * (0.35 + 0.65 * nose), tooth,
                        tool.jaw_thickness * (0.5 + 0.5 * nose) * (0.8 + 0.3 * along)});
  }
  return MakeLoft(sections);
}

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
  scissors.jaw_length = 0.015, scissors.jaw_width = 0.003, scissors.jaw_thickness = 0.0012;
  Tool clip_applier;
  clip_applier.name = "clip_applier", clip_applier.kind = ToolKind::kClipApplier;
  clip_applier.shaft_radius = 0.005, clip_applier.jaw_length = 0.012, clip_applier.jaw_width = 0.003;
  clip_applier.max_jaw = 0.5, clip_applier.clips = 15;  // jaws 6 mm apart at their tips
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
  return JawHinge(tool) + tool.jaw_length * Vec3{0, side * std::sin(0.5 * jaw), -std::cos(0.5 * jaw)};
}

ToolCapsules CalcCapsules(const Tool& tool, double jaw, double shaft_reach) noexcept {
  const Vec3 hinge = JawHinge(tool);
  const double radius = 0.5 * tool.jaw_width;
  const double reach = std::clamp(shaft_reach, 0.0, tool.shaft_length - tool.jaw_length);
  return {{JawTip(tool, jaw, +1), hinge, radius},
          {JawTip(tool, jaw, -1), hinge, radius},
          {hinge, hinge + Vec3{0, 0, reach}, tool.shaft_radius}};
}

std::vector<ToolPart> MakeParts(const Tool& tool) {
  ToolPart upper{ToolPart::Kind::kUpperJaw, MakeUpperJaw(tool)};
  ToolPart lower{ToolPart::Kind::kLowerJaw, upper.mesh};
  for (Vec3& p : lower.mesh.positions) p = {-p.x, -p.y, p.z};  // half a turn about the shaft

  const double hinge = tool.jaw_length, end = tool.shaft_length;
  geometry::CentreLine axis;
  for (const double z : {hinge - 0.001, hinge + 0.0015, hinge + 0.004, end}) axis.points.push_back({0, 0, z});
  axis.radii = {0.55 * tool.shaft_radius, 0.9 * tool.shaft_radius, tool.shaft_radius, tool.shaft_radius};
  return {{ToolPart::Kind::kShaft, geometry::MakeTube(axis, 24)}, std::move(upper), std::move(lower)};
}

Pose CalcPartPose(const Tool& tool, ToolPart::Kind kind, double jaw) noexcept {
  if (kind == ToolPart::Kind::kShaft) return {};
  const double side = kind == ToolPart::Kind::kUpperJaw ? 1.0 : -1.0;
  // about +x, the direction -z turns to +y
  const math::Quaternion turn = math::RotationAbout({1, 0, 0}, side * 0.5 * jaw);
  const Vec3 hinge = JawHinge(tool);
  return {turn, hinge - math::Rotate(turn, hinge)};
}

}  // namespace trocar::instrument
