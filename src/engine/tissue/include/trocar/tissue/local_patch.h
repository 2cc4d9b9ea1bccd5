// SPDX-License-Identifier: Apache-2.0
/// \file local_patch.h  The segment of the tissue around one tool, cut out after a tick for the haptic loop.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.4 (temporal model); where the segment
/// is too large, the linear model of force, pose and Jacobian of OpenSurgSim's devices takes its place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/math/pose.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Three rows of a 3 x 3 matrix.
using Matrix3Rows = std::array<math::Vec3, 3>;

/// Fixed size, so that publishing one allocates nothing. Nodes stand in the order free, held, rim; within the free
/// ones from the contact outwards.
struct LocalPatch {
  static constexpr std::size_t kMaxNodes = 192, kMaxLinks = 1536, kMaxContacts = 64, kMaxPresses = 128;

  enum class Kind : std::uint8_t {
    kNone,     ///< the tool touches and holds nothing
    kSegment,  ///< nodes, links and contacts
    kLinear    ///< force and Jacobian only, what is pressed as springs that let go one by one
  } kind = Kind::kNone;
  bool is_healthy = false;  ///< the tick ended with a good state
  std::uint64_t tick = 0;
  math::Pose X_world_tool;  ///< of the tool in that tick
  math::Vec3 force;         ///< of the tissue on the tool in that tick, as it is at the tip [N], world frame
  bool has_pivot = false;   ///< the shaft turns about its trocar as the tip moves
  Matrix3Rows jacobian{};   ///< kLinear: dF/dp of what holds the tool both ways, symmetric [N/m]

  /// One-sided spring of kLinear. Where the tool's tip has gone by u since the cut it pushes the tip by -(force + stiffness
  /// normal . u) normal as long as the bracket is above zero. A sum of such springs has an energy, so that no way round gains
  /// any; a Jacobian that is cut off as a whole has none.
  struct Press {
    math::Vec3 normal;     ///< tip_normal of the contact, see below
    double force = 0;      ///< at the cut [N], >= 0
    double stiffness = 0;  ///< of contact and tissue in row [N/m], > 0
  };
  std::uint32_t press_count = 0;
  std::array<Press, kMaxPresses> presses;

  std::uint32_t free_count = 0, held_count = 0, node_count = 0;
  std::array<std::uint32_t, kMaxNodes> node;    ///< index in the whole system
  std::array<math::Vec3, kMaxNodes> position;   ///< at the cut [m]
  std::array<double, kMaxNodes> own_stiffness;  ///< of the virtual spring [N/m]

  /// Half of a spring or strand, stored with each free or held end.
  struct Link {
    std::uint16_t other;
    bool is_strand;      ///< keeps its offset instead of its length
    double stiffness;    ///< scaled [N/m]
    double rest_length;  ///< [m]
  };
  std::array<std::uint16_t, kMaxNodes + 1> link_starts;  ///< (free + held + 1)
  std::array<Link, kMaxLinks> links;

  /// One-sided spring between the tool and a point of a triangle; see ContactSpring.
  struct Contact {
    std::array<std::uint16_t, 3> nodes;
    std::array<double, 3> weights;
    math::Vec3 normal;
    /// How far the contact goes along the normal for a metre of the tool's tip: the normal itself at the tip, less across
    /// the shaft the nearer it lies to the trocar. Its force pushes the tip along this.
    math::Vec3 tip_normal;
    math::Vec3 lever;  ///< from the tool's origin to the pressing point [m], world frame
    double depth;      ///< at the cut [m]
    double stiffness;  ///< [N/m]
  };
  std::uint32_t contact_count = 0;
  std::array<Contact, kMaxContacts> contacts;
};

/// Input of the cutter: views into a simulation after its tick.
struct PatchSource {
  const TissueModel& model;
  const TissueState& state;
  const TissueLoad& load;                       ///< for the scales
  std::span<const ContactSpring> contacts;      ///< of all tools
  std::span<const std::uint8_t> contact_tools;  ///< tool of each contact
  std::uint8_t tool = 0;                        ///< tool whose segment is cut
  std::span<const std::uint32_t> held;          ///< nodes between this tool's jaws
  math::Pose X_world_tool;
  math::Vec3 force;  ///< of the tissue on the tool [N]
  bool is_healthy = false;
  std::uint64_t tick = 0;
  bool has_pivot = false;      ///< the tool goes through a trocar
  math::Vec3 p_world_pivot{};  ///< there [m]
};

/// Cuts segments; holds the memory for it.
class PatchCutter {
 public:
  /// \param node_count  of the system
  explicit PatchCutter(std::size_t node_count);

  /// Widest segment, no more than this many rings of nodes around those that the tool presses or holds.
  static constexpr int kMaxRings = 3;

  /// Cuts the largest segment of up to kMaxRings that fits. Its rim is held where it is; all that is not in it, such as
  /// weight, pressure and the other tool, keeps acting as in the tick: at the tool's pose of the tick the segment rests
  /// and answers with exactly `source.force`. A tool with more contacts or nodes than one ring holds gets the linear
  /// model, whose springs take each pressed node's neighbours as held: too stiff, never too soft.
  ///
  /// \param max_rings  1 to kMaxRings
  /// \note Real-time safe: no allocation, lock or throw.
  void Cut(const PatchSource& source, LocalPatch& patch, int max_rings = kMaxRings) noexcept;

 private:
  struct Growth;
  bool Grow(const PatchSource& source, int rings, LocalPatch& patch) noexcept;
  bool AddLinks(const PatchSource& source, LocalPatch& patch) noexcept;
  void SetLinear(const PatchSource& source, LocalPatch& patch) const noexcept;

  std::vector<std::uint16_t> place_;  // (n) of each node in the patch, or kNowhere
};

}  // namespace trocar::tissue
