// SPDX-License-Identifier: Apache-2.0
/// \file tissue_layout.h  Which rows of a snapshot belong to which surface and strand; constant.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/roles/roles.h"

namespace trocar::scene {

/// A surface that can be drawn: an organ, or the skin of a duct or vessel around its centre-line nodes.
struct SurfaceInfo {
  std::string name;                              ///< for the screen and for files
  std::string look;                              ///< "liver", "duct", "artery": see render/material.h
  std::uint32_t first_node = 0, node_count = 0;  ///< rows of Snapshot::positions
  std::vector<geometry::Triangle> triangles;     ///< organs: indices from 0 at first_node; tubes: empty
  std::vector<double> radii;                     ///< (node_count) tubes only [m]
  roles::OrganRole organ = roles::OrganRole::kOther;
  roles::TubeRole tube = roles::TubeRole::kOther;
  /// Tubes only: the surface that its first and its last node join, -1 where it leaves the scene.
  std::array<std::int32_t, 2> ends{-1, -1};

  bool IsTube() const noexcept { return triangles.empty(); }
  bool Joins(std::int32_t surface) const noexcept {
    return surface >= 0 && (ends[0] == surface || ends[1] == surface);
  }
};

/// Index of the organ of that role, or -1.
inline std::int32_t FindSurface(std::span<const SurfaceInfo> surfaces, roles::OrganRole role) noexcept {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i].organ == role) return static_cast<std::int32_t>(i);
  }
  return -1;
}
/// Index of the first duct or artery of that role, or -1.
inline std::int32_t FindSurface(std::span<const SurfaceInfo> surfaces, roles::TubeRole role) noexcept {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i].tube == role) return static_cast<std::int32_t>(i);
  }
  return -1;
}

/// Radius of a full lobule of fat about a strand of the hepatocystic triangle: as it is drawn, and what it hides [m].
inline constexpr double kLobuleRadius = 0.0021;

/// One of the strands that dissection divides.
struct StrandInfo {
  std::uint32_t a = 0, b = 0;  ///< rows of Snapshot::positions
  using Kind = roles::StrandRole;
  Kind kind = Kind::kBed;
  std::int32_t band = -1;  ///< index in ModelSetup::bands, or -1
};

}  // namespace trocar::scene
