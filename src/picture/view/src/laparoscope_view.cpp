// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/laparoscope_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "band_view.h"
#include "clip_shapes.h"
#include "falciform_ligament.h"
#include "hand_tools.h"
#include "lens_smear.h"
#include "liquids.h"
#include "neighbour_view.h"
#include "object_view.h"
#include "omentum_drape.h"
#include "organ_shape.h"
#include "stone_view.h"
#include "strand_field.h"
#include "trainer_box.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/host/data_folder.h"
#include "trocar/patient/patient.h"
#include "trocar/render/ambient_occlusion.h"
#include "trocar/render/background.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/ground.h"
#include "trocar/view/labels.h"
#include "tube_shape.h"

namespace trocar::view {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using math::Pose;
using math::Vec3;
using render::Material;
using scene::SurfaceInfo;
using simulation::Snapshot;

constexpr double kLeastRise = 0.0015;  // m, of fat that covers a duct
constexpr double kBreathsPerSecond = 0.22;
constexpr Vec3 kBowelBreath{0, -0.0016, 0.0006}, kOmentumBreath{0, -0.0006, 0.0002};  // m, of a deep breath
constexpr double kOcclusionReach = 0.030;  // m; farther folds cast no soft shade
constexpr double kSmallestForce = 0.02;    // N; below, an arrow would only flicker
constexpr double kLongestArrow = 0.045;    // m
constexpr double kPoolChange = 0.0003;     // m; less does not change what is wet
constexpr double kArrowSetback =
    0.028;  // m from the tip back along the shaft: the working point stays in sight
constexpr double kArrowRadius = 0.0008;                                        // m
constexpr double kPathWidth = 0.0007;                                          // m
constexpr double kGhostWidth = 0.0014, kGhostJaw = 0.018, kGhostShaft = 0.15;  // m

/// Ambient occlusion of a surface that will move: averaged over neighbours and never dark, because where it lies
/// against another organ at rest it may later be pulled free.
std::vector<double> SoftenAmbientOcclusion(std::vector<double> ambient_occlusion,
                                           std::span<const Triangle> triangles) {
  constexpr int kRounds = 3;
  constexpr double kDarkest = 0.45;
  const geometry::Rows neighbours = geometry::FindVertexNeighbours(triangles, ambient_occlusion.size());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> next = ambient_occlusion;
    for (std::size_t i = 0; i < ambient_occlusion.size(); ++i) {
      const auto row = neighbours.Row(i);
      double sum = ambient_occlusion[i];
      for (const std::uint32_t j : row) sum += ambient_occlusion[j];
      next[i] = sum / static_cast<double>(row.size() + 1);
    }
    ambient_occlusion = std::move(next);
  }
  for (double& value : ambient_occlusion) value = kDarkest + (1.0 - kDarkest) * value;
  return ambient_occlusion;
}

}  // namespace

struct LaparoscopeView::Content {
  render::Renderer renderer;
  ViewOptions options;
  std::vector<OrganShape> organs;
  std::vector<TubeShape> tubes;
  std::vector<std::uint16_t> organ_labels, tube_labels;
  RowMemory memory, memory_at_start;
  std::optional<std::uint32_t> topology_version;  // that the shapes have
  HandTools tools;
  ClipShapes clips;
  StoneView stones;
  std::optional<StrandField> strands;
  std::optional<Pool> pool;
  std::vector<render::SurfaceDraw> background;
  std::vector<NeighbourView> neighbours;  // drawn as part of it
  /// Scenery that the diaphragm moves.
  struct Breathing {
    std::size_t draw;  // of the background
    Vec3 way;          // at the end of a breath [m]
  };
  std::vector<Breathing> breathing;
  /// Scenery on which liquid lies.
  struct Ground {
    render::SurfaceId surface;
    std::vector<Vec3> positions;
    std::vector<render::SurfaceMark> marks;
  };
  std::vector<Ground> ground_shapes;
  render::Puddle wet_by;  // of the last marks on them
  std::vector<std::uint8_t> raw_rows;
  ObjectView objects;
  BandView bands;
  LensSmear smear;
  double light_scale = 1;
  render::Frame frame;
  Overlay overlay;
  std::array<Vec3, instrument::kHandCount> forces, tips;

