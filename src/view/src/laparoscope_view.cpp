// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/laparoscope_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "object_view.h"
#include "trocar/core/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/tube.h"
#include "trocar/instrument/tool.h"
#include "trocar/render/background.h"
#include "trocar/render/openness.h"
#include "trocar/render/surface_refiner.h"

namespace trocar::view {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using instrument::ToolPart;
using math::Pose;
using math::Vec3;
using render::Material;
using session::Snapshot;
using session::SurfaceInfo;

constexpr int kTubeSides = 12;
constexpr double kOpennessReach = 0.030;   // m; farther folds cast no soft shade
constexpr double kSleeveRadius = 0.0042;   // m, of a 5 mm trocar
constexpr double kSleeveInside = 0.012;    // m that it stands out of the wall, inwards
constexpr double kSleeveOutside = 0.060;   // m
constexpr double kSleeveMaxBore = 0.0034;  // m; a thicker shaft gets a wider sleeve
constexpr double kShadeLength = 0.120;     // m of a shaft that shades tissue
constexpr double kSmallestForce = 0.02;    // N; below, an arrow would only flicker
constexpr double kTrainerLight = 1.8;      // of a box trainer, whose walls are darker than tissue and farther
constexpr double kLongestArrow = 0.045;    // m

/// Shape of one deforming surface, from snapshot nodes to the vertices that are drawn.
struct Shape {
  SurfaceInfo info;
  render::SurfaceId surface;
  std::vector<Triangle> triangles;                 // of the coarse surface
  std::vector<Vec3> positions, normals;            // coarse
  std::optional<render::SurfaceRefiner> refiner;   // organs
  std::vector<Vec3> fine_positions, fine_normals;  // when refined

  explicit Shape(const SurfaceInfo& surface_info) : info(surface_info) {
    const bool is_tube = info.triangles.empty();
    triangles = is_tube ? geometry::MakeTubeTriangles(info.node_count, kTubeSides) : info.triangles;
    positions.resize(is_tube ? info.node_count * std::size_t{kTubeSides} + 2 : info.node_count);
    normals.resize(positions.size());
    if (is_tube) return;
    refiner.emplace(triangles, positions.size());
    fine_positions.resize(refiner->VertexCount());
    fine_normals.resize(refiner->VertexCount());
  }

  void Update(const Snapshot& snapshot) {
    const auto nodes = std::span(snapshot.positions).subspan(info.first_node, info.node_count);
    if (info.triangles.empty()) {
      geometry::CalcTubeSkin(nodes, info.radii, kTubeSides, positions);
    } else {
      std::copy(nodes.begin(), nodes.end(), positions.begin());
    }
    geometry::CalcVertexNormals(positions, triangles, normals);
    if (refiner) refiner->Refine(positions, normals, fine_positions, fine_normals);
  }

  std::span<const Triangle> DrawnTriangles() const { return refiner ? refiner->Triangles() : triangles; }
  const std::vector<Vec3>& DrawnPositions() const { return refiner ? fine_positions : positions; }
  const std::vector<Vec3>& DrawnNormals() const { return refiner ? fine_normals : normals; }
};

/// One rigid part of an instrument.
struct Part {
  ToolPart::Kind kind;
  render::SurfaceId surface;
};

struct Hand {
  instrument::Tool tool;
  Vec3 p_world_port;
  std::vector<Part> parts;
  render::SurfaceId sleeve;
};

/// Openness of a surface that will move: averaged over neighbours and never dark, because where it lies
/// against another organ at rest it may later be pulled free.
std::vector<double> SoftenOpenness(std::vector<double> openness, std::span<const Triangle> triangles) {
  constexpr int kRounds = 4;
  constexpr double kDarkest = 0.45;
  const geometry::Rows neighbours = geometry::FindVertexNeighbours(triangles, openness.size());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> next = openness;
    for (std::size_t i = 0; i < openness.size(); ++i) {
      const auto row = neighbours.Row(i);
      double sum = openness[i];
      for (const std::uint32_t j : row) sum += openness[j];
      next[i] = sum / static_cast<double>(row.size() + 1);
    }
    openness = std::move(next);
  }
  for (double& value : openness) value = kDarkest + (1.0 - kDarkest) * value;
  return openness;
}

