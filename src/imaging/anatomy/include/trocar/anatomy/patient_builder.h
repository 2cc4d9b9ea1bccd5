// SPDX-License-Identifier: Apache-2.0
/// \file patient_builder.h  From organ meshes in the frame of the pictures to a patient in the world frame.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.2.2 (the four boundary
/// rules).
#pragma once

#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/meshing/structure_mesh.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Sizes that the rules by geometry use.
struct RegionSettings {
  double hull_depth = 0.035;         ///< deepest place below the outer hull that counts as diaphragmatic [m]
  double margin = 0.012;             ///< band along the border of the diaphragmatic face that stays free [m]
  double gallbladder_clear = 0.022;  ///< around the gallbladder nothing of the liver is fixed [m]
  double falciform_half = 0.007;     ///< half width of the falciform ligament's strip [m]
  double bed_distance = 0.003;       ///< gap over which gallbladder and liver are joined [m]
  double tube_spacing = 0.002;       ///< distance between centre-line points [m]
};

/// Builds regions, attachments, tubes and landmarks, and puts the origin landmark where the control points
/// want it. Where they want nothing, a landmark "umbilicus" becomes the origin; where there is none, the
/// fundus goes to its usual place in the built-in scenes, (-75, 95, -70) mm.
///
/// Regions of the liver, by geometry:
/// - diaphragmatic_face: vertices whose normal, blurred over 10 mm, points superior, anterior or right (not
/// to
///   the viscera) and that lie close to the outer hull in that direction; the largest connected patch with
///   what it encloses, without a free margin along its border and around the gallbladder.
/// - falciform: strip of that face, margin included, at the sagittal plane through the landmark
///   "umbilical_fissure", or 20 mm to the left of the infundibulum where it is not given.
/// - coronary: the posterior part of the superior face, right of the falciform, margin included.
/// - gallbladder_bed (both organs): where they face each other within bed_distance. Every such vertex of the
///   gallbladder is attached to the corners of the nearest liver triangle that carry it.
/// Without any tube the usual ducts and arteries are placed by the landmarks (is_seen = false).
/// \return kPatientInvalid when "liver" or "gallbladder" is missing or they do not touch
base::Result<patient::Patient> AssemblePatient(const contours::ControlPoints& points,
                                               const std::vector<meshing::StructureMesh>& structures,
                                               const RegionSettings& settings = {});

}  // namespace trocar::anatomy
