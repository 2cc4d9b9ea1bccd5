// SPDX-License-Identifier: Apache-2.0
/// \file surface_cut.h  Cutting a surface along what a blade sweeps, a little in every tick, anywhere.
///
/// A tick's cut goes in three steps, each of which keeps any manifold mesh manifold: edges that the sweep
/// crosses are split (or the crossing goes to a near vertex, so that no slivers arise), the edges between the
/// triangles on either side of the sweep are scored, and scored edges are opened by giving each part of a
/// vertex's triangles a vertex of its own. docs/cutting.md explains why that is enough.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "trocar/geometry/blade_sweep.h"
#include "trocar/geometry/editable_mesh.h"

namespace trocar::geometry {

struct CutSettings {
  double snap = 0.2;  ///< crossings nearer to a vertex than this share of the edge go there [-], [0.05, 0.5]
  double min_angle = 0.052;  ///< no new triangle has a smaller angle: 3 deg [rad]
  /// A cut grows within a triangle by so much at a time; where the triangle does not allow it, from edge to edge [m]
  double step = 0.0015;
  /// Walls close the cut to a trench, as in a solid organ, instead of leaving an opening, as in a hollow one.
  bool has_walls = false;
  /// Of the trench, at most [m]; it is less where the organ is thin or its triangles are small.
  double depth = 0.010;
};

/// Where a blade stands in one surface: the ends of the cuts that it is making. They are continued from there.
struct CutFront {
  static constexpr std::size_t kCapacity = 16;
  std::array<std::uint32_t, kCapacity> tips{};
  std::size_t count = 0;

  std::span<const std::uint32_t> Tips() const { return std::span(tips).first(count); }
};

void VisitState(base::StateArchive& archive, CutFront& front);

/// Result of the cut of one tick: counts of the edits made and of the edges left uncut.
struct CutReport {
  std::size_t crossings = 0;  ///< edges that the sweep crossed
  std::size_t splits = 0;     ///< of them split
  std::size_t snaps = 0;      ///< of them that went to a vertex
  std::size_t inserted = 0;   ///< vertices put into triangles, where a cut starts or grows
  std::size_t scored = 0;     ///< edges marked as cut
  std::size_t opened = 0;     ///< of them opened, now or those of ticks before
  std::size_t copies = 0;     ///< vertices on the other side
  std::size_t wall_triangles = 0;
  std::size_t refused = 0;  ///< edges left uncut: a sliver, a loose single triangle or a wall without place
  bool is_full = false;     ///< the pools are used up; what no longer fitted was left uncut

  bool HasChanged() const { return splits + inserted + opened > 0; }
};

/// Cuts one surface; holds scratch alone, so that a state is saved by copying mesh and fronts.
class SurfaceCutter {
 public:
  /// Allocates all that cutting this mesh takes.
  explicit SurfaceCutter(const EditableMesh& mesh);
  ~SurfaceCutter();
  SurfaceCutter(SurfaceCutter&&) noexcept;
  SurfaceCutter& operator=(SurfaceCutter&&) noexcept;

  /// Cuts along one tick of a blade, in present positions.
  ///
  /// \param before, now  the blade's edge [m]; a cut goes on from `front` even where the tissue moved
  /// \param[in,out] front  empty where the blade starts anew
  /// \return counts of the edits; the mesh's journal tells which triangles changed
  /// \pre the mesh is the one that the cutter was made for, or a copy
  /// \note Real-time safe: no allocation, lock or throw. What is not finite cuts nothing.
  CutReport Cut(const BladeEdge& before, const BladeEdge& now, const CutSettings& settings, CutFront& front,
                EditableMesh& mesh) noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::geometry
