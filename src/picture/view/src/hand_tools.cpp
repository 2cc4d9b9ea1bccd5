// SPDX-License-Identifier: Apache-2.0
#include "hand_tools.h"

#include <algorithm>
#include <cmath>

#include "tip_clouds.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/random.h"
#include "trocar/view/labels.h"

namespace trocar::view {
namespace {

using instrument::ToolKind;
using Kind = instrument::ToolPart::Kind;
using math::Pose;
using math::Vec3;
using render::Material;

constexpr double kSleeveRadius = 0.0042;       // m, of a 5 mm trocar
constexpr double kSleeveInside = 0.012;        // m that it stands out of the wall, inwards
constexpr double kSleeveOutside = 0.060;       // m
constexpr double kSleeveMaxBore = 0.0034;      // m; a thicker shaft gets a wider sleeve
constexpr double kShadeLength = 0.120;         // m of a shaft that shades tissue
constexpr std::size_t kAssistantInstance = 2;  // after both hands
constexpr double kHem = 0.005;                 // m under the bag's mouth
constexpr double kHemShare = 2.4, kFilmShare = 0.8;
constexpr int kSparks = 7;
constexpr double kSparkLength = 0.0028;  // m, of the longest

geometry::TriangleMesh MakeSleeve(double shaft_radius) {
  const double radius = kSleeveRadius + std::max(0.0, shaft_radius - kSleeveMaxBore);
  // the inner end is bevelled
  return geometry::MakeTube({{{0, 0, -kSleeveInside}, {0, 0, -kSleeveInside + 0.002}, {0, 0, kSleeveOutside}},
                             {0.88 * radius, radius, radius}},
                            24);
}

Material MaterialOfPart(ToolKind tool, Kind part) {
  switch (part) {
    case Kind::kShaft:
      return tool == ToolKind::kSuctionIrrigator ? Material::kSteel : Material::kShaft;
    case Kind::kBore:
      return Material::kLumen;
    case Kind::kPouch:
      return Material::kPouch;
    case Kind::kUpperClip:
    case Kind::kLowerClip:
      return Material::kTitanium;
    default:
      return Material::kSteel;
  }
}

/// Film that is doubled at the mouth, where the ring runs in it: (vertices) share of its opacity.
std::vector<double> CalcPouchShares(const geometry::TriangleMesh& pouch) {
  std::vector<double> shares;
  for (const Vec3& p : pouch.positions) shares.push_back(p.y > -kHem ? kHemShare : kFilmShare);
  return shares;
}

/// Current leaves the toe of the hook, else the tips.
Vec3 FindElectrode(const instrument::Tool& tool, const Pose& X_world_tool) {
  return X_world_tool * (instrument::AbilitiesOf(tool.kind).electrode == instrument::Electrode::kToe
                             ? Vec3{0, 0.0032, -0.0005}
                             : Vec3{});
}

void AddSparks(render::Frame& frame, const Vec3& source, std::uint64_t tick, std::uint32_t hand) {
  math::Random random(2 * tick + hand);
  frame.blobs.push_back({source, 0.0006, Material::kSpark, 0});
  for (std::uint32_t i = 0; i < kSparks; ++i) {
    const Vec3 way{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const double length = kSparkLength * (0.35 + 0.65 * random.Uniform());
    frame.fibres.push_back({source, source + length * math::Normalized(way), 0.00022, 0.0003,
                            Material::kSpark, static_cast<std::uint32_t>(random.NextWord())});
  }
}

}  // namespace

void HandTools::Add(render::Renderer& renderer, const scene::Scene& scene) {
  const auto upload = [&renderer](const instrument::Tool& tool) {
    ShownTool shown{tool, {}};
    for (const instrument::ToolPart& part : instrument::MakeParts(tool)) {
      const std::vector<double> shares =
          part.kind == Kind::kPouch ? CalcPouchShares(part.mesh) : std::vector<double>{};
      shown.parts.push_back(
          {part.kind, renderer.AddSurface(part.mesh, MaterialOfPart(tool.kind, part.kind), shares)});
    }
    return shown;
  };
  assistant_ = upload(*instrument::FindTool("grasper"));
  if (scene.operation) suction_ = scene.operation->parameters.suction;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const scene::InstrumentSetup& setup = scene.instruments[i];
    Hand& hand = hands_[i];
    hand.p_world_port = setup.p_world_port;
    double widest = 0;
    const auto add = [&](const instrument::Tool& tool) {
      widest = std::max(widest, tool.shaft_radius);
      hand.tray.push_back(upload(tool));
    };
    for (const instrument::Tool& tool : setup.tray) add(tool);
    if (setup.tray.empty()) add(setup.tool);
    hand.sleeve = renderer.AddSurface(MakeSleeve(widest), Material::kSleeve);
  }
}

void HandTools::AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const {
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    const Hand& hand = hands_[i];
    const simulation::InstrumentSnapshot& now = snapshot.instruments[i];
    const ShownTool& shown =
        hand.tray[std::min<std::size_t>(snapshot.operation.tools[i], hand.tray.size() - 1)];
    for (const Part& part : shown.parts) {
      const bool is_clip = part.kind == Kind::kUpperClip || part.kind == Kind::kLowerClip;
      if (is_clip && snapshot.operation.clips_left[i] <= 0) continue;
      const Pose X_tool_part = instrument::CalcPartPose(shown.tool, part.kind, now.joints.jaw);
      frame.surfaces.push_back(
          {part.surface, now.X_world_tool * X_tool_part, MakeLabel(FindLabelClass(shown.tool.kind), i)});
    }
    frame.surfaces.push_back(
        {hand.sleeve, {now.X_world_tool.rotation, hand.p_world_port}, MakeLabel(LabelClass::kTrocar, i)});
    frame.shades.push_back({now.X_world_tool * Vec3{0, 0, 0.5 * shown.tool.jaw_width},
                            now.X_world_tool * Vec3{0, 0, kShadeLength}, shown.tool.shaft_radius});
    AddClouds(frame, snapshot, i, shown.tool);
  }
  AddAssistant(frame, snapshot);
}

void HandTools::AddClouds(render::Frame& frame, const simulation::Snapshot& snapshot, std::size_t hand,
                          const instrument::Tool& tool) const {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  const Pose& X_world_tool = snapshot.instruments[hand].X_world_tool;
  if (operation.has_current[hand]) {
    const Vec3 source = FindElectrode(tool, X_world_tool);
    AddSparks(frame, source, snapshot.tick, static_cast<std::uint32_t>(hand));
    AddSteam(frame, snapshot, source);
  }
  if (operation.is_rinsing[hand]) AddRinse(frame, snapshot, tool, X_world_tool, suction_.rinse_rate);
  if (operation.is_aspirating[hand]) AddSuction(frame, snapshot, tool, X_world_tool, suction_.pool_reach);
}

void HandTools::AddAssistant(render::Frame& frame, const simulation::Snapshot& snapshot) const {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  if (!operation.assistant.is_there) return;
  for (const Part& part : assistant_.parts) {
    const Pose X_tool_part = instrument::CalcPartPose(assistant_.tool, part.kind, operation.assistant.jaw);
    frame.surfaces.push_back({part.surface, operation.assistant.X_world_tool * X_tool_part,
                              MakeLabel(FindLabelClass(assistant_.tool.kind), kAssistantInstance)});
  }
  frame.shades.push_back({operation.assistant.X_world_tool * Vec3{0, 0, 0.5 * assistant_.tool.jaw_width},
                          operation.assistant.X_world_tool * Vec3{0, 0, kShadeLength},
                          assistant_.tool.shaft_radius});
}

}  // namespace trocar::view
