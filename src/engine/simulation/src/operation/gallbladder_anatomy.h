// SPDX-License-Identifier: Apache-2.0
/// \file gallbladder_anatomy.h  Which tubes, strands and nodes of a patient's tissue an operation on the gallbladder is about.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/cholecystectomy/dissection_monitor.h"
#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/surgery/bed_ooze.h"
#include "trocar/surgery/gallbladder_attachment.h"
#include "trocar/surgery/gallstone_spill.h"

namespace trocar::simulation {

/// Surfaces and strands by their names in the data sets. An organ of which nothing is known counts as a vessel: harm.
cholecystectomy::TargetTable MakeTargetTable(std::span<const scene::SurfaceInfo> surfaces,
                                             std::span<const scene::StrandInfo> strands);

/// The patient's ducts and arteries among the nodes of its tissue.
/// \param map  of the patient: see scene::MakePatientVessels
/// \param spare_count  nodes for the ends of cuts
surgery::Vessels MakeVessels(surgery::VesselMap map, const patient::Patient& patient,
                             const scene::PatientTissue& tissue, std::uint32_t spare_count,
                             const surgery::VesselSettings& settings = {});

/// \param surfaces  organs, then tubes
/// \param strands   (strands)
std::vector<surgery::EnteringTube> FindEnteringTubes(const patient::Patient& patient,
                                                     std::span<const scene::SurfaceInfo> surfaces,
                                                     std::span<const scene::StrandInfo> strands);

/// Strands and tubes that hold the gallbladder.
surgery::GallbladderAttachment MakeAttachment(const patient::Patient& patient,
                                              std::span<const scene::SurfaceInfo> surfaces,
                                              std::span<const scene::StrandInfo> strands);

/// The part of the hepatocystic triangle that the critical view has to show.
/// \param rest        (nodes) [m]
/// \param main_ducts, main_arteries  nodes of those that must stay
cholecystectomy::TriangleWindow MakeTriangleWindow(std::span<const scene::SurfaceInfo> surfaces,
                                                   std::span<const scene::StrandInfo> strands,
                                                   std::span<const math::Vec3> rest,
                                                   std::span<const std::uint32_t> main_ducts,
                                                   std::span<const std::uint32_t> main_arteries,
                                                   const cholecystectomy::JudgementSettings& settings);

/// Points of the hepatocystic triangle that an eye has to see, and the fat that hides them.
/// \param rest       (nodes) [m]
/// \param exposable  (entering) of CalcExposable
cholecystectomy::TriangleSight MakeTriangleSight(const patient::Patient& patient,
                                                 std::span<const scene::SurfaceInfo> surfaces,
                                                 std::span<const scene::StrandInfo> strands,
                                                 std::span<const math::Vec3> rest,
                                                 std::span<const double> exposable,
                                                 const cholecystectomy::JudgementSettings& settings);

/// How much of each tube, from the gallbladder on, may be asked to lie bare: as far as main ducts and arteries, which keep
/// what lies beside them, fat that reaches there included. At least kLeastExposable.
/// \param rest        (nodes) [m]
/// \param main_ducts, main_arteries  nodes of those that must stay
/// \return (entering) along the tube at rest [m]
std::vector<double> CalcExposable(std::span<const surgery::EnteringTube> entering,
                                  std::span<const math::Vec3> rest, std::span<const std::uint32_t> main_ducts,
                                  std::span<const std::uint32_t> main_arteries,
                                  const cholecystectomy::JudgementSettings& settings);
inline constexpr double kLeastExposable = 0.003;  // [m]

/// All but the triangle's window, the sight of it, and what is exposable.
/// \param rest  (nodes) [m]
cholecystectomy::DissectedAnatomy MakeDissectedAnatomy(const patient::Patient& patient,
                                                       std::span<const scene::SurfaceInfo> surfaces,
                                                       std::span<const scene::StrandInfo> strands,
                                                       std::span<const math::Vec3> rest);

/// How many stones a patient has, and how large: by the patient's parameters, else by the scene.
surgery::GallstoneSettings FindGallstones(const scene::Scene& scene);
/// Gallstones of a scene; none where it has none.
/// \param surfaces, rest  bodies under which the omentum passes, on which stones come to lie
/// \return kMeshInvalid
base::Result<surgery::GallstoneSpill> MakeGallstones(const scene::Scene& scene,
                                                     std::span<const scene::SurfaceInfo> surfaces,
                                                     std::span<const math::Vec3> rest);

}  // namespace trocar::simulation
