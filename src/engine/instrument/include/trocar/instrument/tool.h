// SPDX-License-Identifier: Apache-2.0
/// \file tool.h  The shapes of laparoscopic tools. Tool frame: origin at the tip, +z back along the shaft, +y
/// the direction in which the upper jaw opens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/geometry/blade_sweep.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/pose.h"

namespace trocar::instrument {

/// Kind of a tool: what it can do besides pushing.
enum class ToolKind : std::uint8_t {
  kGrasper,    ///< atraumatic, with a ratchet
  kDissector,  ///< Maryland: spreads and tears, and carries current
  kHook,       ///< electrode; no jaws
  kScissors,
  kClipApplier,       ///< 10 mm; a clip closes with its jaws
  kSuctionIrrigator,  ///< no jaws
  kBag,               ///< retrieval bag; no jaws, its mouth is open
  kLinearStapler      ///< 12 mm; closes between two rows of staples on each side, and divides between them
};

inline constexpr std::size_t kToolKindCount = static_cast<std::size_t>(ToolKind::kLinearStapler) + 1;

/// Bare metal that current leaves.
enum class Electrode : std::uint8_t {
  kNone,
  kToe,  ///< of the hook
  kJaws
};
/// Edge that parts tissue.
enum class Blade : std::uint8_t {
  kNone,
  kJaws,  ///< scissors, when they close
  kHeel   ///< of the hook, under current
};

/// Pedals and buttons that a tool obeys.
struct Pedals {
  bool cut = false, coagulate = false, rinse = false, aspirate = false;
};

/// What a kind of tool can do besides pushing. Each ability is one mechanism of simulation/operation/tools.
struct ToolAbilities {
  bool takes = false;    ///< jaws take tissue and things, and hold them
  bool spreads = false;  ///< jaws part strands as they open
  bool bites = false;    ///< jaws close around a whole tube, and do something when they have closed
  bool holds_clips = false;
  bool staples =
      false;  ///< closed jaws staple and divide at a press of the cut pedal; Tool::clips are its loads
  bool sucks = false;  ///< and rinses
  bool is_bag = false;
  Electrode electrode = Electrode::kNone;
  Blade blade = Blade::kNone;
  Pedals pedals;
};
const ToolAbilities& AbilitiesOf(ToolKind kind) noexcept;

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
  int clips = 0;                        ///< that a clip applier holds; loads of a stapler
};

/// One of each kind, in the order of ToolKind: "grasper", "maryland", "hook", "scissors", "clip_applier", "suction_irrigator", "bag",
/// "linear_stapler".
std::span<const Tool> AllTools() noexcept;
/// \return nullptr for an unknown name
const Tool* FindTool(std::string_view name) noexcept;

/// Toe of the hook: across the shaft at the tip, as long as in the domain facts, section 1.3 [m].
inline constexpr geometry::BladeEdge kHookToe = {{0, 0, 0}, {0, 0.0045, 0}};
/// Bore of a suction-irrigator, as a share of its outer radius [-].
inline constexpr double kSuctionBore = 0.72;
/// Mouth of the retrieval bag: a spring ring that begins at the tool's tip and lies ahead of it, in the plane y = 0;
/// the pouch hangs towards -y.
inline constexpr double kBagMouth = 0.060;  ///< its diameter [m]
inline constexpr double kBagDepth = 0.085;  ///< of the pouch [m]

/// Hinge of the jaws in the tool frame [m].
math::Vec3 JawHinge(const Tool& tool) noexcept;

/// Tip of a jaw in the tool frame; side is +1 for the upper jaw, -1 for the lower.
/// \param jaw  whole opening [rad], at most the tool's own: a tool without jaws has one tip
math::Vec3 JawTip(const Tool& tool, double jaw, int side) noexcept;

/// Straight piece with round ends, in the tool frame.
struct Capsule {
  math::Vec3 a, b;    ///< [m]
  double radius = 0;  ///< [m]
};

/// Parts of a tool that can touch tissue: the two jaws, and the last `shaft_reach` [m] of the shaft. Of a tool without jaws
/// both jaws are the tip piece, from the end of the shaft to the tip.
struct ToolCapsules {
  Capsule upper_jaw, lower_jaw, shaft;
};
ToolCapsules CalcCapsules(const Tool& tool, double jaw, double shaft_reach) noexcept;

/// One rigid part of a tool for drawing, at jaw opening 0.
struct ToolPart {
  enum class Kind : std::uint8_t {
    kShaft,      ///< the long tube
    kTip,        ///< bare metal that stays with the shaft: hub of the hinge, electrode, spring ring
    kBore,       ///< the dark inside of a tube
    kPouch,      ///< of the retrieval bag
    kUpperJaw,   ///< turns about the hinge
    kLowerJaw,   ///< turns about the hinge
    kUpperClip,  ///< leg of the clip that the upper jaw holds
    kLowerClip
  } kind;
  geometry::TriangleMesh mesh;  ///< closed and outward, tool frame [m]
};
/// Shaft first. The legs of a clip are there when the tool is one that holds clips, whatever their number.
std::vector<ToolPart> MakeParts(const Tool& tool);

/// Pose of a part in the tool frame at an opening: jaws, and what they hold, turn about the hinge; the rest stays.
math::Pose CalcPartPose(const Tool& tool, ToolPart::Kind kind, double jaw) noexcept;

}  // namespace trocar::instrument
