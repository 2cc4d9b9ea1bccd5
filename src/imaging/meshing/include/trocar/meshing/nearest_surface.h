// SPDX-License-Identifier: Apache-2.0
/// \file nearest_surface.h  Nearest point of a mesh by a grid of its triangles' boxes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/geometry/distance.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

/// Nearest point found on a surface.
struct SurfacePoint {
  std::uint32_t triangle = 0;
  geometry::TrianglePoint at;
  double distance = 0;  ///< in the mesh's unit
};

/// Keeps a reference to the mesh, which must stay as it is.
class NearestSurface {
 public:
  /// \pre at least one triangle (TROCAR_ASSERT)
  explicit NearestSurface(const geometry::TriangleMesh& mesh);

  SurfacePoint Find(const math::Vec3& p) const;

  /// Whether p lies inside the closed mesh, by the solid angle that the mesh fills around p. O(triangles).
  bool IsInside(const math::Vec3& p) const;

 private:
  std::array<int, 3> CellOf(const math::Vec3& p) const;

  /// Ball around a triangle: whatever lies further away than the best so far is left out quickly.
  struct Ball {
    math::Vec3 centre;
    double radius = 0;
  };

  const geometry::TriangleMesh& mesh_;
  std::vector<Ball> balls_;  // (nt)
  math::Vec3 origin_;
  double cell_ = 1.0;
  std::array<int, 3> size_ = {1, 1, 1};
  std::vector<std::uint32_t> starts_, triangles_;  // compressed rows of cells
};

}  // namespace trocar::meshing
