// SPDX-License-Identifier: Apache-2.0
/// \file gallbladder_bed.h  Where gallbladder and liver grow together, and the strands between them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/meshing/nearest_surface.h"

namespace trocar::anatomy {

struct Bed {
  std::vector<std::uint32_t> gallbladder, liver;    ///< vertices, ascending
  std::vector<std::array<std::uint32_t, 2>> pairs;  ///< gallbladder vertex, liver vertex
};

/// Liver vertices that carry the strand of a place on the gallbladder: corners of the nearest triangle.
std::vector<std::uint32_t> FindCarriers(const geometry::TriangleMesh& liver,
                                        const meshing::SurfacePoint& near);

/// \param bed_distance  gap over which the surfaces are joined where they face each other [m]
Bed FindBed(const geometry::TriangleMesh& gallbladder, const geometry::TriangleMesh& liver,
            double bed_distance);

}  // namespace trocar::anatomy
