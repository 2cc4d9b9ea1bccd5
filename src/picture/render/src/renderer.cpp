// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "camera_matrices.h"
#include "exposure_meter.h"
#include "fine_drawer.h"
#include "frame_uniforms.h"
#include "geometry_drawer.h"
#include "puddle_look.h"
#include "round_picture.h"
#include "single_precision.h"
#include "surface_drawer.h"
#include "surface_store.h"
#include "trocar/base/assert.h"
#include "unit_shapes.h"

namespace trocar::render {
namespace {

using geometry::Triangle;
using math::Pose;
using math::Vec3;

constexpr double kOverlayDepth = 0.01;  // share of the depth buffer that is kept for arrows
constexpr double kArrowHeadLength = 4.5, kArrowHeadRadius = 2.4;  // in radii of the arrow's shaft

/// Masks, depth and viewport for the whole picture, and the colour where nothing is.
void ClearPicture(const Frame& frame, int width, int height) {
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthRange(0.0, 1.0);
  glViewport(0, 0, width, height);
  glClearColor(ToFloat(frame.clear_colour[0]), ToFloat(frame.clear_colour[1]), ToFloat(frame.clear_colour[2]),
               1);
  glClearDepth(1.0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

}  // namespace

struct Renderer::Content {
  Looks looks;
  SurfaceStore surfaces;
  SurfaceDrawer surface_drawer;
  FineDrawer fine;
  RoundPicture round;
  ExposureMeter meter;
  GeometryDrawer geometry;
  /// What the flow picture before showed.
  struct {
    Pose X_camera_world;
    std::vector<SurfaceDraw> surfaces;
  } earlier;
  SurfaceId rod, cone;
  std::vector<std::pair<double, const SurfaceDraw*>> by_distance;  // kept, so that a frame does not allocate

  base::Status Make() {
    if (const auto status = surface_drawer.Make(looks); !status) return status;
    if (const auto status = fine.Make(looks); !status) return status;
    if (const auto status = round.Make(); !status) return status;
    const auto add = [&](const geometry::TriangleMesh& mesh, Material material) {
      return surfaces.Add(mesh.triangles, mesh.positions, material, {}, {});
    };
    rod = add(MakeUnitRod(), Material::kForce);
    cone = add(MakeUnitCone(), Material::kForce);
    return {};
  }

  bool IsClear(const Surface& surface) const { return looks[surface.material].opacity < 1.0f; }

  /// The opaque surfaces by distance, so that what near ones hide is not shaded. What the lens is inside of comes last.
  std::span<const std::pair<double, const SurfaceDraw*>> OrderOpaque(const Frame& frame) {
    by_distance.clear();
    for (const SurfaceDraw& draw : frame.surfaces) {
      const Surface* surface = surfaces.Find(draw.surface);
      if (surface == nullptr || IsClear(*surface)) continue;
      const geometry::Box& box = surface->box;
      const Vec3 lens = math::Inverse(draw.X_world_surface) * frame.camera.X_world_camera.translation;
      const bool is_inside = lens.x > box.min.x && lens.x < box.max.x && lens.y > box.min.y &&
                             lens.y < box.max.y && lens.z > box.min.z && lens.z < box.max.z;
      by_distance.emplace_back(is_inside ? std::numeric_limits<double>::infinity()
                                         : math::Distance(lens, 0.5 * (box.min + box.max)),
                               &draw);
    }
    std::sort(by_distance.begin(), by_distance.end());
    return by_distance;
  }

  void DrawSurface(const Surface& surface, const Pose& X_camera_surface, const Vec3& scale = {1, 1, 1}) {
    surface_drawer.Draw(surface, X_camera_surface, scale, looks[surface.material]);
  }

  void SetUniforms(const Frame& frame, const Pose& X_camera_world, double exposure, int width, int height) {
    for (const Program& program : surface_drawer.GetPrograms())
      SetFrameUniforms(program, looks, frame, X_camera_world, exposure, width, height);
    SetFrameUniforms(fine.GetProgram(), looks, frame, X_camera_world, exposure, width, height);
  }

  void DrawScene(const Frame& frame, const Viewport& viewport) {
    // arrows in a slice of depth before everything else: they are a read-out, no organ may hide them
    glDepthRange(0.001, kOverlayDepth);
    for (const Arrow& arrow : frame.arrows) DrawArrow(arrow, viewport.X_camera_world);
    glDepthRange(kOverlayDepth, 1.0);
    for (const auto& [distance, draw] : OrderOpaque(frame))
      DrawSurface(*surfaces.Find(draw->surface), viewport.X_camera_world * draw->X_world_surface);
    glDisable(GL_CULL_FACE);  // blobs face the eye
    fine.DrawBlobs(looks, frame.blobs, viewport);
    glEnable(GL_CULL_FACE);
    DrawClear(frame, viewport);
    glDepthRange(0.0, 1.0);
  }

  /// Everything that light passes through, after what it is seen against.
  void DrawClear(const Frame& frame, const Viewport& viewport) {
    glEnable(GL_BLEND);
    // alpha keeps the brightness of what is behind, for the smoothing of edges
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glDepthMask(GL_FALSE);
    for (const Puddle& p : frame.puddles) {
      if (const Surface* surface = surfaces.Find(p.surface))
        surface_drawer.Draw(*surface, viewport.X_camera_world, {1, 1, 1}, MixLook(looks, p));
    }
    for (const SurfaceDraw& draw : frame.surfaces) {
      const Surface* surface = surfaces.Find(draw.surface);
      if (surface != nullptr && IsClear(*surface))
        DrawSurface(*surface, viewport.X_camera_world * draw.X_world_surface);
    }
    // ribbons face the eye
    glDisable(GL_CULL_FACE);
    fine.DrawFibres(looks, frame.fibres, viewport);
    fine.DrawPuffs(looks, frame.puffs, viewport);
    glEnable(GL_CULL_FACE);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }

  /// Where the n-th drawing of the same surface was in the flow picture before.
  std::optional<Pose> FindEarlier(const Frame& frame, std::size_t index) const {
    const SurfaceId id = frame.surfaces[index].surface;
    const auto is_same = [id](const SurfaceDraw& draw) { return draw.surface == id; };
    auto before = std::count_if(frame.surfaces.begin(),
                                frame.surfaces.begin() + static_cast<std::ptrdiff_t>(index), is_same);
    for (const SurfaceDraw& draw : earlier.surfaces) {
      if (is_same(draw) && before-- == 0) return earlier.X_camera_world * draw.X_world_surface;
    }
    return {};
  }

  /// For the next flow picture.
  void Remember(const Frame& frame, const Pose& X_camera_world) {
    earlier.X_camera_world = X_camera_world;
    earlier.surfaces.clear();
    for (const SurfaceDraw& draw : frame.surfaces) {
      Surface* surface = surfaces.Find(draw.surface);
      if (surface == nullptr || draw.label == 0) continue;
      SurfaceStore::Remember(*surface);
      earlier.surfaces.push_back(draw);
    }
  }

  void DrawGeometry(const Frame& frame, const MaterialLabels& labels, const Viewport& viewport,
                    bool has_flow) {
    glEnable(GL_CULL_FACE);
    for (std::size_t i = 0; i < frame.surfaces.size(); ++i) {
      const SurfaceDraw& draw = frame.surfaces[i];
      const Surface* surface = surfaces.Find(draw.surface);
      if (surface == nullptr || draw.label == 0) continue;
      geometry.Draw(*surface, viewport.X_camera_world * draw.X_world_surface, {1, 1, 1}, draw.label,
                    has_flow ? FindEarlier(frame, i) : std::nullopt);
    }
    for (const Puddle& p : frame.puddles) {
      const std::uint16_t label = labels[static_cast<std::size_t>(FindLiquid(looks, p))];
      const Surface* surface = surfaces.Find(p.surface);
      if (surface == nullptr || label == 0) continue;
      geometry.Draw(*surface, viewport.X_camera_world, {1, 1, 1}, label, {});
    }
    glDisable(GL_CULL_FACE);  // blobs and ribbons face the eye
    std::vector<Fibre> fibres;
    std::vector<Blob> blobs;
    for (std::size_t material = 0; material < labels.size(); ++material) {
      if (labels[material] == 0) continue;
      const auto is_of = [material](const auto& piece) {
        return static_cast<std::size_t>(piece.material) == material;
      };
      fibres.clear();
      blobs.clear();
      std::copy_if(frame.fibres.begin(), frame.fibres.end(), std::back_inserter(fibres), is_of);
      std::copy_if(frame.blobs.begin(), frame.blobs.end(), std::back_inserter(blobs), is_of);
      const Program& program = geometry.BeginFine(labels[material]);
      fine.DrawBlobs(looks, blobs, viewport, &program);
      fine.DrawFibres(looks, fibres, viewport, &program);
    }
  }

  void DrawArrow(const Arrow& arrow, const Pose& X_camera_world) {
    const double length = math::Norm(arrow.span);
    if (!(length > 0.0) || !std::isfinite(length) || !(arrow.radius > 0.0)) return;
    const Vec3 direction = arrow.span / length;
    const math::Quaternion rotation = math::RotationBetween({0, 0, 1}, direction);
    const double head = std::min(kArrowHeadLength * arrow.radius, length);
    const double rod_length = length - head;
    if (rod_length > 0.0) {
      DrawSurface(*surfaces.Find(rod), X_camera_world * Pose{rotation, arrow.p_world_tail},
                  {arrow.radius, arrow.radius, rod_length});
    }
    DrawSurface(*surfaces.Find(cone),
                X_camera_world * Pose{rotation, arrow.p_world_tail + rod_length * direction},
                {kArrowHeadRadius * arrow.radius, kArrowHeadRadius * arrow.radius, head});
  }
};

Renderer::Renderer(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

base::Result<Renderer> Renderer::Make(const Looks& looks) {
  if (const auto status = CheckGraphicsVersion(); !status) return status.error();
  auto content = std::make_unique<Content>();
  content->looks = looks;
  if (const auto status = content->Make(); !status) return status.error();
  return Renderer(std::move(content));
}

SurfaceId Renderer::AddSurface(std::span<const Triangle> triangles, std::span<const Vec3> rest,
                               Material material, std::span<const double> ambient_occlusion,
                               std::span<const Triangle> coarse) {
  return content_->surfaces.Add(triangles, rest, material, ambient_occlusion, coarse);
}

SurfaceId Renderer::AddSurface(const geometry::TriangleMesh& mesh, Material material,
                               std::span<const double> ambient_occlusion) {
  return AddSurface(mesh.triangles, mesh.positions, material, ambient_occlusion);
}

void Renderer::UpdateSurface(SurfaceId id, std::span<const Vec3> positions, std::span<const Vec3> normals) {
  Surface* surface = content_->surfaces.Find(id);
  TROCAR_ASSERT(surface != nullptr && positions.size() == surface->vertex_count &&
                normals.size() == positions.size());
  if (surface != nullptr) content_->surfaces.UploadMoving(*surface, positions, normals);
}

void Renderer::UpdateMarks(SurfaceId id, std::span<const SurfaceMark> marks) {
  Surface* surface = content_->surfaces.Find(id);
  TROCAR_ASSERT(surface != nullptr && marks.size() == surface->vertex_count);
  if (surface != nullptr) SurfaceStore::UploadMarks(*surface, marks);
}

void Renderer::UpdateTriangles(SurfaceId id, std::span<const Triangle> triangles) {
  Surface* surface = content_->surfaces.Find(id);
  TROCAR_ASSERT(surface != nullptr);
  if (surface != nullptr) SurfaceStore::UploadTriangles(*surface, triangles, {});
}

void Renderer::RemoveSurface(SurfaceId id) {
  content_->surfaces.Remove(id);
}

void Renderer::Draw(const Frame& frame, int width, int height) {
  if (width < 1 || height < 1) return;
  Content& c = *content_;
  // a toolkit may have left anything behind
  for (const GLenum state :
       {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL}) {
    glDisable(state);
  }
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  if (!frame.has_automatic_exposure) {
    DrawOnce(frame, frame.exposure, static_cast<unsigned>(target), width, height);
    return;
  }
  do {
    const double exposure = frame.exposure * c.meter.Next(frame.time);
    DrawOnce(frame, exposure, static_cast<unsigned>(target), width, height);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(target));
    c.meter.Look(frame.has_mask, width, height);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(target));
  } while (c.meter.IsToBeDrawnAgain());
}

void Renderer::DrawOnce(const Frame& frame, double exposure, unsigned target, int target_width,
                        int target_height) {
  Content& c = *content_;
  const double resolution = std::clamp(frame.resolution, kLeastResolution, 1.0);
  const int inner_width = std::max(1, static_cast<int>(std::lround(resolution * target_width)));
  const int inner_height = std::max(1, static_cast<int>(std::lround(resolution * target_height)));
  const bool is_smoothed = (frame.has_smooth_edges || !frame.blots.empty()) && !frame.is_wireframe &&
                           c.round.Bind(inner_width, inner_height);
  if (!is_smoothed) glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target);
  const int width = is_smoothed ? inner_width : target_width;
  const int height = is_smoothed ? inner_height : target_height;
  ClearPicture(frame, width, height);
  // first, at the near plane: what lies outside the circle is then never shaded
  glDisable(GL_CULL_FACE);
  if (frame.has_mask) c.round.DrawMask(width, height);

  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  if (frame.is_wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  const Pose X_camera_world = math::Inverse(frame.camera.X_world_camera);
  c.SetUniforms(frame, X_camera_world, exposure, width, height);
  c.surface_drawer.Begin(frame.quality, frame.tool_wear, height <= kCoarseHeight);
  c.DrawScene(frame, {X_camera_world, CalcFocalLength(frame.camera, height), 0.5 * width, 0.5 * height});
  if (frame.is_wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  SurfaceDrawer::End();
  if (is_smoothed) {
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    c.round.DrawSmoothed({frame.has_mask, frame.quality == Quality::kHigh, frame.blots}, target_width,
                         target_height);
  }
  glBindVertexArray(0);
  glUseProgram(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
}

base::Status Renderer::DrawGeometry(const Frame& frame, const MaterialLabels& fine, int width, int height,
                                    GeometryPicture& picture) {
  return DrawGeometryNow(frame, fine, width, height, false, picture);
}

base::Status Renderer::DrawGeometryAndFlow(const Frame& frame, const MaterialLabels& fine, int width,
                                           int height, GeometryPicture& picture) {
  return DrawGeometryNow(frame, fine, width, height, true, picture);
}

base::Status Renderer::DrawGeometryNow(const Frame& frame, const MaterialLabels& fine, int width, int height,
                                       bool has_flow, GeometryPicture& picture) {
  Content& c = *content_;
  for (const GLenum state :
       {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB, GL_POLYGON_OFFSET_FILL}) {
    glDisable(state);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthRange(0.0, 1.0);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  if (const auto status =
          c.geometry.Begin(MakeProjection(frame.camera, width, height), width, height, has_flow);
      !status)
    return status;
  const Pose X_camera_world = math::Inverse(frame.camera.X_world_camera);
  c.DrawGeometry(frame, fine,
                 {X_camera_world, CalcFocalLength(frame.camera, height), 0.5 * width, 0.5 * height},
                 has_flow);
  c.geometry.Read(picture, has_flow);
  if (has_flow) c.Remember(frame, X_camera_world);
  glBindVertexArray(0);
  glUseProgram(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  if (!frame.has_mask) return {};
  const double radius = 0.5 * kMaskDiameter * height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (std::hypot(x + 0.5 - 0.5 * width, y + 0.5 - 0.5 * height) <= radius) continue;
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      picture.labels[i] = 0;
      picture.depth[i] = 0;
      std::fill_n(picture.normals.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0.0f);
      if (has_flow)
        std::fill_n(picture.flow.begin() + static_cast<std::ptrdiff_t>(2 * i), 2,
                    std::numeric_limits<float>::quiet_NaN());
    }
  }
  return {};
}

geometry::TriangleMesh Renderer::ReadSurface(SurfaceId id) const {
  const Surface* surface = content_->surfaces.Find(id);
  return surface != nullptr ? SurfaceStore::Read(*surface) : geometry::TriangleMesh{};
}

double CalcFocalPixels(const Camera& camera, int height) {
  return CalcFocalLength(camera, height);
}

math::Vec2 CalcPixel(const Camera& camera, const Vec3& p_world, int width, int height) {
  const Vec3 p = math::Inverse(camera.X_world_camera) * p_world;
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  if (!(p.z < 0.0)) return {kNowhere, kNowhere};
  const double focal = CalcFocalLength(camera, height);
  // pixel centres lie at whole numbers
  return {0.5 * width - 0.5 + focal * p.x / -p.z, 0.5 * height - 0.5 - focal * p.y / -p.z};
}

}  // namespace trocar::render
