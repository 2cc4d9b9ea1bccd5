// SPDX-License-Identifier: Apache-2.0
/// \file cutting.cpp  Cuts a patient's liver and gallbladder, draws the cuts apart, prints what each tick took and, where a
/// file is named, draws the two.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/openings.h"
#include "trocar/patient/patient.h"
#include "trocar/render/figure_picture.h"
#include "trocar/surgery/cuttable_organ.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/material.h"

namespace {

using namespace trocar;
using math::Vec3;

constexpr std::uint32_t kSpare = 600;
constexpr int kTicks = 90;
constexpr double kLength = 0.030;  // of a cut [m]

/// What the built-in materials say of a wall, SI.
struct Wall {
  roles::OrganRole organ;
  double young_modulus, thickness, foundation_modulus, depth;
  bool is_solid;
  Vec3 seen_from;
  double drawn;  // each side, to let the cut gape [m]
};
constexpr Wall kWalls[] = {
    {roles::OrganRole::kLiver, 1e6, 4e-5, 5400, 0.080, true, {-0.2, -0.45, 0.87}, 0.003},
    {roles::OrganRole::kGallbladder, 255e3, 0.002, 1000, 0.030, false, {-0.1, -0.75, 0.65}, 0.003}};

surgery::WallMaterial MakeWallMaterial(const geometry::TriangleMesh& mesh, const Wall& wall) {
  const double area = geometry::CalcArea(mesh.positions, mesh.triangles);
  const double height = std::sqrt(std::sqrt(3.0) * area / static_cast<double>(mesh.triangles.size()));
  return {wall.young_modulus * wall.thickness, tissue::CalcBendingShare(wall.thickness, height),
          wall.foundation_modulus / wall.depth,
          1060 * geometry::CalcVolume(mesh.positions, mesh.triangles) / area};
}

/// The organs, their system, and the processor time of each stage of a cutting tick.
struct Theatre {
  tissue::TissueDefinition definition;
  tissue::TissueModel model;
  tissue::TissueState state;
  std::vector<surgery::CuttableOrgan> organs;
  surgery::TopologyChange change;
  std::unique_ptr<tissue::EquilibriumSolver> solver;
  std::array<double, 5> worst{}, sum{};  // [s]
  int cutting_ticks = 0;
};
constexpr const char* kStages[] = {"cut", "change", "model", "solver", "solve"};

base::Status AddOrgan(const patient::Organ& organ, const Wall& wall, Theatre& theatre) {
  auto& definition = theatre.definition;
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  surgery::CuttableOrganSettings settings;
  settings.wall = MakeWallMaterial(organ.mesh, wall);
  settings.cut.has_walls = wall.is_solid;
  settings.first_node = first;
  definition.rest.insert(definition.rest.end(), organ.mesh.positions.begin(), organ.mesh.positions.end());
  for (const double area : geometry::CalcVertexAreas(organ.mesh.positions, organ.mesh.triangles)) {
    definition.mass.push_back(settings.wall.mass_by_area * area);
    definition.shape_stiffness.push_back(settings.wall.foundation * area);
  }
  for (tissue::Spring spring : surgery::CalcWallSprings(organ.mesh, settings.wall)) {
    spring.a += first, spring.b += first;
    definition.springs.push_back(spring);
  }
  settings.first_spare = surgery::AddSpareNodes(kSpare, definition);
  settings.spare_count = kSpare;
  auto cuttable = surgery::CuttableOrgan::Make(organ.mesh, settings);
  if (!cuttable.ok()) return cuttable.error();
  cuttable->ReserveFor(theatre.change);
  theatre.organs.push_back(std::move(*cuttable));
  return {};
}

/// Where an organ is cut, and how it is looked at.
struct Site {
  Vec3 middle, out, along, across;
};

/// The place whose surface faces `seen_from` best, near to the gallbladder's fundus.
Site FindSite(const geometry::TriangleMesh& mesh, const Vec3& seen_from, const Vec3& near) {
  std::vector<Vec3> normals(mesh.positions.size());
  geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
  std::size_t best = 0;
  const auto score = [&](std::size_t v) {
    return math::Dot(normals[v], seen_from) - 12.0 * math::Distance(mesh.positions[v], near);
  };
  for (std::size_t v = 1; v < normals.size(); ++v) {
    if (score(v) > score(best)) best = v;
  }
  Site site{mesh.positions[best], normals[best], {}, {}};
  site.across = math::Normalized(math::Cross(site.out, {0, 1, 0}));
  site.along = math::Cross(site.across, site.out);
  return site;
}

/// Cuts through a site in kTicks ticks. Between them the tissue comes to rest.
geometry::CutReport CutThrough(const Site& site, std::size_t index, Theatre& theatre) {
  geometry::CutFront front;
  geometry::CutReport sum;
  const auto blade = [&](int tick) {
    const Vec3 at = site.middle + kLength * (static_cast<double>(tick) / kTicks - 0.5) * site.along;
    return geometry::BladeEdge{at - 0.008 * site.out, at + 0.008 * site.out};
  };
  for (int tick = 1; tick <= kTicks; ++tick) {
    std::array<double, 6> at{};
    const auto now = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    at[0] = now();
    theatre.change.Clear();
    const auto report = theatre.organs[index].Cut(blade(tick - 1), blade(tick), theatre.state.position, front,
                                                  theatre.change);
    at[1] = now();
    if (theatre.change.IsEmpty()) continue;
    const auto origins = surgery::ApplyChange(theatre.change, theatre.definition);
    at[2] = now();
    theatre.model = tissue::MakeTissueModel(theatre.definition);
    surgery::ApplyChange(theatre.change, origins, theatre.model, theatre.state);
    at[3] = now();
    theatre.solver->UpdateTopology(theatre.model);
    at[4] = now();
    theatre.solver->Solve({}, {}, theatre.state);
    at[5] = now();
    ++theatre.cutting_ticks;
    for (std::size_t i = 0; i < 5; ++i) {
      theatre.worst[i] = std::max(theatre.worst[i], at[i + 1] - at[i]);
      theatre.sum[i] += at[i + 1] - at[i];
    }
    sum.opened += report.opened;
    sum.copies += report.copies;
    sum.wall_triangles += report.wall_triangles;
    sum.refused += report.refused;
  }
  return sum;
}

/// Takes hold of both sides of a cut and draws them apart.
void DrawApart(const Site& site, std::size_t index, double distance, Theatre& theatre) {
  const auto& mesh = theatre.organs[index].Mesh();
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v) {
    const Vec3 from = mesh.Rest()[v] - site.middle;
    const double side = math::Dot(from, site.across), along = math::Dot(from, site.along);
    if (std::fabs(along) > 0.010 || std::fabs(side) < 0.007 || std::fabs(side) > 0.018 ||
        std::fabs(math::Dot(from, site.out)) > 0.012)
      continue;
    const std::uint32_t node = theatre.organs[index].Node(v);
    theatre.state.condition[node] = tissue::NodeCondition::kPrescribed;
    theatre.state.position[node] += (side > 0 ? distance : -distance) * site.across;
  }
  for (int tick = 0; tick < 100; ++tick) theatre.solver->Solve({}, {}, theatre.state);
}

