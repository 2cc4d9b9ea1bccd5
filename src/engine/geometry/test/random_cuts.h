// SPDX-License-Identifier: Apache-2.0
/// \file random_cuts.h  Strokes of every kind over surfaces of every kind, from one seed.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cut_checks.h"
#include "random_meshes.h"
#include "trocar/files/mesh_file.h"
#include "trocar/math/pose.h"

namespace trocar::geometry {

/// Spheres, boxes, sheets, slender triangles, tubes, and the built-in patient's organs, 1 to 300 mm large.
inline std::vector<NamedSurface> MakeSurfaces() {
  const auto scaled = [](TriangleMesh mesh, const math::Vec3& factors) {
    for (math::Vec3& p : mesh.positions) p = {p.x * factors.x, p.y * factors.y, p.z * factors.z};
    return mesh;
  };
  std::vector<NamedSurface> surfaces;
  surfaces.push_back({"sphere of 80", MakeSphere({0.1, 0, 0}, 0.02, 1)});
  surfaces.push_back({"sphere of 320", MakeSphere({}, 0.03, 2)});
  surfaces.push_back({"sphere of 1280", MakeSphere({}, 0.0005, 3)});
  surfaces.push_back({"flat ellipsoid", scaled(MakeSphere({}, 0.03, 3), {1, 1, 0.05})});
  surfaces.push_back({"box of 12", MakeBox({-0.01, -0.02, -0.03}, {0.01, 0.02, 0.03})});
  surfaces.push_back({"grid", MakeGrid(12, 0.005)});
  surfaces.push_back({"lattice", MakeTriangularLattice(15, 12, 0.004)});
  surfaces.push_back({"slender grid", scaled(MakeGrid(9, 0.005), {1, 0.04, 1})});
  surfaces.push_back({"one triangle", {{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}}, {{0, 1, 2}}}});
  surfaces.push_back(
      {"tube",
       MakeTube(Resample({{{0, 0, 0}, {0.02, 0.01, 0}, {0.04, 0, 0.01}}, {0.003, 0.002, 0.003}}, 0.002), 8)});
  const std::filesystem::path patient =
      std::filesystem::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient";
  for (const char* organ : {"gallbladder.ply", "liver.ply"}) {
    auto mesh = files::ReadPly(patient / organ);
    EXPECT_TRUE(mesh.ok()) << (patient / organ);
    if (mesh.ok()) surfaces.push_back({organ, std::move(*mesh)});
  }
  return surfaces;
}

/// A stroke: places of the blade from tick to tick.
using Stroke = std::vector<BladeEdge>;

/// A stroke over a surface: through a point of it, along an edge, through vertices, grazing, tiny or huge, straight,
/// turning or turning back.
inline Stroke MakeStroke(const EditableMesh& mesh, math::Random& random) {
  const auto x = mesh.Positions();
  const auto t = static_cast<std::uint32_t>(random.Uniform() * static_cast<double>(mesh.TriangleCount()));
  const Triangle& corners = mesh.Triangles()[t];
  const Box box = CalcBox(x);
  const double size = math::Distance(box.min, box.max);
  double w[3] = {random.Uniform(0.05, 1), random.Uniform(0.05, 1), random.Uniform(0.05, 1)};
  if (random.Uniform() < 0.1) w[0] = 0;         // starts on an edge
  if (random.Uniform() < 0.1) w[1] = w[2] = 0;  // starts at a vertex
  if (w[0] + w[1] + w[2] <= 0) w[0] = 1;
  const double sum = w[0] + w[1] + w[2];
  const math::Vec3 start =
      (w[0] / sum) * x[corners[0]] + (w[1] / sum) * x[corners[1]] + (w[2] / sum) * x[corners[2]];
  const math::Vec3 normal = math::Normalized(CalcAreaNormal(x, corners), RandomDirection(random));
  math::Vec3 along =
      math::Normalized(math::Cross(normal, RandomDirection(random)), math::AnyPerpendicular(normal));
  if (random.Uniform() < 0.15) along = math::Normalized(x[corners[1]] - x[corners[0]], along);
  const double kind = random.Uniform();
  const math::Vec3 upright = kind < 0.7   ? normal
                             : kind < 0.9 ? RandomDirection(random)
                                          : along;  // the last one grazes
  const double length = size * std::pow(10.0, random.Uniform(-3.0, 0.3));
  const double reach = size * std::pow(10.0, random.Uniform(-2.0, 0.3));
  const int ticks = random.Uniform() < 0.3 ? 1 : 1 + static_cast<int>(random.Uniform() * 12);
  const double turn = random.Uniform() < 0.5 ? 0.0 : random.Uniform(-0.6, 0.6);
  Stroke stroke;
  math::Vec3 at = start - (random.Uniform() < 0.3 ? 0.5 * length : 0.0) * along;
  math::Vec3 blade = upright;
  for (int i = 0; i <= ticks; ++i) {
    stroke.push_back({at - reach * blade, at + reach * blade});
    at += (length / ticks) * along;
    along = math::Rotate(math::RotationAbout(normal, turn), along);
    if (random.Uniform() < 0.05) along = -along;
    if (random.Uniform() < 0.3) blade = math::Normalized(blade + 0.1 * RandomDirection(random));
  }
  return stroke;
}

