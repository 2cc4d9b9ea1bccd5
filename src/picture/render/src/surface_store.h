// SPDX-License-Identifier: Apache-2.0
/// \file surface_store.h  The surfaces on the graphics card: their vertices, marks and triangles.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/frame.h"
#include "trocar/render/renderer.h"

namespace trocar::render {

/// Buffers of one surface.
struct Surface {
  std::uint32_t generation = 0;  ///< odd while in use
  Material material = Material::kLiver;
  GLuint array = 0, moving = 0, rest = 0, indices = 0;
  GLuint marks = 0;        ///< 0: it has none
  GLuint earlier = 0;      ///< positions when Remember was called; 0: it was not
  bool has_moved = false;  ///< since then
  GLsizei index_count = 0;
  GLsizei coarse_count = 0;  ///< indices behind those, of the coarse triangles
  std::size_t vertex_count = 0;
  geometry::Box box;  ///< around its vertices, in its own frame [m]
};

/// Attributes of a vertex: 0 position, 1 normal, 2 rest position and ambient_occlusion, 3 marks,
/// 4 earlier position, 5 pallor of the marks.
/// Needs the OpenGL context of the renderer that owns it.
class SurfaceStore {
 public:
  SurfaceStore() = default;
  SurfaceStore(const SurfaceStore&) = delete;
  SurfaceStore& operator=(const SurfaceStore&) = delete;
  ~SurfaceStore();

  /// As Renderer::AddSurface and Renderer::RemoveSurface.
  SurfaceId Add(std::span<const geometry::Triangle> triangles, std::span<const math::Vec3> rest,
                Material material, std::span<const double> ambient_occlusion,
                std::span<const geometry::Triangle> coarse);
  void Remove(SurfaceId id);

  /// \return nullptr for what was removed or never there
  Surface* Find(SurfaceId id);

  /// \param positions, normals  (nv) of the surface [m], [-] unit
  void UploadMoving(Surface& surface, std::span<const math::Vec3> positions,
                    std::span<const math::Vec3> normals);
  /// \param marks  (nv)
  static void UploadMarks(Surface& surface, std::span<const SurfaceMark> marks);
  /// \pre indices below nv (TROCAR_ASSERT)
  static void UploadTriangles(Surface& surface, std::span<const geometry::Triangle> triangles,
                              std::span<const geometry::Triangle> coarse);
  /// Keeps where the vertices are now as their earlier positions.
  static void Remember(Surface& surface);
  /// Back from the graphics card, as it moves now.
  static geometry::TriangleMesh Read(const Surface& surface);

 private:
  /// A vertex of the streamed buffer.
  struct MovingVertex {
    std::array<float, 3> position, normal;
  };
  std::vector<Surface> surfaces_;
  std::vector<MovingVertex> staging_;  // kept, so that a frame does not allocate
};

}  // namespace trocar::render
