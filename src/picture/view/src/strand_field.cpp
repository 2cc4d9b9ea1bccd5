// SPDX-License-Identifier: Apache-2.0
#include "strand_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/random.h"
#include "trocar/scene/triangle_fat.h"
#include "trocar/view/labels.h"

namespace trocar::view {
namespace {

using Kind = scene::StrandInfo::Kind;
using math::Vec3;
using render::Material;

constexpr double kFibreWidth = 0.00016;    // m, of areolar tissue
constexpr double kShownLength = 0.0035;    // m; a shorter strand lies between what it joins and is not seen
constexpr double kDrawn = 1.08;            // of its rest length, from which on a strand of the bed is seen
constexpr double kWebBreadth = 1.3;        // of the bed's web in distances to its neighbour
constexpr double kFatGrain = 3.0;          // how much finer its pattern is than that of the omentum [-]
constexpr double kFatChange = 0.00012;     // m; less movement leaves the fat's surface as it is
constexpr double kAdhesionWidth = 0.0007;  // m
constexpr double kEndSpread = 0.0007;      // m, of a fibre's root about its node
constexpr double kFilmOverlap = 1.6;       // breadth of a film in distances to its neighbour
constexpr double kLeastFilm = 0.0010, kMostFilm = 0.0045;  // m
constexpr double kWave = 0.07;                             // of a strand's length, at rest

Vec3 PickOffset(math::Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

/// How far a strand hangs sideways that is shorter than at rest: half of what an arc of its length would.
double CalcWave(double rest_length, double length) {
  const double slack = std::max(0.0, rest_length * rest_length - length * length);
  return kWave * std::min(rest_length, length) + 0.25 * std::sqrt(slack);
}

/// A film as wide as the distance to the next strand of its kind, so that neighbours make one sheet.
double CalcBreadth(const Vec3& middle, std::span<const Vec3> others, double overlap) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& other : others) {
    const double distance = math::Distance(other, middle);
    if (distance > 0.0) nearest = std::min(nearest, distance);
  }
  return std::clamp(overlap * nearest, kLeastFilm, kMostFilm);
}

}  // namespace

StrandField::StrandField(std::span<const scene::StrandInfo> strands, std::span<const Vec3> start) {
  std::vector<Vec3> peritoneum, bed;  // middles of their strands
  const auto middle_of = [&start](const scene::StrandInfo& info) {
    return 0.5 * (start[info.a] + start[info.b]);
  };
  for (const scene::StrandInfo& info : strands) {
    TROCAR_ASSERT(info.a < start.size() && info.b < start.size());
    if (info.kind == Kind::kPeritoneum) peritoneum.push_back(middle_of(info));
    if (info.kind == Kind::kBed) bed.push_back(middle_of(info));
  }
  for (std::size_t i = 0; i < strands.size(); ++i) {
    const scene::StrandInfo& info = strands[i];
    double breadth = 0;
    // once, at the start; the square of some hundreds
    if (info.kind == Kind::kPeritoneum) breadth = CalcBreadth(middle_of(info), peritoneum, kFilmOverlap);
    if (info.kind == Kind::kBed) breadth = CalcBreadth(middle_of(info), bed, kWebBreadth);
    strands_.push_back({info, math::Distance(start[info.a], start[info.b]), breadth});
  }
  lobules_ = scene::MakeTriangleFat(strands, start);
}

void StrandField::AddTo(render::Renderer& renderer, render::Frame& frame,
                        const simulation::Snapshot& snapshot, const Film& film) {
  AddFibres(frame, snapshot);
  AddFat(renderer, frame, snapshot);
  WetFat(renderer, film);
}