  explicit Content(render::Renderer made) : renderer(std::move(made)) {}

  base::Status AddShapes(std::span<const SurfaceInfo> surfaces, const Snapshot& start, bool has_patient) {
    const Film film(start);
    memory.Resize(start.positions.size());
    for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
      const SurfaceInfo& info = surfaces[i];
      auto material = render::FindMaterial(info.look);
      // an organ of which nothing is known is covered with serosa, as most of the abdomen's are
      if (!material && !info.triangles.empty() && info.organ == roles::OrganRole::kOther)
        material = Material::kBowel;
      if (!material) {
        return base::Error{base::ErrorCode::kUnknownName, "surface " + info.name + " looks like \"" +
                                                              info.look +
                                                              "\", which is no look; see render/material.h"};
      }
      TROCAR_ASSERT(std::size_t{info.first_node} + info.node_count <= start.positions.size());
      if (info.triangles.empty()) {
        tubes
            .emplace_back(info, i, *material, start.positions,
                          has_patient ? TubeLook::kLiving : TubeLook::kEven)
            .Update(start, film);
        tube_labels.push_back(MakeLabel(FindLabelClass(info, has_patient), i));
      } else {
        organs.emplace_back(info, i, *material).Update(start, film);
        organ_labels.push_back(MakeLabel(FindLabelClass(info, has_patient), i));
      }
    }
    return {};
  }

  /// The abdomen round the organs, and how open every surface lies in it.
  /// \param patient  brings its own neighbours; the rest is the usual one
  void AddSurroundings(std::span<const SurfaceInfo> surfaces, const Snapshot& start,
                       const patient::Patient& patient) {
    std::vector<Vec3> inside;
    std::vector<TriangleMesh> meshes;
    const auto surround = [&](const auto& shape) {
      const std::span<const Vec3> positions = shape.Positions();
      const std::span<const Triangle> triangles = shape.Triangles();
      inside.insert(inside.end(), positions.begin(), positions.end());
      meshes.push_back({{positions.begin(), positions.end()}, {triangles.begin(), triangles.end()}});
    };
    for (const OrganShape& organ : organs) surround(organ);
    const std::vector<Vec3> of_organs = inside;
    for (const TubeShape& tube : tubes) surround(tube);
    std::vector<roles::NeighbourRole> without;
    for (const patient::Neighbour& neighbour : patient.neighbours) {
      neighbours.emplace_back(neighbour, static_cast<std::int32_t>(neighbours.size()));
      meshes.push_back(neighbour.mesh);
      without.push_back(neighbour.role);
      if (!IsInCavity(neighbour.role)) continue;
      inside.insert(inside.end(), neighbour.mesh.positions.begin(), neighbour.mesh.positions.end());
    }
    auto parts =
        render::MakeAbdomen(inside, simulation::FindOmentumBalls(surfaces, start.positions), without);
    TriangleMesh ligament = MakeFalciformLigament(FindFalciform(surfaces, start, patient), parts.back().mesh);
    if (!ligament.triangles.empty())
      parts.insert(parts.end() - 1, {"falciform ligament", Material::kPeritoneum, std::move(ligament)});
    std::vector<double> raised;  // of the omentum's vertices
    for (auto& part : parts) {
      if (part.material == Material::kFat) {
        RoundRims(part.mesh);
        raised = DrapeOmentum(FindCoveredPlaces(FindTubeLines(surfaces, start), of_organs), part.mesh);
      }
      meshes.push_back(part.mesh);
    }
    std::vector<const TriangleMesh*> occluders;
    for (const TriangleMesh& mesh : meshes) occluders.push_back(&mesh);

    const auto add = [&](auto& shape) {
      shape.Add(renderer,
                SoftenAmbientOcclusion(render::CalcAmbientOcclusion(occluders, shape.Positions(),
                                                                    shape.Normals(), kOcclusionReach),
                                       shape.Triangles()),
                memory);
    };
    for (OrganShape& organ : organs) add(organ);
    for (TubeShape& tube : tubes) add(tube);
    memory_at_start = memory;
    std::vector<TriangleMesh> ground;
    AddNeighbours(occluders, ground);
    for (const auto& part : parts) {
      std::vector<Vec3> normals(part.mesh.positions.size());
      geometry::CalcVertexNormals(part.mesh.positions, part.mesh.triangles, normals);
      const auto ambient_occlusion =
          render::CalcAmbientOcclusion(occluders, part.mesh.positions, normals, kOcclusionReach);
      const auto draw = [&](std::span<const Triangle> triangles, LabelClass label) {
        const render::SurfaceId surface =
            renderer.AddSurface(triangles, part.mesh.positions, part.material, ambient_occlusion);
        renderer.UpdateSurface(surface, part.mesh.positions, normals);
        background.push_back({surface, {}, MakeLabel(label)});
        // the wall is a dome over everything
        if (part.material == Material::kPeritoneum) return;
        breathing.push_back(
            {background.size() - 1, part.material == Material::kFat ? kOmentumBreath : kBowelBreath});
        ground_shapes.push_back({surface, part.mesh.positions, {}});
      };
      if (part.material == Material::kFat) {
        // what covers ducts is the fat of their ligament
        std::vector<Triangle> over, other;
        for (const Triangle& t : part.mesh.triangles) {
          const double rise = raised[t[0]] + raised[t[1]] + raised[t[2]];
          (rise > 3.0 * kLeastRise ? over : other).push_back(t);
        }
        draw(over, LabelClass::kLigamentFat);
        draw(other, FindLabelClass(part.material));
      } else {
        draw(part.mesh.triangles, FindLabelClass(part.material));
      }
      if (part.material != Material::kPeritoneum) ground.push_back(part.mesh);
    }
    pool.emplace(std::move(ground));
  }

  /// \param[in,out] ground  on which liquid runs: bowel, and what fat covers
  void AddNeighbours(std::span<const TriangleMesh* const> occluders, std::vector<TriangleMesh>& ground) {
    for (NeighbourView& neighbour : neighbours) {
      const TriangleMesh& mesh = neighbour.Mesh();
      neighbour.Add(renderer, render::CalcAmbientOcclusion(occluders, mesh.positions, neighbour.Normals(),
                                                           kOcclusionReach));
      background.push_back({neighbour.Surface(), {}, MakeLabel(FindLabelClass(neighbour.GetMaterial()))});
      if (neighbour.GetMaterial() == Material::kPeritoneum) continue;
      ground_shapes.push_back({neighbour.Surface(), neighbour.FinePositions(), {}});
      ground.push_back(mesh);
    }
  }

  /// Where the falciform ligament leaves the liver [m].
  static std::vector<Vec3> FindFalciform(std::span<const SurfaceInfo> surfaces, const Snapshot& start,
                                         const patient::Patient& patient) {
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < std::min(patient.organs.size(), surfaces.size()); ++i) {
      const patient::Region* region = patient.organs[i].RegionOf(roles::RegionRole::kFalciform);
      if (region == nullptr) continue;
      for (const std::uint32_t v : region->vertices) {
        if (v < surfaces[i].node_count) places.push_back(start.positions[surfaces[i].first_node + v]);
      }
    }
    return places;
  }

  static std::vector<TubeLine> FindTubeLines(std::span<const SurfaceInfo> surfaces, const Snapshot& start) {
    std::vector<TubeLine> lines;
    for (const SurfaceInfo& info : surfaces) {
      if (!info.triangles.empty()) continue;
      const auto nodes = std::span(start.positions).subspan(info.first_node, info.node_count);
      const bool is_in_fat =
          info.tube == roles::TubeRole::kCommonBileDuct || info.tube == roles::TubeRole::kCommonHepaticDuct;
      lines.push_back({{nodes.begin(), nodes.end()}, info.radii[0], is_in_fat});
    }
    return lines;
  }

  /// A model of tissue in a box trainer: nothing lies near it.
  void AddModel() {
    const auto add = [&](auto& shape) {
      shape.Add(renderer, std::vector<double>(shape.Positions().size(), 1.0), memory);
    };
    for (OrganShape& organ : organs) add(organ);
    for (TubeShape& tube : tubes) add(tube);
    memory_at_start = memory;
  }

  /// Cuts: takes over connectivity where the snapshot brings one that is new.
  void FollowTopology(const Snapshot& snapshot) {
    const simulation::OperationSnapshot& operation = snapshot.operation;
    if (topology_version == operation.topology.version) return;
    // back at the start, or nearer to it: rows may come to mean something else
    if (topology_version && operation.topology.version < *topology_version) memory = memory_at_start;
    topology_version = operation.topology.version;
    memory.Resize(snapshot.positions.size());
    const auto triangles = std::span(operation.topology.triangles);
    for (std::size_t i = 0;
         i < std::min(organs.size(), operation.topology.first_triangle.size()) && !triangles.empty(); ++i) {
      organs[i].SetTriangles(
          triangles.subspan(operation.topology.first_triangle[i], operation.topology.triangle_count[i]),
          snapshot.positions, memory);
    }
    const std::size_t pieces =
        std::min(operation.topology.tube_piece_count, operation.topology.tube_pieces.size());
    if (pieces == 0) return;
    for (TubeShape& tube : tubes)
      tube.SetPieces(std::span(operation.topology.tube_pieces).first(pieces), memory, snapshot.positions);
  }

  Film MakeFilm(const Snapshot& snapshot) {
    Film film(snapshot);
    for (const render::Puddle& puddle : frame.puddles) film.AddPool(puddle);
    strands->FindRaw(snapshot, raw_rows);
    film.SetRaw(raw_rows);
    return film;
  }

  void UpdateShapes(const Snapshot& snapshot, const Film& film) {
    FollowTopology(snapshot);
    WetGround(film);
    for (std::size_t i = 0; i < tubes.size(); ++i) {
      TubeShape& tube = tubes[i];
      tube.Update(snapshot, film);
      tube.Upload(renderer, memory);
      frame.surfaces.push_back({tube.Lumens(), {}, tube_labels[i]});
      frame.surfaces.push_back({tube.Surface(), {}, tube_labels[i]});
      if (options.quality == render::Quality::kHigh) tube.AddRemnants(frame);
    }
    for (std::size_t i = 0; i < organs.size(); ++i) {
      organs[i].Update(snapshot, film);
      organs[i].Upload(renderer, memory);
      frame.surfaces.push_back({organs[i].Surface(), {}, organ_labels[i]});
    }
  }

  void ShapePool(const Snapshot& snapshot) {
    std::vector<GroundShape> ground;
    for (const OrganShape& organ : organs) ground.push_back({organ.Positions(), organ.Triangles()});
    pool->Shape(renderer, frame, snapshot, std::move(ground), strands->Fat());
  }

  /// Ventilation pushes the abdomen's contents towards the feet; organs of the model are held where they are.
  void Breathe(double time) {
    const double wave = std::sin(2.0 * M_PI * kBreathsPerSecond * time);
    for (const Breathing& part : breathing)
      background[part.draw].X_world_surface.translation = (0.5 + 0.5 * wave) * part.way;
  }

  /// The pool's shore on the scenery; it is asked anew when the pool has changed.
  void WetGround(const Film& film) {
    const render::Puddle now = frame.puddles.empty() ? render::Puddle{} : frame.puddles.back();
    if (math::Distance(now.centre, wet_by.centre) < kPoolChange &&
        std::abs(now.radius - wet_by.radius) < kPoolChange)
      return;
    wet_by = now;
    for (Ground& ground : ground_shapes) {
      ground.marks.assign(ground.positions.size(), {});
      for (std::size_t v = 0; v < ground.positions.size(); ++v)
        film.Wet(ground.positions[v], ground.marks[v]);
      renderer.UpdateMarks(ground.surface, ground.marks);
    }
  }

  void UpdateArrows() {
    frame.arrows.clear();
    if (!options.has_force_arrows) return;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const double force = math::Norm(forces[i]);
      if (!(force > kSmallestForce)) continue;
      const double length = std::min(kLongestArrow, options.arrow_scale * force);
      frame.arrows.push_back({tips[i], (length / force) * forces[i], kArrowRadius});
    }
  }
};

