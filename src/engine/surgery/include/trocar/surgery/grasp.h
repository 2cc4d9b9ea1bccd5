// SPDX-License-Identifier: Apache-2.0
/// \file grasp.h  Grasping: jaws that close on tissue carry its nodes with them until they open or the tissue
/// slips. The carried nodes are the paper's third boundary condition, a predefined position (section 3.2.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// How jaws grip. Harder closing pinches harder; tissue slips out when pulled harder than friction holds it, and is
/// damaged when pinched harder than its bite bears.
/// Defaults: domain facts, section 6.2 (thresholds) and 3.3 (against a pull of 5 N, 3.0 N of pinch are needed and
/// 6.8 N are used; profiled jaws hold as with a friction of 1.7).
struct GraspSettings {
  double close_fraction = 0.20;  ///< of the full opening, below which jaws hold [-]
  double open_fraction = 0.35;   ///< above which they let go [-]
  double reach = 0.004;          ///< nodes this near to the line between the jaws are taken [m]
  double least_pinch = 3.0;      ///< of jaws that have just closed [N]
  double most_pinch = 20.0;      ///< of jaws squeezed as far as they go [N]
  double friction = 1.7;         ///< effective, profiled jaws [-]
  int slip_ticks = 6;            ///< the pull must exceed friction * pinch this many ticks in a row
};

/// Grasp of one tool: the nodes that it holds. Fixed capacity: the nearest nodes when there are more.
struct Grasp {
  static constexpr std::size_t kCapacity = 32;
  bool are_jaws_closed =
      true;  ///< by the two thresholds; a tool starts closed and has to open before it can grasp
  std::int32_t surface = -1;  ///< organ, or organs + tube; -1 while nothing is held
  std::size_t count = 0;
  std::array<std::uint32_t, kCapacity> nodes{};     ///< of the whole system
  std::array<math::Vec3, kCapacity> p_tool_node{};  ///< where each is held in the tool frame [m]
  double jaw_at_closing = 0;                        ///< [rad]
  double pinch = 0;                                 ///< of the jaws on what they hold [N]
  double damage_pinch = 0;                          ///< that this bite bears [N]
  bool is_damaged = false;                          ///< it has been pinched harder
  int ticks_over_limit = 0;

  bool IsHolding() const { return count > 0; }
  std::span<const std::uint32_t> Nodes() const { return std::span(nodes).first(count); }
};

void VisitState(base::StateArchive& archive, Grasp& grasp);

enum class GraspChange { kNone, kGrasped, kMissed, kReleased, kSlipped, kDamaged };

/// Follows the jaws: takes the nodes of an organ, duct or vessel between them when they close, lets go when they
/// open, moves what is held and pinches it.
///
/// Nodes that anatomy or another tool prescribes are not taken.
/// \param X_world_tool    of the tool that is seen (the proxy), between whose jaws tissue is taken
/// \param X_world_device  of the hand's tool, with which it is moved
/// \param tubes           or nullptr
/// \param[in,out] state  conditions and positions of the held nodes
/// \return kGrasped, kMissed (closed on nothing), kReleased, kDamaged (pinched too hard, once a bite) or kNone
/// \note Real-time safe.
GraspChange UpdateGrasp(const instrument::Tool& tool, const math::Pose& X_world_tool,
                        const math::Pose& X_world_device, double jaw, std::span<const OrganSurface> organs,
                        const TubeSet* tubes, const tissue::TissueModel& model, const GraspSettings& settings,
                        Grasp& grasp, tissue::TissueState& state) noexcept;

/// Lets go when the pull was stronger than the grip for too long: pull > friction * pinch.
/// \param pull  reaction of the held nodes [N]
/// \return kSlipped or kNone
GraspChange UpdateSlip(double pull, const GraspSettings& settings, const tissue::TissueModel& model,
                       Grasp& grasp, tissue::TissueState& state) noexcept;

/// Frees the held nodes at once.
void ReleaseGrasp(const tissue::TissueModel& model, Grasp& grasp, tissue::TissueState& state) noexcept;

}  // namespace trocar::surgery
