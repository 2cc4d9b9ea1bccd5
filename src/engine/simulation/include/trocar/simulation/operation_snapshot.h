// SPDX-License-Identifier: Apache-2.0
/// \file operation_snapshot.h  Changes by surgery: cut surfaces and tubes, clips, burns, running fluids and loose things.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/pose.h"
#include "trocar/scene/input.h"
#include "trocar/scene/procedure_snapshot.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/pattern_cut_monitor.h"
#include "trocar/surgery/surgery_snapshot.h"

namespace trocar::simulation {

/// Surfaces and tubes as cutting has left them.
struct TopologySnapshot {
  std::uint32_t version = 0;  ///< grows when triangles or tube pieces change
  /// Triangles of each organ over the rows of Snapshot::positions: organ i has triangles[first[i]] to
  /// triangles[first[i] + count[i]]. Empty where the scene has nothing that cuts: SurfaceInfo::triangles hold.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> first_triangle, triangle_count;  ///< (organs)
  std::vector<surgery::TubePiece> tube_pieces;                ///< the first tube_piece_count count
  std::size_t tube_piece_count = 0;

  /// Whether a duct or artery was cut through somewhere, so that it has as many pieces as it had nodes, or more.
  /// \param tube  among the surfaces
  bool IsDivided(std::span<const scene::SurfaceInfo> surfaces, std::size_t tube) const noexcept {
    const auto last = tube_pieces.begin() + static_cast<std::ptrdiff_t>(tube_piece_count);
    const auto count = std::count_if(tube_pieces.begin(), last,
                                     [&](const surgery::TubePiece& piece) { return piece.surface == tube; });
    return static_cast<std::size_t>(count) >= surfaces[tube].node_count;
  }
};

/// Leaks and oozing blood, and where the fluids gather.
struct FlowSnapshot {
  std::array<surgery::LeakSnapshot, 32> leaks{};  ///< the first leak_count count
  std::size_t leak_count = 0;
  std::array<surgery::OozeSnapshot, 32> oozes{};  ///< the first ooze_count count: those that bleed most
  std::size_t ooze_count = 0;
  surgery::FluidLedger ledger;
  math::Vec3 p_world_pool;  ///< lowest place, where blood, bile and rinse gather [m]
};

/// The third hand.
struct AssistantSnapshot {
  bool is_there = false;
  math::Pose X_world_tool;  ///< of its grasper
  double jaw = 0;           ///< [rad]
  bool is_holding = false;
};

/// Fixed sizes while a scene runs, so that copying allocates nothing.
struct OperationSnapshot {
  std::array<std::uint8_t, instrument::kHandCount> tools{};  ///< in use, by place in InstrumentSetup::tray
  std::array<bool, instrument::kHandCount> has_current{};    ///< flows through the electrode into tissue
  std::array<int, instrument::kHandCount> clips_left{};      ///< in the tool in use
  /// (Simulation::Strands()) 1 while it holds
  std::vector<std::uint8_t> strand_is_intact;
  /// (nodes) 0 to 1 [-]; empty where the scene has no electrode
  std::vector<float> blanching, charring;
  TopologySnapshot topology;
  std::vector<surgery::ClipSnapshot> clips;  ///< the first clip_count count
  std::size_t clip_count = 0;
  std::array<math::Vec3, 32> tube_cuts{};  ///< the first tube_cut_count count: where at rest, world frame [m]
  std::size_t tube_cut_count = 0;
  std::vector<std::uint8_t> band_is_whole;     ///< (ModelSetup::bands)
  std::vector<surgery::PatternCut> sheets;     ///< (ModelSetup::sheets)
  std::vector<surgery::StoneSnapshot> stones;  ///< the patient's gallstones
  FlowSnapshot flow;
  double smoke = 0;  ///< in the view, 0 none to 1 thick [-]
  AssistantSnapshot assistant;
  scene::ProcedureSnapshot procedure;                                   ///< empty where nobody judges
  std::size_t errors = 0, critical_errors = 0;                          ///< so far
  bool is_organ_free = false, is_in_bag = false, is_completed = false;  ///< of what is taken out
  /// Pedals of a suction-irrigator in this tick. No part of the state: up after it was restored, until the next tick.
  std::array<bool, instrument::kHandCount> is_rinsing{}, is_aspirating{};
};

}  // namespace trocar::simulation