std::vector<Trail> MakePathTrails(std::span<const Vec3> left, std::span<const Vec3> right) {
  return {{{left.begin(), left.end()}, Material::kBlueRubber, kPathWidth},
          {{right.begin(), right.end()}, Material::kYellowRubber, kPathWidth}};
}

std::vector<Trail> MakeGhosts(const Snapshot& other) {
  std::vector<Trail> ghosts;
  for (const simulation::InstrumentSnapshot& now : other.instruments) {
    const Pose& X = now.X_world_tool;
    ghosts.push_back(
        {{X * Vec3{0, 0, kGhostJaw}, X * Vec3{0, 0, kGhostShaft}}, Material::kWhitePlastic, kGhostWidth});
    const double half = 0.5 * now.joints.jaw;
    for (const double side : {-1.0, 1.0}) {
      const Vec3 p_tool_end{0, side * kGhostJaw * std::sin(half), kGhostJaw * (1 - std::cos(half))};
      ghosts.push_back({{X * Vec3{0, 0, kGhostJaw}, X * p_tool_end}, Material::kWhitePlastic, kGhostWidth});
    }
  }
  return ghosts;
}

LaparoscopeView::LaparoscopeView(std::unique_ptr<Content> content) : content_(std::move(content)) {}
LaparoscopeView::LaparoscopeView(LaparoscopeView&&) noexcept = default;
LaparoscopeView& LaparoscopeView::operator=(LaparoscopeView&&) noexcept = default;
LaparoscopeView::~LaparoscopeView() = default;

