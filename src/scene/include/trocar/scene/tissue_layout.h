// SPDX-License-Identifier: Apache-2.0
/// \file tissue_layout.h  Which rows of a snapshot belong to which surface and strand; constant.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::scene {

/// A surface that can be drawn: an organ, or the skin of a duct or vessel around its centre-line nodes.
struct SurfaceInfo {
  std::string name;                              ///< "liver", "cystic_duct"
  std::string material;                          ///< "liver", "gallbladder", "duct", "artery"
  std::uint32_t first_node = 0, node_count = 0;  ///< rows of Snapshot::positions
  std::vector<geometry::Triangle> triangles;     ///< organs: indices from 0 at first_node; tubes: empty
  std::vector<double> radii;                     ///< (node_count) tubes only [m]
};

/// One of the strands that dissection divides.
struct StrandInfo {
  std::uint32_t a = 0, b = 0;  ///< rows of Snapshot::positions
  enum class Kind : std::uint8_t {
    kBed,  ///< gallbladder to liver
    kAdhesion,
    kTriangle,    ///< fat and fibres of the hepatocystic triangle
    kPeritoneum,  ///< its cover, front and back
    kEnd,         ///< of a tube in its organ
    kBand         ///< of a training task: part of a band
  } kind = Kind::kBed;
  std::int32_t band = -1;  ///< index in ModelSetup::bands, or -1
};

}  // namespace trocar::scene
