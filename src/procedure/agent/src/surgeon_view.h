// SPDX-License-Identifier: Apache-2.0
/// \file surgeon_view.h  What a surgeon knows and sees in one tick: anatomy, the snapshot, and both hands.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "division_plan.h"
#include "organ_clearance.h"
#include "patient_knowledge.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/cholecystectomy/triangle_sight.h"
#include "trocar/collision/queries.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/model_description.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::agent {

/// Refers to what its owner keeps: one is made for each tick.
struct SurgeonView {
  const scene::Scene& scene;
  const PatientKnowledge& known;
  const simulation::Snapshot& seen;
  const std::array<HandMotion, instrument::kHandCount>& hands;
  OrganClearance& organs;                 ///< follows the snapshot
  cholecystectomy::TriangleSight& sight;  ///< likewise, by LookAtFat
  double first_azimuth = 0;               ///< of the lens, at the start [rad]

  const HandMotion& Hand(int hand) const { return hands[static_cast<std::size_t>(hand)]; }
  const simulation::InstrumentSnapshot& Tool(int hand) const {
    return seen.instruments[static_cast<std::size_t>(hand)];
  }
  /// The tool in use.
  const instrument::Tool& ToolOf(int hand) const;
  bool IsIntact(std::uint32_t strand) const { return seen.operation.strand_is_intact[strand] != 0; }
  /// Distance from a segment to the nearest organ, at most 30 mm [m].
  double Clearance(const collision::Segment& segment) const { return organs.Find(seen, segment); }

  // ducts and arteries, from the gallbladder's end on
  math::Vec3 TubePoint(std::size_t tube, double share) const;
  math::Vec3 TubeDirection(std::size_t tube, double share) const;
  TubeLine LineOf(std::size_t tube) const;
  std::vector<TubeLine> Lines() const;
  /// (tubes) arcs of the clips on each, ascending [m]
  std::vector<std::vector<double>> FindClips(const std::vector<TubeLine>& lines) const;
  bool IsDivided(std::size_t tube) const;

  /// Brings the fat that hides points up to date.
  void LookAtFat() const;
  /// Whether all points lie in the picture with no organ, and no fat that was left at the last LookAtFat, before them.
  bool Shows(const math::Pose& X_world_lens, std::span<const math::Vec3> points) const;
};

/// Where an eye is about the cystic duct, in the frame of the gallbladder's neck, which turns under the hand [rad].
/// \param first  azimuth that counts as 0 [rad]
double CalcAzimuth(const PatientKnowledge& known, std::span<const math::Vec3> positions,
                   const math::Vec3& eye, double first);

}  // namespace trocar::agent
