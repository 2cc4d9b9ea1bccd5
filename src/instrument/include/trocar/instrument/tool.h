// SPDX-License-Identifier: Apache-2.0
/// \file tool.h  The shapes of laparoscopic tools. Tool frame: origin at the tip, +z back along the shaft, +y
/// the direction in which the upper jaw opens.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/pose.h"

namespace trocar::instrument {

using math::Pose;
using math::Vec3;

/// What a tool can do besides pushing.
enum class ToolKind : std::uint8_t {
  kGrasper,    ///< atraumatic, with a ratchet
  kDissector,  ///< Maryland: spreads and tears, and carries current
  kHook,       ///< electrode; no jaws
  kScissors,
  kClipApplier,       ///< 10 mm; a clip closes with its jaws
  kSuctionIrrigator,  ///< no jaws
  kBag                ///< retrieval bag; no jaws, its mouth is open
};

/// Sizes of one tool. Source of the defaults: domain facts, section 1.3 (5 mm tools, 33 cm shafts).
struct Tool {
  std::string name = "grasper";
  ToolKind kind = ToolKind::kGrasper;
  double shaft_radius = 0.0025;         ///< [m]
  double shaft_length = 0.33;           ///< [m]
  double jaw_length = 0.022;            ///< from hinge to tip [m]
  double jaw_width = 0.0045;            ///< across the opening direction [m]
  double jaw_thickness = 0.0018;        ///< of each jaw [m]
  double max_jaw = 1.0471975511965976;  ///< whole opening, 60 deg [rad]; 0: the tool has no jaws
  int clips = 0;                        ///< that a clip applier holds
};

/// \param name  "grasper", "maryland", "hook", "scissors", "clip_applier", "suction_irrigator" or "bag"
/// \return nullptr for an unknown one
const Tool* FindTool(std::string_view name) noexcept;

/// Hinge of the jaws in the tool frame [m].
Vec3 JawHinge(const Tool& tool) noexcept;

/// Tip of a jaw in the tool frame; side is +1 for the upper jaw, -1 for the lower.
/// \param jaw  whole opening [rad]
Vec3 JawTip(const Tool& tool, double jaw, int side) noexcept;

/// Straight piece with round ends, in the tool frame.
struct Capsule {
  Vec3 a, b;          ///< [m]
  double radius = 0;  ///< [m]
};

/// What can touch tissue: the two jaws, then the shaft's last `shaft_reach` [m].
struct ToolCapsules {
  Capsule upper_jaw, lower_jaw, shaft;
};
ToolCapsules CalcCapsules(const Tool& tool, double jaw, double shaft_reach) noexcept;

/// One rigid part of a tool for drawing, at jaw opening 0.
struct ToolPart {
  enum class Kind { kShaft, kUpperJaw, kLowerJaw } kind;
  geometry::TriangleMesh mesh;  ///< tool frame [m]
};
std::vector<ToolPart> MakeParts(const Tool& tool);

/// Pose of a part in the tool frame at an opening: jaws turn about the hinge, the shaft stays.
Pose CalcPartPose(const Tool& tool, ToolPart::Kind kind, double jaw) noexcept;

}  // namespace trocar::instrument
