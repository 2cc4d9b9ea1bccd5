// SPDX-License-Identifier: Apache-2.0
/// \file patient_knowledge.h  What a surgeon knows of a patient before the first cut, as from images and a textbook; constant.
#pragma once

#include <cstdint>
#include <vector>

#include "hold_planner.h"
#include "trocar/cholecystectomy/triangle_description.h"
#include "trocar/math/vector.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/simulation/model_description.h"

namespace trocar::agent {

struct PatientKnowledge {
  std::vector<scene::StrandInfo> strands;
  std::vector<scene::SurfaceInfo> surfaces;                          ///< organs, then tubes
  std::size_t first_tube = 0;                                        ///< of surfaces
  std::int32_t gallbladder = -1, liver = -1;                         ///< of surfaces
  std::vector<math::Vec3> rest;                                      ///< (nodes) [m]
  std::size_t cystic_duct = 0, cystic_artery = 0, hepatic_duct = 0;  ///< of tubes
  /// (tubes)(nodes of it) from the gallbladder's end, where one enters it; and the radii along it [m]
  std::vector<std::vector<std::uint32_t>> tube_nodes;
  std::vector<std::vector<double>> tube_radii;
  std::vector<std::uint8_t> is_artery;        ///< (tubes)
  std::vector<std::uint32_t> neck_nodes;      ///< around the infundibulum
  std::vector<std::size_t> entering;          ///< tubes that enter the gallbladder
  std::vector<std::uint32_t> end_strands;     ///< where they do
  std::vector<std::uint32_t> window_strands;  ///< fat over the hepatocystic triangle's window
  std::vector<std::uint32_t> main_nodes;      ///< of ducts and arteries that must stay
  std::vector<std::uint32_t> main_ducts;      ///< of the ducts among them
  std::vector<double> exposable;              ///< (tubes) what may be asked to lie bare [m]
  std::vector<std::uint32_t> careful_nodes;   ///< of those arteries, and of small ducts of the bed
  std::uint32_t neck = 0, hold = 0, fundus = 0, liver_node = 0;
  math::Vec3 bed_normal;  ///< from the liver towards the gallbladder, at rest; unit

  /// From the infundibulum to the fundus, at rest; unit.
  math::Vec3 BedAxis() const;
  /// Along the bed towards what is not free yet when it is opened from the infundibulum on; unit.
  math::Vec3 BedBack() const;
  /// Place of a node along the gallbladder, from the infundibulum on, at rest [m].
  double AlongBed(std::uint32_t node) const;
  bool MayHold(const HoldFilter& may, std::uint32_t node) const;
  /// Bed and adhesions over a share of the bed's length, from the infundibulum on.
  std::vector<std::uint32_t> BedStrands(double share) const;
  /// What comes first where the bed is opened from the infundibulum or from the fundus on [m].
  std::vector<double> BedOrder(const std::vector<std::uint32_t>& bed, bool is_from_fundus = false) const;
  /// The cystic duct from its far end to the gallbladder, at rest [m].
  math::Vec3 DuctAtRest() const;
};

/// \pre IsCholecystectomy(scene), and `model` and `triangle` are its descriptions (TROCAR_ASSERT)
PatientKnowledge LearnPatient(const scene::Scene& scene, const simulation::ModelDescription& model,
                              const cholecystectomy::TriangleDescription& triangle);

}  // namespace trocar::agent