/// The organ as two surfaces, so that the rim of a trench is sharp.
std::vector<render::FigureSurface> MakeFigure(const Theatre& theatre, std::size_t index, bool has_edges) {
  const auto& organ = theatre.organs[index];
  const auto& mesh = organ.Mesh();
  render::FigureSurface outside, inside;
  for (std::uint32_t v = 0; v < mesh.VertexCount(); ++v)
    outside.positions.push_back(theatre.state.position[organ.Node(v)]);
  inside.positions = outside.positions;
  outside.colours = {index == 0 ? render::SrgbColour{0.66, 0.36, 0.31}
                                : render::SrgbColour{0.49, 0.62, 0.38}};
  inside.colours = {index == 0 ? render::SrgbColour{0.45, 0.08, 0.07} : render::SrgbColour{0.75, 0.68, 0.30}};
  outside.has_edges = inside.has_edges = has_edges;
  for (std::size_t t = 0; t < mesh.TriangleCount(); ++t) {
    const bool is_wall = mesh.Kinds()[t] == geometry::TriangleKind::kWall;
    (is_wall ? inside : outside).triangles.push_back(mesh.Triangles()[t]);
  }
  return {outside, inside};
}

base::Status DrawSites(const Theatre& theatre, const std::array<Site, 2>& sites, const std::string& file) {
  std::vector<render::Image> pictures;
  for (const bool has_edges : {false, true}) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Site& site = sites[i];
      // from aside, to look into the cut
      const Vec3 back = math::Normalized(site.out + 0.25 * site.across - 0.2 * site.along);
      render::OrbitCamera camera;
      camera.target = site.middle;
      camera.distance = 0.095;
      const Vec3 right = math::Normalized(math::Cross(site.along, back));
      camera.R_world_camera = math::RotationFromAxes(right, math::Cross(back, right), back);
      auto drawn = render::DrawPictures(MakeFigure(theatre, i, has_edges), {}, {&camera, 1}, {}, 700, 560);
      if (!drawn.ok()) return drawn.error();
      pictures.push_back(std::move(drawn->front()));
    }
  }
  return render::WritePng(file, render::TilePictures(pictures, 2));
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2 || count > 3) {
    std::fprintf(stderr, "usage: %s assets/patients/visible-human-male/patient [cuts.png]\n", arguments[0]);
    return 2;
  }
  const auto fail = [](const base::Error& error) {
    std::fprintf(stderr, "%s\n", error.Text().c_str());
    return 1;
  };
  const auto patient = files::ReadPatient(arguments[1]);
  if (!patient.ok()) return fail(patient.error());
  Theatre theatre;
  std::array<Site, 2> sites;
  const int gallbladder = patient->OrganOf(roles::OrganRole::kGallbladder);
  if (gallbladder < 0 || patient->OrganOf(roles::OrganRole::kLiver) < 0) {
    std::fprintf(stderr, "the patient has no liver or no gallbladder\n");
    return 1;
  }
  const auto& fundus_of = patient->organs[static_cast<std::size_t>(gallbladder)].mesh.positions;
  const Vec3 fundus = *std::min_element(fundus_of.begin(), fundus_of.end(),
                                        [](const Vec3& a, const Vec3& b) { return a.y - a.z < b.y - b.z; });
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& organ = patient->organs[static_cast<std::size_t>(patient->OrganOf(kWalls[i].organ))];
    if (const auto added = AddOrgan(organ, kWalls[i], theatre); !added.ok()) return fail(added.error());
    sites[i] = FindSite(organ.mesh, math::Normalized(kWalls[i].seen_from), fundus);
  }
  theatre.model = tissue::MakeTissueModel(theatre.definition);
  theatre.state = tissue::MakeRestState(theatre.model);
  theatre.solver =
      std::make_unique<tissue::EquilibriumSolver>(theatre.model, tissue::SolverOptions{.spare_share = 0.5});
  for (std::size_t i = 0; i < 2; ++i) {
    const geometry::CutReport report = CutThrough(sites[i], i, theatre);
    DrawApart(sites[i], i, kWalls[i].drawn, theatre);
    const auto& mesh = theatre.organs[i].Mesh();
    std::array<geometry::Opening, 4> openings;
    const std::size_t open = geometry::FindOpenings(mesh, openings);
    std::printf("%s: %zu edges opened, %zu left uncut, %zu wall triangles, %zu openings",
                NameOf(kWalls[i].organ), report.opened, report.refused, report.wall_triangles, open);
    if (open > 0) std::printf(", the first with a rim of %.1f mm", 1e3 * openings[0].length);
    std::printf("\n  %zu nodes; processor time of %d cutting ticks, mean and worst:", theatre.model.Size(),
                theatre.cutting_ticks);
    for (std::size_t k = 0; k < 5; ++k) {
      std::printf(" %s %.2f (%.2f) ms", kStages[k], 1e3 * theatre.sum[k] / theatre.cutting_ticks,
                  1e3 * theatre.worst[k]);
    }
    std::printf("\n");
    theatre.worst = theatre.sum = {};
    theatre.cutting_ticks = 0;
  }
  if (count == 3) {
    if (const auto drawn = DrawSites(theatre, sites, arguments[2]); !drawn.ok()) return fail(drawn.error());
  }
}