TriangleMesh MakeSleeve(double shaft_radius) {
  const double radius = kSleeveRadius + std::max(0.0, shaft_radius - kSleeveMaxBore);
  // the inner end is bevelled
  return geometry::MakeTube({{{0, 0, -kSleeveInside}, {0, 0, -kSleeveInside + 0.002}, {0, 0, kSleeveOutside}},
                             {0.88 * radius, radius, radius}},
                            24);
}

}  // namespace

struct LaparoscopeView::Content {
  render::Renderer renderer;
  ViewOptions options;
  std::vector<Shape> shapes;
  std::array<Hand, session::kHandCount> hands;
  std::vector<render::SurfaceDraw> background;
  ObjectView objects;
  double light_scale = 1;
  render::Frame frame;
  std::array<Vec3, session::kHandCount> forces, tips;

  explicit Content(render::Renderer made) : renderer(std::move(made)) {}

  core::Status AddShapes(std::span<const SurfaceInfo> surfaces, const Snapshot& start,
                         std::vector<Material>& materials) {
    for (const SurfaceInfo& info : surfaces) {
      const auto material = render::FindMaterial(info.material);
      if (!material) {
        return core::Error{core::ErrorCode::kUnknownName, "surface " + info.name + " has the material \"" +
                                                              info.material +
                                                              "\", which has no look; see render/material.h"};
      }
      TROCAR_ASSERT(std::size_t{info.first_node} + info.node_count <= start.positions.size());
      materials.push_back(*material);
      shapes.emplace_back(info).Update(start);
    }
    return {};
  }

  void AddInstruments(const session::Scene& scene) {
    for (int h = 0; h < session::kHandCount; ++h) {
      const auto i = static_cast<std::size_t>(h);
      hands[i].tool = scene.instruments[i].tool;
      hands[i].p_world_port = scene.instruments[i].p_world_port;
      for (const ToolPart& part : instrument::MakeParts(hands[i].tool)) {
        const bool is_shaft = part.kind == ToolPart::Kind::kShaft;
        hands[i].parts.push_back(
            {part.kind, renderer.AddSurface(part.mesh, is_shaft ? Material::kShaft : Material::kSteel)});
      }
      hands[i].sleeve = renderer.AddSurface(MakeSleeve(hands[i].tool.shaft_radius), Material::kSleeve);
    }
  }

  /// The abdomen round the organs, and how open every surface lies in it.
  void AddSurroundings(const std::vector<Material>& materials) {
    std::vector<Vec3> inside;
    std::vector<render::Obstacle> above;
    std::vector<TriangleMesh> meshes;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Shape& shape = shapes[i];
      inside.insert(inside.end(), shape.positions.begin(), shape.positions.end());
      // the liver lies on bowel and omentum, everything smaller must stay in sight
      if (materials[i] != Material::kLiver) {
        for (std::size_t v = 0; v < shape.positions.size(); v += 3)
          above.push_back({shape.positions[v], 0.002});
      }
      meshes.push_back({shape.positions, shape.triangles});
    }
    auto parts = render::MakeAbdomen(inside, above);
    for (auto& part : parts) meshes.push_back(part.mesh);
    std::vector<const TriangleMesh*> occluders;
    for (const TriangleMesh& mesh : meshes) occluders.push_back(&mesh);

    for (std::size_t i = 0; i < shapes.size(); ++i) {
      Shape& shape = shapes[i];
      const auto openness = SoftenOpenness(
          render::CalcOpenness(occluders, shape.DrawnPositions(), shape.DrawnNormals(), kOpennessReach),
          shape.DrawnTriangles());
      shape.surface =
          renderer.AddSurface(shape.DrawnTriangles(), shape.DrawnPositions(), materials[i], openness);
    }
    for (const auto& part : parts) {
      std::vector<Vec3> normals(part.mesh.positions.size());
      geometry::CalcVertexNormals(part.mesh.positions, part.mesh.triangles, normals);
      const auto openness = render::CalcOpenness(occluders, part.mesh.positions, normals, kOpennessReach);
      background.push_back({renderer.AddSurface(part.mesh, part.material, openness), {}});
    }
  }

  void UpdateInstruments(const Snapshot& snapshot) {
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const Hand& hand = hands[i];
      const session::InstrumentSnapshot& now = snapshot.instruments[i];
      for (const Part& part : hand.parts) {
        const Pose X_tool_part = instrument::CalcPartPose(hand.tool, part.kind, now.joints.jaw);
        frame.surfaces.push_back({part.surface, now.X_world_tool * X_tool_part});
      }
      frame.surfaces.push_back({hand.sleeve, {now.X_world_tool.rotation, hand.p_world_port}});
      frame.shades.push_back({now.X_world_tool * Vec3{0, 0, 0.5 * hand.tool.jaw_width},
                              now.X_world_tool * Vec3{0, 0, kShadeLength}, hand.tool.shaft_radius});
      forces[i] = now.force;
      tips[i] = now.X_world_tool.translation;
    }
  }

  void UpdateArrows() {
    frame.arrows.clear();
    if (!options.has_force_arrows) return;
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const double force = math::Norm(forces[i]);
      if (!(force > kSmallestForce)) continue;
      const double length = std::min(kLongestArrow, options.arrow_scale * force);
      frame.arrows.push_back({tips[i], (length / force) * forces[i]});
    }
  }
};

