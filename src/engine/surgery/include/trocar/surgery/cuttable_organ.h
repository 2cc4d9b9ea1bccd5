// SPDX-License-Identifier: Apache-2.0
/// \file cuttable_organ.h  An organ's surface among the nodes of the tissue, cut tick by tick.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/geometry/surface_cut.h"
#include "trocar/surgery/topology_change.h"
#include "trocar/surgery/wall.h"

namespace trocar::surgery {

struct CuttableOrganSettings {
  WallMaterial wall;
  geometry::CutSettings cut;      ///< with walls for a solid organ, without for a hollow one
  std::uint32_t first_node = 0;   ///< of the organ's vertices as they came: node = first_node + vertex
  std::uint32_t first_spare = 0;  ///< of the nodes that new vertices take, see AddSpareNodes
  std::uint32_t spare_count = 0;  ///< vertices that cuts may add; triangles: three times as many
};

/// One organ that can be cut. Vertices keep their numbers; node Node(v) of the tissue is vertex v.
class CuttableOrgan {
 public:
  /// \param mesh  rest shape; a solid organ must be closed
  /// \return kMeshInvalid
  static base::Result<CuttableOrgan> Make(const geometry::TriangleMesh& mesh,
                                          const CuttableOrganSettings& settings);

  std::uint32_t Node(std::uint32_t v) const {
    return v < given_count_ ? settings_.first_node + v
                            : settings_.first_spare + (v - static_cast<std::uint32_t>(given_count_));
  }
  const geometry::EditableMesh& Mesh() const { return mesh_; }
  const CuttableOrganSettings& Settings() const { return settings_; }

  /// Cuts along one tick of a blade.
  ///
  /// \param position  (n) of the whole system [m]
  /// \param[in,out] front  where this blade stands in this organ
  /// \param[in,out] change  gets what the cut changes in the system; within the capacity that ReserveFor gives it
  /// \note Real-time safe: no allocation within the capacity of `change`.
  geometry::CutReport Cut(const geometry::BladeEdge& before, const geometry::BladeEdge& now,
                          std::span<const math::Vec3> position, geometry::CutFront& front,
                          TopologyChange& change) noexcept;

  /// Reserves what any cut of this organ can change.
  void ReserveFor(TopologyChange& change) const;

  /// The mesh with its cuts.
  void VisitState(base::StateArchive& archive) { archive.Field("mesh", mesh_); }

  /// The organ's triangles over the nodes of the system.
  std::vector<geometry::Triangle> NodeTriangles() const;

 private:
  CuttableOrgan(geometry::EditableMesh mesh, const CuttableOrganSettings& settings);
  void ListPairs() noexcept;
  void ListTriangle(const geometry::Triangle& corners, const geometry::Triangle& across) noexcept;
  void ListPair(std::uint32_t a, std::uint32_t b) noexcept;
  void ListChanges(TopologyChange& change) noexcept;
  std::array<std::uint32_t, 2> FindParent(std::uint32_t a, std::uint32_t b) const noexcept;

  geometry::EditableMesh mesh_;
  geometry::SurfaceCutter cutter_;
  CuttableOrganSettings settings_;
  std::size_t given_count_ = 0;
  std::vector<math::Vec3> positions_;    // (nv)
  std::vector<geometry::Edge> pairs_;    // vertices whose spring may have changed
  std::vector<std::uint32_t> vertices_;  // whose mass and foundation may have changed
};

}  // namespace trocar::surgery
