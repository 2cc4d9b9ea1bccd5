// SPDX-License-Identifier: Apache-2.0
/// \file operated.h  What is operated on: the tissue as it is, its parts that surgery changes, and the hands at it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trocar/instrument/camera.h"
#include "trocar/instrument/hand.h"
#include "trocar/scene/input.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/surgery/cuttable_organ.h"
#include "trocar/surgery/electrosurgery.h"
#include "trocar/surgery/gallstone_spill.h"
#include "trocar/surgery/grasp.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/surgery/topology_change.h"
#include "trocar/surgery/vessels.h"
#include "trocar/surgery/wall_holes.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::simulation {

/// State of the hands in a tick, with gravity, camera and time.
struct HandsNow {
  const scene::Input* input = nullptr;
  std::array<instrument::TrocarJoints, instrument::kHandCount> joints;
  std::array<math::Pose, instrument::kHandCount> X_proxy, X_device;
  std::array<surgery::GraspChange, instrument::kHandCount> changes{};
  std::array<math::Vec3, instrument::kHandCount>
      forces;                 ///< on the tools in the tick before, world frame [N]
  math::Vec3 gravity;         ///< [m/s^2]
  instrument::Camera camera;  ///< as the trainee saw when the hands moved
  double time = 0;            ///< [s]
  double seconds = 0;         ///< of the tick
};

/// Tissue that is operated on, and the grasps of the hands at it. It refers to a simulation's state.
struct OperatedTissue {
  const tissue::TissueModel& model;
  const tissue::TissueDefinition& definition;
  tissue::TissueState& state;
  const tissue::Conservation& conservation;
  tissue::ConservationState& conserved;
  std::span<const surgery::OrganSurface> organs;
  const surgery::TubeSet& tubes;
  std::span<const std::uint32_t> torn_springs;  ///< of walls, in this tick
  std::array<surgery::Grasp, instrument::kHandCount>& grasps;
};

/// Damage to the wall of a hollow organ, and the leak that has been booked.
struct WallDamage {
  surgery::WallHoles holes;
  double open_area = 0;    ///< that blades have made [m^2]
  double leaked_seen = 0;  ///< that has been booked [m^3]
};

/// How far an organ is on its way out.
struct Retrieval {
  bool is_organ_free = false, is_in_bag = false, is_completed = false;
  std::int32_t bag_hand = -1;
};

/// Parts that surgery changes, beside the state of the tissue.
struct OperatedParts {
  std::vector<surgery::CuttableOrgan> organs;
  std::optional<surgery::Vessels> vessels;
  surgery::Electrosurgery heat;
  surgery::GallstoneSpill stones;
  surgery::FluidLedger fluids;
  WallDamage wall;
  Retrieval retrieval;
  double smoke = 0;                ///< 0 none to 1 thick [-]
  surgery::TopologyChange change;  ///< of this tick
};

/// Anatomy that is asked for again and again; constant.
struct OperatedAnatomy {
  /// That is taken out, and in whose bed it lies: Procedure::organ and host, among the surfaces, or -1.
  std::int32_t organ = -1, host = -1;
  math::Vec3 p_pool;                                     ///< where blood and bile gather [m]
  double deepest = 0;                                    ///< z below which nothing falls [m]
  std::uint32_t assistant_node = 0;                      ///< of what the assistant takes
  std::vector<std::uint32_t> band_strands, band_starts;  ///< (bands) the strands of each, by band_starts
};

}  // namespace trocar::simulation