/// Bends and stretches the surface, as tissue that is pulled.
inline void Deform(EditableMesh& mesh, math::Random& random) {
  const Box box = CalcBox(mesh.Rest());
  const double size = math::Distance(box.min, box.max);
  const math::Vec3 wave = (4.0 / size) * RandomDirection(random),
                   push = 0.05 * size * RandomDirection(random);
  std::vector<math::Vec3> moved(mesh.Rest().begin(), mesh.Rest().end());
  for (math::Vec3& p : moved) p += std::sin(math::Dot(wave, p)) * push;
  mesh.SetPositions(moved);
}

struct CutCounts {
  std::size_t strokes = 0, ticks = 0, opened = 0, inserted = 0, splits = 0, refused = 0, walls = 0, full = 0;
};

/// Cuts and checks surfaces of every kind and random ones by turns; `after` sees every mesh after its last cut.
template <typename After>
CutCounts RunRandomCuts(std::uint64_t seed, std::size_t strokes, After after) {
  const auto surfaces = MakeSurfaces();
  math::Random random(seed);
  CutCounts counts;
  constexpr std::size_t kStrokesAMesh = 12;
  std::size_t turn = 0;
  while (counts.strokes < strokes) {
    const NamedSurface surface =
        turn % 2 == 0 ? surfaces[turn / 2 % surfaces.size()] : MakeRandomSurface(random);
    const bool is_large = surface.mesh.triangles.size() > 2000;
    CutSettings settings;
    settings.has_walls = random.Uniform() < 0.5;
    const Box box = CalcBox(surface.mesh.positions);
    settings.depth = math::Distance(box.min, box.max) * random.Uniform(0.01, 0.3);
    settings.step = math::Distance(box.min, box.max) * random.Uniform(0.005, 0.2);
    ++turn;
    const bool is_tight = random.Uniform() < 0.1;  // pools that run full
    auto made = EditableMesh::Make(surface.mesh, is_tight ? 20 : 6000, is_tight ? 30 : 12000);
    if (!made.ok()) {
      ADD_FAILURE() << surface.name << ": " << made.error().message;
      return counts;
    }
    EditableMesh& mesh = *made;
    SurfaceCutter cutter(mesh);
    for (std::size_t k = 0; k < (is_large ? 3 : kStrokesAMesh) && counts.strokes < strokes; ++k) {
      if (random.Uniform() < 0.5) Deform(mesh, random);
      const Uncut uncut = Measure(mesh);
      const Stroke stroke = MakeStroke(mesh, random);
      CutFront front;
      for (std::size_t i = 1; i < stroke.size(); ++i) {
        const CutReport report = cutter.Cut(stroke[i - 1], stroke[i], settings, front, mesh);
        ++counts.ticks;
        counts.opened += report.opened;
        counts.inserted += report.inserted;
        counts.splits += report.splits;
        counts.refused += report.refused;
        counts.walls += report.wall_triangles;
        counts.full += report.is_full ? 1 : 0;
        // large meshes are looked at once a stroke
        if (is_large && i + 1 < stroke.size()) continue;
        const std::string fault =
            report.HasChanged() ? FindFault(mesh, uncut, settings.has_walls) : std::string();
        if (!fault.empty()) {
          ADD_FAILURE() << fault << ": seed " << seed << ", stroke " << counts.strokes << ", tick " << i
                        << ", " << surface.name << (settings.has_walls ? ", walls" : "");
          return counts;
        }
      }
      ++counts.strokes;
    }
    after(surface.name, mesh);
  }
  return counts;
}

}  // namespace trocar::geometry