LaparoscopeView::LaparoscopeView(std::unique_ptr<Content> content) : content_(std::move(content)) {}
LaparoscopeView::LaparoscopeView(LaparoscopeView&&) noexcept = default;
LaparoscopeView& LaparoscopeView::operator=(LaparoscopeView&&) noexcept = default;
LaparoscopeView::~LaparoscopeView() = default;

core::Result<LaparoscopeView> LaparoscopeView::Make(const session::Scene& scene,
                                                    std::span<const SurfaceInfo> surfaces,
                                                    const Snapshot& start) {
  auto renderer = render::Renderer::Make();
  if (!renderer) return renderer.error();
  auto content = std::make_unique<Content>(std::move(*renderer));
  std::vector<Material> materials;
  if (auto status = content->AddShapes(surfaces, start, materials); !status) return status.error();
  content->AddInstruments(scene);
  content->objects.Add(content->renderer, scene);
  if (scene.HasPatient()) {
    content->AddSurroundings(materials);
  } else {
    content->light_scale = kTrainerLight;
    content->background.push_back(
        {content->renderer.AddSurface(MakeTrainerBox(scene), Material::kSleeve), {}});
  }
  content->frame.camera.field_of_view = scene.laparoscope.field_of_view;
  LaparoscopeView view(std::move(content));
  view.Update(start);
  return view;
}

void LaparoscopeView::SetOptions(const ViewOptions& options) {
  content_->options = options;
}
const ViewOptions& LaparoscopeView::GetOptions() const {
  return content_->options;
}
const render::Frame& LaparoscopeView::GetFrame() const {
  return content_->frame;
}

void LaparoscopeView::Update(const Snapshot& snapshot) {
  Content& c = *content_;
  c.frame.camera.X_world_camera = snapshot.X_world_laparoscope;
  c.frame.surfaces.clear();
  c.frame.shades.clear();
  c.UpdateInstruments(snapshot);
  // small surfaces first: they mostly lie in front, and what is hidden costs nothing
  std::vector<std::size_t> order(c.shapes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&c](std::size_t a, std::size_t b) {
    return c.shapes[a].info.node_count < c.shapes[b].info.node_count;
  });
  for (const std::size_t i : order) {
    Shape& shape = c.shapes[i];
    shape.Update(snapshot);
    c.renderer.UpdateSurface(shape.surface, shape.DrawnPositions(), shape.DrawnNormals());
    c.frame.surfaces.push_back({shape.surface, {}});
  }
  c.objects.Append(snapshot, c.frame.surfaces);
  c.UpdateArrows();
}

void LaparoscopeView::Draw(int width, int height) {
  Content& c = *content_;
  c.frame.has_mask = c.options.has_mask;
  c.frame.is_wireframe = c.options.is_wireframe;
  c.frame.has_smooth_edges = c.options.has_smooth_edges;
  c.frame.light_power = c.light_scale * std::clamp(c.options.light_power, 0.0, 4.0);
  c.UpdateArrows();
  const std::size_t foreground = c.frame.surfaces.size();
  if (c.options.has_background)
    c.frame.surfaces.insert(c.frame.surfaces.end(), c.background.begin(), c.background.end());
  c.renderer.Draw(c.frame, width, height);
  c.frame.surfaces.resize(foreground);
}

}  // namespace trocar::view
