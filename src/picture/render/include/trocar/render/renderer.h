// SPDX-License-Identifier: Apache-2.0
/// \file renderer.h  Draws the laparoscope's picture with OpenGL 3.3 core into whatever framebuffer is bound.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/frame.h"
#include "trocar/render/geometry_picture.h"
#include "trocar/render/looks.h"

namespace trocar::render {

/// Marks that surgery has left on one vertex of a tissue's surface or makes there now, each 0 to 255.
struct alignas(4) SurfaceMark {
  std::uint8_t blanching = 0;  ///< white: cooked
  std::uint8_t charring = 0;   ///< brown, then black
  std::uint8_t blood = 0;      ///< film of blood
  std::uint8_t bile = 0;       ///< film of bile
  std::uint8_t pallor = 0;     ///< stretched: blood is pressed out of it

  friend bool operator==(const SurfaceMark&, const SurfaceMark&) = default;
};

/// Height of a picture in which a refined surface looks no different: its triangles are smaller than what a processor shades
/// at once [pixels].
inline constexpr int kCoarseHeight = 300;

/// Surfaces, shaders and textures in one OpenGL context, which must be current whenever a member is called
/// and when the renderer is destroyed. It knows no window: it draws into the framebuffer that is bound.
class Renderer {
 public:
  /// \pre an OpenGL context is current
  /// \return kGraphicsTooOld (below 3.3, or OpenGL ES) or kShaderFailed with the compiler's words
  static base::Result<Renderer> Make(const Looks& looks);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Uploads a surface whose rest positions are its present ones.
  ///
  /// \param triangles  (nt) counter-clockwise seen from where it is drawn
  /// \param rest       (nv) where the patterns of its material stick to it [m]
  /// \param ambient_occlusion   (nv) of ambient_occlusion.h, or empty for 1 everywhere [-]
  /// \param coarse     fewer triangles over the same vertices, drawn in their place where a picture is at most
  ///                   kCoarseHeight high; empty: none
  /// \pre indices below nv; ambient_occlusion empty or (nv) (TROCAR_ASSERT)
  SurfaceId AddSurface(std::span<const geometry::Triangle> triangles, std::span<const math::Vec3> rest,
                       Material material, std::span<const double> ambient_occlusion = {},
                       std::span<const geometry::Triangle> coarse = {});
  SurfaceId AddSurface(const geometry::TriangleMesh& mesh, Material material,
                       std::span<const double> ambient_occlusion = {});

  /// New shape of a deforming surface; its pattern moves with it.
  /// \param positions, normals  (nv) as added [m], [-] unit
  void UpdateSurface(SurfaceId surface, std::span<const math::Vec3> positions,
                     std::span<const math::Vec3> normals);
  /// Sets the marks that surgery has left on a surface; none until the first call.
  /// \param marks  (nv) as added; tools show none
  void UpdateMarks(SurfaceId surface, std::span<const SurfaceMark> marks);
  /// New connectivity, for example after a cut; vertices stay as they are, coarse triangles are gone.
  void UpdateTriangles(SurfaceId surface, std::span<const geometry::Triangle> triangles);
  /// Frees a surface; its id names nothing from now on.
  void RemoveSurface(SurfaceId surface);

  /// Draws into the bound framebuffer, which must have depth. Leaves depth test, culling and masks off, so
  /// that a toolkit can go on; leaves no program and no vertex array bound.
  /// \param width, height  of the framebuffer [pixels]; nothing happens when either is below 1
  /// \note The same frame gives the same pixels; with automatic exposure, the same frames since the renderer was made do.
  ///       Surfaces that were removed are left out.
  void Draw(const Frame& frame, int width, int height);

  /// Draws depth, normal and label at each pixel of the picture that Draw() would make. Light, smoke and arrows play no part;
  /// translucent things count as opaque. Leaves another framebuffer bound.
  /// \param fine  labels of fibres, blobs and puddles by their material
  /// \param[in,out] picture  memory is used again
  /// \return kNoGraphics for a size that the driver does not have, or kShaderFailed
  base::Status DrawGeometry(const Frame& frame, const MaterialLabels& fine, int width, int height,
                            GeometryPicture& picture);
  /// As DrawGeometry, with GeometryPicture::flow since this was called last.
  base::Status DrawGeometryAndFlow(const Frame& frame, const MaterialLabels& fine, int width, int height,
                                   GeometryPicture& picture);

  /// The surface as the graphics card has it, in single precision; for tests. Empty for one that was removed.
  geometry::TriangleMesh ReadSurface(SurfaceId surface) const;

 private:
  base::Status DrawGeometryNow(const Frame& frame, const MaterialLabels& fine, int width, int height,
                               bool has_flow, GeometryPicture& picture);
  void DrawOnce(const Frame& frame, double exposure, unsigned target, int width, int height);

  struct Content;
  explicit Renderer(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// Of a picture of that height [pixels].
double CalcFocalPixels(const Camera& camera, int height);

/// Where a world point falls in the picture [pixels], x from the left, y from the top; what lies behind the
/// lens is not finite.
math::Vec2 CalcPixel(const Camera& camera, const math::Vec3& p_world, int width, int height);

}  // namespace trocar::render
