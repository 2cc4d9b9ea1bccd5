// SPDX-License-Identifier: Apache-2.0
#include "clip_shapes.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/view/labels.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kThick = 0.00075;    // m, of the strip, in the plane of the bend
constexpr double kBroad = 0.0013;     // m, along what it closes
constexpr double kChamfer = 0.00018;  // m
constexpr double kSameGap = 1e-6;     // m; a smaller change is not seen
constexpr int kLegSteps = 5, kBendSteps = 10;
constexpr std::uint32_t kAround = 8;

/// One cross-section of the strip: its middle, and the direction from the inside of the bend to the outside.
void AddSection(geometry::TriangleMesh& mesh, const Vec3& middle, const Vec3& out, double size) {
  const double u = 0.5 * kThick * size, w = 0.5 * kBroad * size, c = kChamfer * size;
  const double corners[kAround][2] = {{u - c, w},  {u, w - c},  {u, c - w},  {u - c, -w},
                                      {c - u, -w}, {-u, c - w}, {-u, w - c}, {c - u, w}};
  for (const auto& corner : corners)
    mesh.positions.push_back(middle + corner[0] * out + Vec3{0, 0, corner[1]});
}

}  // namespace

geometry::TriangleMesh MakeClip(double gap) {
  gap = std::max(gap, 0.0);
  const double half = 0.5 * (gap + kThick), tip = 0.5 * kClipLength;
  // the bend: half an ellipse, blunt where the clip is open
  const double bend = std::min(0.0024, half), root = -tip + 0.5 * kThick + bend;
  geometry::TriangleMesh mesh;
  for (int i = 0; i <= kLegSteps; ++i) {
    const double share = static_cast<double>(i) / kLegSteps;
    AddSection(mesh, {tip + share * (root - tip), half, 0}, {0, 1, 0}, i == 0 ? 0.7 : 1.0);
  }
  for (int i = 1; i < kBendSteps; ++i) {
    const double angle = M_PI * i / kBendSteps;
    const Vec3 out = math::Normalized(Vec3{-half * std::sin(angle), bend * std::cos(angle), 0});
    AddSection(mesh, {root - bend * std::sin(angle), half * std::cos(angle), 0}, out, 1.0);
  }
  for (int i = 0; i <= kLegSteps; ++i) {
    const double share = static_cast<double>(i) / kLegSteps;
    AddSection(mesh, {root + share * (tip - root), -half, 0}, {0, -1, 0}, i == kLegSteps ? 0.7 : 1.0);
  }
  const auto rings = static_cast<std::uint32_t>(mesh.positions.size()) / kAround;
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t next = (i + 1) % kAround, low = ring * kAround, high = low + kAround;
      mesh.triangles.push_back({low + i, high + i, high + next});
      mesh.triangles.push_back({low + i, high + next, low + next});
    }
  }
  const std::uint32_t last = (rings - 1) * kAround;
  for (std::uint32_t i = 1; i + 1 < kAround; ++i) {
    mesh.triangles.push_back({0, i, i + 1});
    mesh.triangles.push_back({last, last + i + 1, last + i});
  }
  if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0.0)
    for (geometry::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

void ClipShapes::AddTo(render::Renderer& renderer, render::Frame& frame,
                       const simulation::OperationSnapshot& operation) {
  const std::size_t count = std::min(operation.clip_count, operation.clips.size());
  for (std::size_t i = 0; i < count; ++i) {
    const surgery::ClipSnapshot& clip = operation.clips[i];
    if (i >= shown_.size()) {
      shown_.push_back({renderer.AddSurface(MakeClip(clip.gap), render::Material::kTitanium), clip.gap});
    } else if (std::abs(shown_[i].gap - clip.gap) > kSameGap) {
      const geometry::TriangleMesh mesh = MakeClip(clip.gap);
      std::vector<Vec3> normals(mesh.positions.size());
      geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
      renderer.UpdateSurface(shown_[i].surface, mesh.positions, normals);
      shown_[i].gap = clip.gap;
    }
    frame.surfaces.push_back({shown_[i].surface, clip.X_world_clip, MakeLabel(LabelClass::kClip, i)});
  }
}

}  // namespace trocar::view
