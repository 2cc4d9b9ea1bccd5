// SPDX-License-Identifier: Apache-2.0
/// \file duct_template.h  Ducts and arteries where no picture shows them: placed between landmarks.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/contours/control_points.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Centre lines of the bile ducts, the right hepatic artery and the cystic artery or arteries.
///
/// The common hepatic duct's ends are searched for so that it starts on the liver and both it and the cystic
/// duct can have their lengths; lines are pushed out of both organs and bowed until their length is right.
/// \param liver, gallbladder  closed, in a frame of (left, cranial, anterior) [mm]
/// \param neck  where the cystic duct leaves the gallbladder [mm]
/// \param parameters  as DrawParameters returns them
/// \return tubes for ControlPoints with pixel_mm = slice_mm = 1 and axes left, superior, anterior; is_seen =
/// false
std::vector<contours::TubePoints> PlaceDucts(const geometry::TriangleMesh& liver,
                                             const geometry::TriangleMesh& gallbladder,
                                             const math::Vec3& neck,
                                             std::span<const patient::Parameter> parameters);

/// The usual tubes for a patient whose pictures show none, in the world frame [m]; is_seen = false.
/// \param neck  where the cystic duct leaves the gallbladder, world frame [m]
/// \param parameters  as DrawParameters returns them; where one is missing the usual ones take their place
std::vector<patient::Tube> MakeTemplateTubes(const geometry::TriangleMesh& liver,
                                             const geometry::TriangleMesh& gallbladder,
                                             const math::Vec3& neck,
                                             std::span<const patient::Parameter> parameters);

/// Middle of the hepatocystic triangle: between the middles of the cystic and the common hepatic duct, world frame [m].
/// \return nothing where one of them is missing
std::optional<math::Vec3> CalcTriangleMiddle(const patient::Patient& patient);

/// Length of the polygon through a tube's points, in the frame of PlaceDucts [mm].
double CalcLengthMm(const contours::TubePoints& tube);

/// Control points without contours, whose frame is (left, cranial, anterior) [mm] and whose fundus lies where
/// the built-in scenes expect it.
contours::ControlPoints MakeWorldFrame();

}  // namespace trocar::anatomy
