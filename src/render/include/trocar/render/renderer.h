// SPDX-License-Identifier: Apache-2.0
/// \file renderer.h  Draws the laparoscope's picture with OpenGL 3.3 core into whatever framebuffer is bound.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/math/pose.h"
#include "trocar/render/material.h"

namespace trocar::render {

/// A surface on the graphics card. The default one names none.
struct SurfaceId {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;

  friend bool operator==(const SurfaceId&, const SurfaceId&) = default;
};

/// The picture's diameter as a share of its height: the circle is cut a little at top and bottom, as on a
/// wide screen.
inline constexpr double kMaskDiameter = 1.14;

struct Camera {
  /// Origin at the lens, looking along -z, +y up in the picture.
  math::Pose X_world_camera;
  /// Across the round picture, its diameter [rad], 0.1 to 2.8; a telescope's data sheet calls it diagonal.
  double field_of_view = 1.308997;
};

/// One surface in one place. Deforming organs lie in the world frame and keep the identity.
struct SurfaceDraw {
  SurfaceId surface;
  math::Pose X_world_surface;
};

/// An arrow of light blue, for example a force at a tool's tip. Nothing hides it.
struct Arrow {
  math::Vec3 p_world_tail;  ///< [m]
  math::Vec3 span;          ///< from tail to head, world frame [m]
  double radius = 0.0012;   ///< of its shaft [m]
};

/// A straight piece that takes light from the tissue near it, for example the end of a tool.
struct Shade {
  math::Vec3 a, b;    ///< ends, world frame [m]
  double radius = 0;  ///< [m]
};
inline constexpr std::size_t kMaxShades = 4;

/// Everything that one picture shows.
struct Frame {
  Camera camera;
  double light_power = 1;  ///< head light beside the lens; 1 exposes tissue at 0.10 m well [-]
  /// Drawn in this order; nearest first is fastest.
  std::vector<SurfaceDraw> surfaces;
  std::vector<Arrow> arrows;
  std::vector<Shade> shades;  ///< the first kMaxShades count
  bool has_mask = true;       ///< round picture, black outside
  bool has_smooth_edges = true;
  bool is_wireframe = false;                               ///< edges only
  std::array<double, 3> clear_colour{0.01, 0.004, 0.003};  ///< where nothing is, sRGB [0, 1]
};

/// Surfaces, shaders and textures in one OpenGL context, which must be current whenever a member is called
/// and when the renderer is destroyed. It knows no window: it draws into the framebuffer that is bound.
class Renderer {
 public:
  /// \pre an OpenGL context is current
  /// \return kGraphicsTooOld (below 3.3, or OpenGL ES) or kShaderFailed with the compiler's words
  static core::Result<Renderer> Make();

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Uploads a surface whose rest positions are its present ones.
  ///
  /// \param triangles  (nt) counter-clockwise seen from where it is drawn
  /// \param rest       (nv) where the patterns of its material stick to it [m]
  /// \param openness   (nv) of openness.h, or empty for 1 everywhere [-]
  /// \pre indices below nv; openness empty or (nv) (TROCAR_ASSERT)
  SurfaceId AddSurface(std::span<const geometry::Triangle> triangles, std::span<const math::Vec3> rest,
                       Material material, std::span<const double> openness = {});
  SurfaceId AddSurface(const geometry::TriangleMesh& mesh, Material material,
                       std::span<const double> openness = {});

  /// New shape of a deforming surface; its pattern moves with it.
  /// \param positions, normals  (nv) as added [m], [-] unit
  void UpdateSurface(SurfaceId surface, std::span<const math::Vec3> positions,
                     std::span<const math::Vec3> normals);
  /// New connectivity, for example after a cut; vertices stay as they are.
  void UpdateTriangles(SurfaceId surface, std::span<const geometry::Triangle> triangles);
  /// Frees a surface; its id names nothing from now on.
  void RemoveSurface(SurfaceId surface);

  /// Draws into the bound framebuffer, which must have depth. Leaves depth test, culling and masks off, so
  /// that a toolkit can go on; leaves no program and no vertex array bound.
  /// \param width, height  of the framebuffer [pixels]; nothing happens when either is below 1
  /// \note The same frame gives the same pixels. Surfaces that were removed are left out.
  void Draw(const Frame& frame, int width, int height);

 private:
  struct Content;
  explicit Renderer(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// Where a world point falls in the picture [pixels], x from the left, y from the top; what lies behind the
/// lens is not finite.
math::Vec2 CalcPixel(const Camera& camera, const math::Vec3& p_world, int width, int height);

}  // namespace trocar::render