base::Result<LaparoscopeView> LaparoscopeView::Make(const scene::Scene& scene,
                                                    std::span<const SurfaceInfo> surfaces,
                                                    const Snapshot& start,
                                                    std::span<const scene::StrandInfo> strands) {
  const auto data = host::FindDataFolder();
  if (!data) return data.error();
  const auto looks = render::ReadLooks(*data / render::kLooksFile);
  if (!looks) return looks.error();
  auto renderer = render::Renderer::Make(*looks);
  if (!renderer) return renderer.error();
  auto content = std::make_unique<Content>(std::move(*renderer));
  if (auto status = content->AddShapes(surfaces, start, scene.HasPatient()); !status) return status.error();
  content->tools.Add(content->renderer, scene);
  content->objects.Add(content->renderer, scene, start);
  content->bands.Add(content->renderer, scene, strands, start.positions);
  if (!HasTrainerBox(scene)) {
    content->AddSurroundings(surfaces, start, scene.patient);
  } else {
    content->AddModel();
    content->light_scale = looks->trainer_light;
    content->frame.overhead = {math::Normalized(-start.gravity, {0, 0, 1}), looks->trainer_lid};
    content->background.push_back({content->objects.Walls(), {}, MakeLabel(LabelClass::kTrainerBox)});
  }
  content->strands.emplace(strands, start.positions);
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
void LaparoscopeView::SetOverlay(Overlay overlay) {
  content_->overlay = std::move(overlay);
}
const render::Frame& LaparoscopeView::GetFrame() const {
  return content_->frame;
}

void LaparoscopeView::Update(const Snapshot& snapshot) {
  Content& c = *content_;
  c.frame.camera.X_world_camera = snapshot.X_world_laparoscope;
  c.frame.surfaces.clear();
  c.frame.shades.clear();
  c.frame.fibres.clear();
  c.frame.blobs.clear();
  c.frame.puddles.clear();
  c.frame.puffs.clear();
  c.smear.Update(snapshot);
  c.tools.AddTo(c.frame, snapshot);
  c.clips.AddTo(c.renderer, c.frame, snapshot.operation);
  c.stones.AddTo(c.renderer, c.frame, snapshot.operation);
  if (c.pool) c.pool->AddTo(c.frame, snapshot);
  const Film film = c.MakeFilm(snapshot);
  c.UpdateShapes(snapshot, film);
  for (NeighbourView& neighbour : c.neighbours) neighbour.Update(c.renderer, snapshot);
  c.Breathe(snapshot.time);
  c.strands->AddTo(c.renderer, c.frame, snapshot, film);
  if (c.pool) c.ShapePool(snapshot);
  AddStreams(c.frame, snapshot);
  c.frame.smoke = snapshot.operation.smoke;
  c.frame.time = snapshot.time;
  for (std::size_t i = 0; i < c.forces.size(); ++i) {
    c.forces[i] = snapshot.instruments[i].force;
    c.tips[i] = snapshot.instruments[i].X_world_tool * Vec3{0, 0, kArrowSetback};
  }
  c.bands.Append(snapshot, c.frame.surfaces);
  c.objects.Append(snapshot, c.frame.surfaces);
  c.objects.AppendShades(snapshot, c.frame);
  c.UpdateArrows();
}

void LaparoscopeView::Draw(int width, int height) {
  Content& c = *content_;
  c.frame.has_mask = c.options.has_mask;
  c.frame.is_wireframe = c.options.is_wireframe;
  c.frame.has_smooth_edges = c.options.has_smooth_edges;
  c.frame.light_power = c.light_scale * std::clamp(c.options.light_power, 0.0, 4.0);
  c.frame.has_automatic_exposure = c.options.has_automatic_exposure;
  c.frame.quality = c.options.quality;
  c.frame.resolution = c.options.resolution;
  c.frame.tool_wear = c.options.tool_wear;
  c.frame.blots = c.options.stains;
  c.frame.blots.insert(c.frame.blots.end(), c.smear.Blots().begin(), c.smear.Blots().end());
  c.UpdateArrows();
  const std::size_t foreground = c.frame.surfaces.size();
  if (c.options.has_background)
    c.frame.surfaces.insert(c.frame.surfaces.end(), c.background.begin(), c.background.end());
  const std::size_t fibres = c.frame.fibres.size();
  for (const Trail& trail : c.overlay.trails) {
    for (std::size_t i = 0; i + 1 < trail.points.size(); ++i)
      c.frame.fibres.push_back({trail.points[i], trail.points[i + 1], trail.width, 0, trail.material, 0});
  }
  const Pose X_world_laparoscope = c.frame.camera.X_world_camera;
  if (c.overlay.X_world_camera) {
    c.frame.camera.X_world_camera = *c.overlay.X_world_camera;
    c.frame.blots.clear();  // they stick to another lens
  }
  c.renderer.Draw(c.frame, width, height);
  c.frame.camera.X_world_camera = X_world_laparoscope;
  c.frame.fibres.resize(fibres);
  c.frame.surfaces.resize(foreground);
}

base::Status LaparoscopeView::DrawGeometry(int width, int height, render::GeometryPicture& picture) {
  return DrawGeometryNow(width, height, false, picture);
}

base::Status LaparoscopeView::DrawGeometryAndFlow(int width, int height, render::GeometryPicture& picture) {
  return DrawGeometryNow(width, height, true, picture);
}

base::Status LaparoscopeView::DrawGeometryNow(int width, int height, bool has_flow,
                                              render::GeometryPicture& picture) {
  Content& c = *content_;
  c.frame.has_mask = c.options.has_mask;
  const std::size_t foreground = c.frame.surfaces.size();
  if (c.options.has_background)
    c.frame.surfaces.insert(c.frame.surfaces.end(), c.background.begin(), c.background.end());
  const Pose X_world_laparoscope = c.frame.camera.X_world_camera;
  if (c.overlay.X_world_camera) c.frame.camera.X_world_camera = *c.overlay.X_world_camera;
  const render::MaterialLabels fine = MakeMaterialLabels();
  base::Status drawn = has_flow ? c.renderer.DrawGeometryAndFlow(c.frame, fine, width, height, picture)
                                : c.renderer.DrawGeometry(c.frame, fine, width, height, picture);
  c.frame.camera.X_world_camera = X_world_laparoscope;
  c.frame.surfaces.resize(foreground);
  return drawn;
}

std::vector<LabelledMesh> LaparoscopeView::ReadMeshes() const {
  const Content& c = *content_;
  std::vector<LabelledMesh> meshes;
  const auto read = [&](const render::SurfaceDraw& draw) {
    LabelledMesh mesh{c.renderer.ReadSurface(draw.surface), draw.label};
    for (Vec3& p : mesh.mesh.positions) p = draw.X_world_surface * p;
    meshes.push_back(std::move(mesh));
  };
  for (const render::SurfaceDraw& draw : c.frame.surfaces) read(draw);
  if (c.options.has_background) {
    for (const render::SurfaceDraw& draw : c.background) read(draw);
  }
  return meshes;
}

double LaparoscopeView::FocalLength(int height) const {
  return render::CalcFocalPixels(content_->frame.camera, height);
}

}  // namespace trocar::view
