// SPDX-License-Identifier: Apache-2.0
/// \file patient_anatomy.h  Which tubes, strands and nodes of a patient's tissue a cholecystectomy is about.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/cholecystectomy/dissection_monitor.h"
#include "trocar/cholecystectomy/hand_acts.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/surgery/surgery_settings.h"
#include "trocar/surgery/vessel_map.h"

namespace trocar::cholecystectomy {

/// Rows of a patient's tissue.
struct PatientRows {
  std::span<const scene::SurfaceInfo> surfaces;  ///< organs, then tubes
  std::span<const scene::StrandInfo> strands;    ///< (strands)
  std::span<const math::Vec3> rest;              ///< (nodes) [m]
};

/// Nodes of ducts and arteries that must stay.
struct MainNodes {
  std::vector<std::uint32_t> ducts, arteries;
};
/// \param roles  of each vessel of the map
MainNodes FindMainNodes(const patient::Patient& patient, std::span<const scene::SurfaceInfo> surfaces,
                        const surgery::VesselMap& map, std::span<const roles::TubeRole> roles);

/// Surfaces and strands by their names in the data sets. An organ of which nothing is known counts as a vessel: harm.
TargetTable MakeTargetTable(std::span<const scene::SurfaceInfo> surfaces,
                            std::span<const scene::StrandInfo> strands);

/// The part of the hepatocystic triangle that the critical view has to show.
TriangleWindow MakeTriangleWindow(const PatientRows& rows, const MainNodes& main,
                                  const surgery::JudgementSettings& settings);

/// Points of the hepatocystic triangle that an eye has to see, and the fat that hides them.
/// \param entering   tubes that enter the gallbladder
/// \param exposable  (entering) of CalcExposable
TriangleSight MakeTriangleSight(const PatientRows& rows, std::span<const surgery::EnteringTube> entering,
                                std::span<const double> exposable,
                                const surgery::JudgementSettings& settings);

/// How much of each tube, from the gallbladder on, may be asked to lie bare: as far as main ducts and arteries, which keep
/// what lies beside them, fat that reaches there included. At least kLeastExposable.
/// \param rest  (nodes) [m]
/// \return (entering) along the tube at rest [m]
std::vector<double> CalcExposable(std::span<const surgery::EnteringTube> entering,
                                  std::span<const math::Vec3> rest, const MainNodes& main,
                                  const surgery::JudgementSettings& settings);
inline constexpr double kLeastExposable = 0.003;  // [m]

DissectedAnatomy MakeDissectedAnatomy(const patient::Patient& patient, const PatientRows& rows,
                                      const MainNodes& main, const surgery::JudgementSettings& settings);

}  // namespace trocar::cholecystectomy
