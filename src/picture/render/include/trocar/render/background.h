// SPDX-License-Identifier: Apache-2.0
/// \file background.h  The insufflated abdomen round the organs: wall, omentum, colon, stomach, duodenum.
///
/// Decoration: it is generated, belongs to no patient, and nothing in the simulation touches it but stones that fell,
/// which lie on the omentum (geometry/omentum.h). A patient's own neighbours take the place of parts of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "trocar/geometry/omentum.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/material.h"
#include "trocar/roles/roles.h"

namespace trocar::render {

/// Where the background must keep away.
using Obstacle = geometry::Ball;

struct BackgroundPart {
  std::string name;
  Material material;
  geometry::TriangleMesh mesh;  ///< world frame [m]; faces what the laparoscope sees
};

/// The abdomen from inside, front to back as a laparoscope at the umbilicus sees it, the wall last.
///
/// \param inside  points that the wall encloses [m]: the organs
/// \param above   what must stay visible above omentum and bowel: organs, ducts, vessels
/// \param without  what is left out because the patient brings its own
/// \return  the same bits for the same arguments
std::vector<BackgroundPart> MakeAbdomen(std::span<const math::Vec3> inside, std::span<const Obstacle> above,
                                        std::span<const roles::NeighbourRole> without = {});

}  // namespace trocar::render
