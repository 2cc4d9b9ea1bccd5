// SPDX-License-Identifier: Apache-2.0
/// \file topology_change.h  Changes of the mass-spring system by a cut: the list from which a solver takes them in the same
/// tick.
///
/// Nodes are never renumbered. The capacity for new ones is in the system from the start, as spare nodes that are fixed and
/// joined to nothing; springs are named by their two nodes. docs/cutting.md says how stiffness and mass are shared out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/editable_mesh.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// A node with its new constants. A new one says what it is made of.
struct NodeChange {
  std::uint32_t node = 0;
  bool is_new = false;
  std::array<std::uint32_t, 3> from = {geometry::kNone, geometry::kNone,
                                       geometry::kNone};  ///< nodes; kNone where fewer
  std::array<double, 3> weights = {0, 0, 0};              ///< sum 1 [-]
  math::Vec3 rest, position;                              ///< of a new one [m]
  double mass = 0;                                        ///< [kg]
  double shape_stiffness = 0;                             ///< [N/m]
};

/// The spring between two nodes from now on.
struct SpringChange {
  std::uint32_t a = 0, b = 0;  ///< a < b
  double stiffness = 0;        ///< k [N/m]; 0: there is none any more
  double rest_length = 0;      ///< l [m]
  std::uint32_t law = 0;       ///< index in TissueDefinition::laws
  /// Nodes of the spring of which this is a part or a side: a factor on that one's stiffness holds for this one too.
  /// kNone where it is new.
  std::array<std::uint32_t, 2> inherits = {geometry::kNone, geometry::kNone};
};

/// All changes of one tick. Fixed capacity, so that a tick allocates nothing.
struct TopologyChange {
  std::vector<NodeChange> nodes;
  std::vector<SpringChange> springs;       ///< one for each pair of nodes
  std::vector<std::uint32_t> cut_strands;  ///< indices, ascending

  /// Reserves so many of each.
  void Reserve(std::size_t node_count, std::size_t spring_count, std::size_t strand_count);
  void Clear() noexcept;
  bool IsEmpty() const { return nodes.empty() && springs.empty() && cut_strands.empty(); }
};

/// Adds spare nodes at the end of a system: fixed, weightless, joined to nothing.
/// \return the first of them
std::uint32_t AddSpareNodes(std::size_t count, tissue::TissueDefinition& definition);

/// Takes a change into a description: constants of nodes, springs replaced, removed and added. New nodes are no longer
/// fixed, unless all that they are made of is. Springs stay in their order; new ones follow.
///
/// \return (springs after) the spring of before whose factor and damage each one has, or kNone for a fresh one
/// \note Not real-time safe: allocates; linear in the number of springs.
std::vector<std::uint32_t> ApplyChange(const TopologyChange& change, tissue::TissueDefinition& definition);

/// Takes a change into a state of the model that was made from the changed description: new nodes get their positions and
/// follow the balance of forces unless fixed, springs keep their factor and damage or inherit it, strands are cut.
///
/// \param spring_origins  result of the other ApplyChange
void ApplyChange(const TopologyChange& change, std::span<const std::uint32_t> spring_origins,
                 const tissue::TissueModel& model, tissue::TissueState& state);

}  // namespace trocar::surgery
