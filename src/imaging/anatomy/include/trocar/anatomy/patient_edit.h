// SPDX-License-Identifier: Apache-2.0
/// \file patient_edit.h  Edits of a patient: regions, ducts and arteries, landmarks.
/// Every operation leaves the patient as it was when it returns an error.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/anatomy/tube_graph.h"
#include "trocar/base/result.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Vertices within `radius` of a place on a surface that hang together with `vertex`: a brush that does not
/// reach through a thin lobe. Ascending; `vertex` is always among them.
/// \param neighbours  of FindVertexNeighbours for the mesh
std::vector<std::uint32_t> FindBrushVertices(const geometry::TriangleMesh& mesh,
                                             const geometry::Rows& neighbours, std::uint32_t vertex,
                                             const math::Vec3& place, double radius);

/// Adds vertices to a region, which is made when there is none, or takes them away.
/// Where the gallbladder's bed changes, its strands follow: new vertices are tied to the nearest liver
/// triangle within 10 mm, and the strands of vertices that left are removed.
/// \return kPatientInvalid for an organ or vertex that is not there, or a region name that is no plain word
base::Status PaintRegion(patient::Patient& patient, std::string_view organ, std::string_view region,
                         std::span<const std::uint32_t> vertices, bool is_added);

/// Moves a point of a centre line. Points within `reach` along the line follow less and less; so do the ends
/// of other tubes that are joined to what moves.
/// \param reach [m], >= 0
base::Status MoveTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t point,
                           const math::Vec3& position, double reach);
/// New point on the line between `after` and the next one; its radius lies between theirs.
base::Status InsertTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t after,
                             const math::Vec3& position);
/// \return kPatientInvalid when fewer than two points would be left
base::Status DeleteTubePoint(patient::Patient& patient, std::uint32_t tube, std::uint32_t point);
/// Multiplies the radius; points within `reach` follow less and less. Radii stay within 0.1 and 15 mm.
base::Status ScaleTubeRadius(patient::Patient& patient, std::uint32_t tube, std::uint32_t point,
                             double factor, double reach);

/// Joins an end to an organ or another tube: it moves onto the nearest point of the surface or centre line,
/// and the points near it follow. An empty name lets the end leave the scene.
/// \return kUnknownName with those that are known; kPatientInvalid for a tube that would join itself
base::Status JoinTubeEnd(patient::Patient& patient, std::uint32_t tube, TubeEnd end, std::string_view name);

/// \return kPatientInvalid when the name is taken or no plain word, or the line is not usable
base::Status AddTube(patient::Patient& patient, patient::Tube tube);
/// Removes it; ends that named it leave the scene from now on.
base::Status RemoveTube(patient::Patient& patient, std::uint32_t tube);

/// Names of the usual ducts and arteries that the patient lacks.
std::vector<std::string> FindMissingTubes(const patient::Patient& patient);
/// Adds one of them, placed by the landmarks (is_seen = false) and joined.
/// \return kUnknownName for a name that is none of the usual ones; kPatientInvalid without liver, gallbladder
/// or the landmark "infundibulum"
base::Status AddTemplateTube(patient::Patient& patient, std::string_view name);

/// Moves a landmark, or makes it. Fundus and infundibulum stay on the gallbladder's surface.
base::Status PlaceLandmark(patient::Patient& patient, std::string_view name, const math::Vec3& position);

/// Where a finding of the linter lies: the middle of the organ, region, tube, tube's end, landmark or
/// attachment that its `where` names. Nothing where the patient has no such thing.
std::optional<math::Vec3> FindWhere(const patient::Patient& patient, std::string_view where);

}  // namespace trocar::anatomy