void StrandField::AddFibres(render::Frame& frame, const simulation::Snapshot& snapshot) const {
  const std::vector<std::uint8_t>& intact = snapshot.operation.strand_is_intact;
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    if (i < intact.size() && intact[i] == 0) continue;
    const Strand& strand = strands_[i];
    const Vec3 a = snapshot.positions[strand.info.a], b = snapshot.positions[strand.info.b];
    const double length = math::Distance(a, b), wave = CalcWave(strand.rest_length, length);
    const auto seed = static_cast<std::uint32_t>(i);
    math::Random random(i);
    const auto add_fibre = [&](double width) {
      frame.fibres.push_back({a + PickOffset(random, kEndSpread), b + PickOffset(random, kEndSpread), width,
                              wave, Material::kFibre, 3 * seed});
    };
    switch (strand.info.kind) {
      case Kind::kBed:
        // what is not drawn lies under the peritoneum that folds over from organ to organ
        if (length < kShownLength || length < kDrawn * strand.rest_length) break;
        // a web that thins out as it is drawn, and a thread in every second of them
        frame.fibres.push_back({a, b, strand.breadth, 0.3 * wave, Material::kFilm, 3 * seed});
        if (i % 2 == 0) add_fibre(kFibreWidth * random.Uniform(0.7, 1.5));
        break;
      case Kind::kAdhesion:
        add_fibre(kAdhesionWidth);
        break;
      case Kind::kTriangle:
        if (length >= kShownLength) add_fibre(kFibreWidth);
        break;
      case Kind::kPeritoneum:
        frame.fibres.push_back({a, b, strand.breadth, 0.3 * wave, Material::kFilm, 3 * seed});
        break;
      case Kind::kBand:
        break;  // a BandView shows it
      case Kind::kEnd:
        break;  // the tube itself shows it
    }
  }
}

void StrandField::FindRaw(const simulation::Snapshot& snapshot, std::vector<std::uint8_t>& rows) const {
  const std::vector<std::uint8_t>& intact = snapshot.operation.strand_is_intact;
  rows.clear();
  for (std::size_t i = 0; i < std::min(strands_.size(), intact.size()); ++i) {
    if (intact[i] != 0 || strands_[i].info.kind != Kind::kBed) continue;
    rows.resize(snapshot.positions.size(), 0);
    rows[strands_[i].info.a] = rows[strands_[i].info.b] = 1;
  }
}

void StrandField::AddFat(render::Renderer& renderer, render::Frame& frame,
                         const simulation::Snapshot& snapshot) {
  lobules_.Update(snapshot.operation.strand_is_intact);
  wanted_.clear();
  for (std::size_t i = 0; i < lobules_.Count(); ++i) {
    if (lobules_.IsThere(i))
      wanted_.push_back({lobules_.Centre(i, snapshot.positions), lobules_.Rest(i), lobules_.Radius(i)});
  }
  const bool is_same = std::equal(wanted_.begin(), wanted_.end(), shown_.begin(), shown_.end(),
                                  [](const FatLobule& a, const FatLobule& b) {
                                    return a.rest == b.rest && a.radius == b.radius &&
                                           math::SquaredNorm(a.centre - b.centre) < kFatChange * kFatChange;
                                  });
  if (!is_same) {
    renderer.RemoveSurface(surface_);
    surface_ = {};
    is_wet_ = false;
    fat_.Make(wanted_);
    const geometry::TriangleMesh& mesh = fat_.Mesh();
    if (!mesh.triangles.empty()) {
      // its lobules are small beside those of the omentum, of which the material is
      grain_.assign(fat_.Rest().begin(), fat_.Rest().end());
      for (Vec3& place : grain_) place = kFatGrain * place;
      surface_ = renderer.AddSurface(mesh.triangles, grain_, Material::kFat, fat_.AmbientOcclusion());
      normals_.resize(mesh.positions.size());
      geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals_);
      renderer.UpdateSurface(surface_, mesh.positions, normals_);
    }
    shown_ = wanted_;
  }
  if (!fat_.Mesh().triangles.empty())
    frame.surfaces.push_back({surface_, {}, MakeLabel(LabelClass::kTriangleFat)});
}

void StrandField::WetFat(render::Renderer& renderer, const Film& film) {
  const std::vector<math::Vec3>& positions = fat_.Mesh().positions;
  if (positions.empty() || (!film.HasLiquid() && !is_wet_)) return;
  is_wet_ = film.HasLiquid();
  marks_.assign(positions.size(), {});
  for (std::size_t v = 0; v < positions.size() && is_wet_; ++v) film.Wet(positions[v], marks_[v]);
  renderer.UpdateMarks(surface_, marks_);
}

}  // namespace trocar::view
