// SPDX-License-Identifier: Apache-2.0
#include "gallbladder_bed.h"

#include <set>

#include "trocar/geometry/mesh_measures.h"

namespace trocar::anatomy {

using math::Vec3;

namespace {

constexpr double kCarries = 0.2;  // barycentric weight from which a liver vertex carries a strand

}  // namespace

std::vector<std::uint32_t> FindCarriers(const geometry::TriangleMesh& liver,
                                        const meshing::SurfacePoint& near) {
  std::vector<std::uint32_t> carriers;
  for (int corner = 0; corner < 3; ++corner) {
    if (near.at.weights[corner] >= kCarries) carriers.push_back(liver.triangles[near.triangle][corner]);
  }
  return carriers;
}

Bed FindBed(const geometry::TriangleMesh& gallbladder, const geometry::TriangleMesh& liver,
            double bed_distance) {
  std::vector<Vec3> normals(gallbladder.positions.size());
  geometry::CalcVertexNormals(gallbladder.positions, gallbladder.triangles, normals);
  const meshing::NearestSurface surface(liver);
  std::set<std::uint32_t> of_liver;
  Bed bed;
  for (std::uint32_t v = 0; v < gallbladder.positions.size(); ++v) {
    const meshing::SurfacePoint near = surface.Find(gallbladder.positions[v]);
    if (near.distance > bed_distance) continue;
    // the surfaces face each other
    if (Dot(normals[v], geometry::CalcAreaNormal(liver.positions, liver.triangles[near.triangle])) >= 0)
      continue;
    bed.gallbladder.push_back(v);
    for (const auto carrier : FindCarriers(liver, near)) {
      bed.pairs.push_back({v, carrier});
      of_liver.insert(carrier);
    }
  }
  bed.liver.assign(of_liver.begin(), of_liver.end());
  return bed;
}

}  // namespace trocar::anatomy
