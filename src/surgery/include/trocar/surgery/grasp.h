// SPDX-License-Identifier: Apache-2.0
/// \file grasp.h  Grasping: jaws that close on tissue carry its nodes with them until they open or the tissue
/// slips. The carried nodes are the paper's third boundary condition, a predefined position (section 3.2.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/instrument/tool.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

using math::Pose;

/// Defaults: jaw thresholds and grip from the domain facts, sections 6.2 and 3.3.
struct GraspSettings {
  double close_fraction = 0.20;  ///< of the full opening, below which jaws hold [-]
  double open_fraction = 0.35;   ///< above which they let go [-]
  double reach = 0.004;          ///< nodes this near to the line between the jaws are taken [m]
  double pinch_force = 6.8;      ///< of the jaws on the tissue [N]
  double friction = 1.7;         ///< effective, profiled jaws [-]
  int slip_ticks = 6;            ///< the pull must exceed friction * pinch this many ticks in a row

  double HoldLimit() const { return friction * pinch_force; }  ///< [N]
};

/// What one tool holds. Fixed room: the nearest nodes when there are more.
struct Grasp {
  static constexpr std::size_t kCapacity = 32;
  bool are_jaws_closed =
      true;  ///< by the two thresholds; a tool starts closed and has to open before it can grasp
  std::int32_t organ = -1;  ///< index into the organs, -1 while nothing is held
  std::size_t count = 0;
  std::array<std::uint32_t, kCapacity> nodes{};  ///< of the whole system
  std::array<Vec3, kCapacity> p_tool_node{};     ///< where each is held in the tool frame [m]
  double jaw_at_closing = 0;                     ///< [rad]
  int ticks_over_limit = 0;

  bool IsHolding() const { return count > 0; }
  std::span<const std::uint32_t> Nodes() const { return std::span(nodes).first(count); }
};

enum class GraspChange { kNone, kGrasped, kMissed, kReleased, kSlipped };

/// Follows the jaws: takes the nodes between them when they close, lets go when they open, and moves what is
/// held.
///
/// Nodes that anatomy or another tool prescribes are not taken.
/// \param[in,out] state  conditions and positions of the held nodes
/// \return kGrasped, kMissed (closed on nothing), kReleased or kNone
/// \note Real-time safe.
GraspChange UpdateGrasp(const instrument::Tool& tool, const Pose& X_world_tool, double jaw,
                        std::span<const OrganSurface> organs, const tissue::TissueModel& model,
                        const GraspSettings& settings, Grasp& grasp, tissue::TissueState& state) noexcept;

/// Lets go when the pull was too strong for too long.
/// \param pull  reaction of the held nodes [N]
/// \return kSlipped or kNone
GraspChange UpdateSlip(double pull, const GraspSettings& settings, const tissue::TissueModel& model,
                       Grasp& grasp, tissue::TissueState& state) noexcept;

/// Frees the held nodes at once.
void ReleaseGrasp(const tissue::TissueModel& model, Grasp& grasp, tissue::TissueState& state) noexcept;

}  // namespace trocar::surgery
