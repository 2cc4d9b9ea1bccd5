// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/generate_patient.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "duct_template.h"
#include "trocar/anatomy/patient_builder.h"
#include "trocar/geometry/distance.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/random.h"
#include "trocar/meshing/volume_mesher.h"

namespace trocar::anatomy {
namespace {

using core::Error;
using core::ErrorCode;
using math::Vec3;

constexpr int kSmoothingRounds = 40;  // the distances are smooth already: little smoothing is needed
constexpr double kLiverSpacingMm = 2.0;
constexpr double kGallbladderSpacingMm = 1.25;
constexpr double kGapMm = 1.3;  // between liver and gallbladder, so that their meshes do not touch
constexpr double kMlPerCubicMm = 1e-3;

/// Extents of the model below at scale 1, as measured on its mesh; a test holds them.
constexpr Vec3 kNominalMm = {222.5, 172, 118};

// distances are negative inside, in millimetres

/// Largest of two distances, blended where they differ by less than `blend`.
double SmoothMax(double a, double b, double blend) {
  const double h = std::max(blend - std::fabs(a - b), 0.0) / blend;
  return std::max(a, b) + 0.25 * h * h * blend;
}
double SmoothMin(double a, double b, double blend) {
  return -SmoothMax(-a, -b, blend);
}

struct Ellipsoid {
  Vec3 centre, radii;

  /// First-order distance: exact at the surface.
  double Distance(const Vec3& p) const {
    const Vec3 q = {(p.x - centre.x) / radii.x, (p.y - centre.y) / radii.y, (p.z - centre.z) / radii.z};
    const Vec3 g = {q.x / radii.x, q.y / radii.y, q.z / radii.z};
    const double k0 = Norm(q), k1 = Norm(g);
    return k1 > 0 ? k0 * (k0 - 1.0) / k1 : -std::min({radii.x, radii.y, radii.z});
  }
  Vec3 OutwardAt(const Vec3& p) const {
    return math::Normalized(Vec3{(p.x - centre.x) / (radii.x * radii.x),
                                 (p.y - centre.y) / (radii.y * radii.y),
                                 (p.z - centre.z) / (radii.z * radii.z)});
  }
};

/// Balls along a polyline, radii in between.
struct Worm {
  std::vector<Vec3> points;
  std::vector<double> radii;

  double Distance(const Vec3& p) const {
    double nearest = 1e9;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double t = geometry::FindNearestOnSegment(p, points[i], points[i + 1]);
      nearest = std::min(nearest, math::Distance(p, math::Lerp(points[i], points[i + 1], t)) -
                                      (radii[i] + t * (radii[i + 1] - radii[i])));
    }
    return nearest;
  }
};

/// Smooth noise in about [-1, 1] with bumps `wavelength` apart: random values at lattice points, blended.
double CalcNoise(const Vec3& p, double wavelength, std::uint64_t seed) {
  double sum = 0;
  int cell[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double at = 2.0 * p[axis] / wavelength;
    cell[axis] = static_cast<int>(std::floor(at));
    const double t = at - cell[axis];
    part[axis] = t * t * (3 - 2 * t);
  }
  for (int corner = 0; corner < 8; ++corner) {
    std::uint64_t word = seed;
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = corner >> axis & 1;
      word = math::Random(word ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis] + bit)))
                 .NextWord();
      weight *= bit ? part[axis] : 1 - part[axis];
    }
    sum += weight * math::Random(word).Uniform(-1.0, 1.0);
  }
  return sum;
}

/// Liver and gallbladder as functions of the place. Frame: left, cranial, anterior of the porta hepatis [mm].
class Body {
 public:
  Body(std::span<const Parameter> parameters, std::uint64_t seed) : seed_(seed) {
    const auto number = [&](std::string_view name) { return NumberOf(parameters, name); };
    const double fat = number("steatosis");
    cirrhosis_ = number("cirrhosis");
    constexpr double kFatGrowth = 0.25;  // of the volume
    const double growth = std::cbrt(1.0 + kFatGrowth * fat);
    scale_ = growth * Vec3{number("liver_transverse") / kNominalMm.x, number("liver_vertical") / kNominalMm.y,
                           number("liver_depth") / kNominalMm.z};
    edge_blend_ = 9.0 + 12.0 * fat;
    MakeLiver();
    MakeGallbladder(parameters);
  }

  double LiverDistance(const Vec3& p) const {
    double liver = SmoothMax(DomeDistance(p), -viscera_.Distance(p), edge_blend_);
    liver = SmoothMin(liver, SmoothMax(caudate_.Distance(p), -spine_.Distance(p), 6.0), 8.0);
    liver = SmoothMax(liver, -stomach_.Distance(p), 8.0);
    liver = SmoothMax(liver, -kidney_.Distance(p), 10.0);
    liver = SmoothMax(liver, -spine_.Distance(p), 12.0);
    if (liver < 30.0 && liver > -40.0) {
      liver = SmoothMax(liver, -fissure_.Distance(p), 5.0);
      liver = SmoothMax(liver, -porta_.Distance(p), 6.0);
      if (cirrhosis_ > 0) liver -= 2.6 * cirrhosis_ * CalcNoise(p, 17.0, seed_);
      liver = SmoothMax(liver, kGapMm - gallbladder_.Distance(p), 2.0);
    }
    return liver;
  }
  double GallbladderDistance(const Vec3& p) const { return gallbladder_.Distance(p); }

  const Worm& Gallbladder() const { return gallbladder_; }
  const Vec3& FissurePoint() const { return fissure_.points.back(); }
  const Vec3& Neck() const { return neck_; }
  geometry::Box LiverBox() const {
    const Vec3 reach = {115 * scale_.x, 100 * scale_.y, 80 * scale_.z};
    return {-1.0 * reach - Vec3{12, 4, 4}, reach};
  }

 private:
  Ellipsoid Scaled(const Vec3& centre, const Vec3& radii) const {
    return {{centre.x * scale_.x, centre.y * scale_.y, centre.z * scale_.z},
            {radii.x * scale_.x, radii.y * scale_.y, radii.z * scale_.z}};
  }

  double DomeDistance(const Vec3& p) const {
    double dome = SmoothMin(right_.Distance(p), left_.Distance(p), 34.0);
    dome = SmoothMin(dome, tip_.Distance(p), 20.0);
    return SmoothMin(dome, lateral_.Distance(p), 30.0);
  }

  void MakeLiver() {
    const double right_size = 1.0 - 0.12 * cirrhosis_, caudate_size = 1.0 + 0.45 * cirrhosis_;
    right_ = Scaled({-50, 6, -6}, right_size * Vec3{62, 80, 56});
    lateral_ = Scaled({-52, -26, 6}, right_size * Vec3{52, 60, 42});
    left_ = Scaled({20, 33, 13}, {72, 35, 36});
    tip_ = Scaled({62, 40, 10}, {46, 20, 26});
    // the viscera push in from below, behind and the left: a wide concave face with a sharp lower edge
    const Vec3 down = math::Normalized(Vec3{0.36, -0.78, -0.50});
    constexpr double kRadius = 165;
    viscera_ = Scaled(Vec3{0, -10, -12} + kRadius * down, {kRadius, kRadius, kRadius});
    stomach_ = Scaled({66, -14, -18}, {66, 46, 46});
    kidney_ = Scaled({-58, -52, -70}, {36, 52, 36});
    spine_ = Scaled({22, 20, -82}, {34, 140, 46});
    caudate_ = Scaled({2, 24, -30}, caudate_size * Vec3{17, 24, 14});
    const auto fissure_way = FindVisceralWay(4, -6, {0.24, 0, 0.97});
    const double edge = FindEdge(fissure_way);
    fissure_ = {};
    for (std::size_t i = 0; i < fissure_way.size(); ++i) {
      if (fissure_way[i].second > edge + 14.0) break;
      const double part = std::clamp(fissure_way[i].second / edge, 0.0, 1.0);
      fissure_.points.push_back(fissure_way[i].first);
      fissure_.radii.push_back(3.0 + 7.0 * part * part);
    }
    porta_ = {{OnViscera(-16, -12), OnViscera(-2, -10), OnViscera(8, -6)}, {3.5, 5.5, 3.5}};
  }

  /// Point of the visceral face above (x, z).
  Vec3 OnViscera(double x, double z) const {
    const double a = (x - viscera_.centre.x) / viscera_.radii.x,
                 b = (z - viscera_.centre.z) / viscera_.radii.z;
    return {x, viscera_.centre.y + viscera_.radii.y * std::sqrt(std::max(0.0, 1.0 - a * a - b * b)), z};
  }
  /// Points along the visceral face from above (x, z) in a level direction, with the length so far [mm].
  std::vector<std::pair<Vec3, double>> FindVisceralWay(double x, double z, const Vec3& direction) const {
    constexpr int kSteps = 140;  // of 1 mm
    std::vector<std::pair<Vec3, double>> way;
    for (int i = 0; i <= kSteps; ++i) {
      const Vec3 p = OnViscera(x + i * direction.x, z + i * direction.z);
      way.emplace_back(p, way.empty() ? 0.0 : way.back().second + Distance(way.back().first, p));
    }
    return way;
  }
  /// Length of the way at which it leaves the liver in front.
  double FindEdge(const std::vector<std::pair<Vec3, double>>& way) const {
    for (const auto& [p, length] : way) {
      if (DomeDistance(p) > 0) return length;
    }
    return way.back().second;
  }

  void MakeGallbladder(std::span<const Parameter> parameters) {
    const auto number = [&](std::string_view name) { return NumberOf(parameters, name); };
    const double hydrops = number("hydrops"), acute = number("acute_cholecystitis"),
                 shrunk = number("scleroatrophy");
    double length = number("gallbladder_length") * (1 + 0.45 * hydrops);
    double radius = 0.5 * number("gallbladder_diameter") * (1 + 0.33 * hydrops);
    // the slider leads from the drawn size to the guideline's
    length += acute * (std::max(length, 84.0) - length);
    radius += acute * (std::max(radius, 20.5) - radius);
    length += shrunk * (45.0 - length);
    radius += shrunk * (0.7 * radius - radius);

    // along the visceral face on the line between gallbladder and vena cava, fundus in front of the edge
    const Vec3 direction = math::Normalized(Vec3{-0.34, 0, 0.94});
    const double start = -0.5 * length;
    const auto way = FindVisceralWay(-13 * scale_.x + start * direction.x, start * direction.z, direction);
    const double edge = [&] {
      bool was_inside = false;
      for (const auto& [p, along] : way) {
        const bool inside = DomeDistance(p) < 0;
        if (was_inside && !inside) return along;
        was_inside = inside;
      }
      return way.back().second;
    }();
    const double tip = edge + number("fundus_overhang");
    const double bend = number("gallbladder_bend") * M_PI / 180, embedding = number("gallbladder_embedding");
    const auto point_at = [&](double along) {
      std::size_t i = 0;
      while (i + 2 < way.size() && way[i + 1].second < along) ++i;
      const double t = (along - way[i].second) / (way[i + 1].second - way[i].second);
      return math::Lerp(way[i].first, way[i + 1].first, t);
    };
    const double first_radius = radius * CalcGallbladderProfile(0),
                 last_radius = radius * CalcGallbladderProfile(1);
    const double from = tip - length + first_radius, to = tip - last_radius;
    constexpr int kParts = 26;
    Worm axis;
    for (int i = 0; i <= kParts; ++i) {
      const double t = static_cast<double>(i) / kParts;
      const Vec3 on = point_at(from + t * (to - from));
      const Vec3 below = -viscera_.OutwardAt(on);
      const Vec3 side = math::Normalized(Cross(below, direction));
      const double r = radius * CalcGallbladderProfile(t);
      // the neck hangs free of the fossa and turns towards the duct
      const double free = std::pow(1 - t, 3);
      const double sagitta = length * bend / 8 * (1 - std::pow(2 * t - 1, 2));
      axis.points.push_back(on + (r * (1 - 2 * embedding) + 5.0 * free) * below + sagitta * side);
      axis.radii.push_back(r);
    }
    if (TextOf(parameters, "phrygian_cap") == "yes") FoldFundus(axis);
    gallbladder_ = std::move(axis);
    neck_ = gallbladder_.points.front() +
            gallbladder_.radii.front() * math::Normalized(gallbladder_.points[0] - gallbladder_.points[1]);
  }

  /// Turns the last quarter of the axis back, away from the liver.
  void FoldFundus(Worm& axis) const {
    const std::size_t n = axis.points.size(), hinge = n - n / 4;
    const Vec3 forward = math::Normalized(axis.points[hinge] - axis.points[hinge - 1]);
    const Vec3 below = -viscera_.OutwardAt(axis.points[hinge]);
    const Vec3 down = math::Normalized(below - Dot(below, forward) * forward);
    constexpr double kFold = 125 * M_PI / 180;
    const double step = Distance(axis.points[hinge], axis.points[hinge - 1]);
    Vec3 at = axis.points[hinge - 1];
    for (std::size_t i = hinge; i < n; ++i) {
      const double turned = kFold * std::min(1.0, static_cast<double>(i - hinge + 1) / 3.0);
      at += step * (std::cos(turned) * forward + std::sin(turned) * down);
      axis.points[i] = at;
      axis.radii[i] *= 0.86;
    }
  }

  std::uint64_t seed_;
  double cirrhosis_ = 0, edge_blend_ = 4;
  Vec3 scale_ = {1, 1, 1};
  Ellipsoid right_, lateral_, left_, tip_, viscera_, stomach_, kidney_, spine_, caudate_;
  Worm fissure_, porta_, gallbladder_;
  Vec3 neck_;
};

/// Samples of minus the distance. Only the surface's place counts: a block of samples whose middle lies so
/// far from the surface that all of it must be on the same side takes the middle's value.
template <typename Function>
meshing::ScalarVolume Sample(const geometry::Box& box, double spacing, Function distance) {
  constexpr int kBlock = 4;           // samples along each side
  constexpr double kSteepness = 2.5;  // no distance grows faster than this; they are first-order estimates
  const double clear = kSteepness * 0.5 * std::sqrt(3.0) * (kBlock + 1) * spacing;
  meshing::ScalarVolume volume;
  volume.spacing = spacing;
  for (int axis = 0; axis < 3; ++axis) {
    volume.first[axis] = static_cast<int>(std::floor(box.min[axis] / spacing)) - 1;
    volume.size[axis] = static_cast<int>(std::ceil(box.max[axis] / spacing)) + 2 - volume.first[axis];
  }
  volume.values.resize(static_cast<std::size_t>(volume.size[0]) * volume.size[1] * volume.size[2]);
  const auto blocks = [&](int axis) { return (volume.size[axis] + kBlock - 1) / kBlock; };
  oneapi::tbb::parallel_for(0, blocks(2) * blocks(1), [&](int row) {
    const int k0 = row / blocks(1) * kBlock, j0 = row % blocks(1) * kBlock;
    for (int i0 = 0; i0 < volume.size[0]; i0 += kBlock) {
      constexpr double kMiddle = 0.5 * (kBlock - 1);
      const Vec3 middle = spacing * Vec3{volume.first[0] + i0 + kMiddle, volume.first[1] + j0 + kMiddle,
                                         volume.first[2] + k0 + kMiddle};
      const double there = distance(middle);
      const bool is_clear = std::fabs(there) > clear;
      for (int k = k0; k < std::min(k0 + kBlock, volume.size[2]); ++k) {
        for (int j = j0; j < std::min(j0 + kBlock, volume.size[1]); ++j) {
          for (int i = i0; i < std::min(i0 + kBlock, volume.size[0]); ++i) {
            volume.values[volume.Index(i, j, k)] =
                static_cast<float>(is_clear ? -there : -distance(volume.Position(i, j, k)));
          }
        }
      }
    }
  });
  return volume;
}

core::Result<meshing::StructureMesh> MakeStructure(const char* name, meshing::ScalarVolume volume,
                                                   int triangles) {
  meshing::MeshingSettings settings;
  settings.triangle_budget = triangles;
  settings.smoothing.iterations = kSmoothingRounds;
  settings.distance_samples = 0;
  auto meshed = meshing::MeshVolume(std::move(volume), settings);
  if (!meshed.ok()) return Error{meshed.error().code, std::string(name) + ": " + meshed.error().message};
  if (!meshed->quality.IsSound()) {
    return Error{ErrorCode::kMeshInvalid,
                 std::string(name) +
                     ": its mesh cuts itself with these parameters; take another seed "
                     "or milder settings"};
  }
  return meshing::StructureMesh{name, std::move(meshed->mesh)};
}

}  // namespace

core::Result<Patient> GeneratePatient(std::uint64_t seed, std::span<const ParameterSetting> settings) {
  auto parameters = DrawParameters(seed, settings);
  if (!parameters.ok()) return parameters.error();
  const Body body(*parameters, seed);

  auto liver = MakeStructure(
      NameOf(OrganRole::kLiver),
      Sample(body.LiverBox(), kLiverSpacingMm, [&](const Vec3& p) { return body.LiverDistance(p); }),
      meshing::kLiverTriangles);
  if (!liver.ok()) return liver.error();
  geometry::Box box = geometry::CalcBox(body.Gallbladder().points);
  const double reach =
      *std::max_element(body.Gallbladder().radii.begin(), body.Gallbladder().radii.end()) + 3.0;
  box.min -= Vec3{reach, reach, reach}, box.max += Vec3{reach, reach, reach};
  auto gallbladder = MakeStructure(
      NameOf(OrganRole::kGallbladder),
      Sample(box, kGallbladderSpacingMm, [&](const Vec3& p) { return body.GallbladderDistance(p); }),
      meshing::kGallbladderTriangles);
  if (!gallbladder.ok()) return gallbladder.error();

  contours::ControlPoints frame = MakeWorldFrame();
  frame.name = "Generated patient, seed " + std::to_string(seed);
  frame.provenance = "Made by a computer from the seed and the parameters listed here; no person's images";
  frame.tubes = PlaceDucts(liver->mesh, gallbladder->mesh, body.Neck(), *parameters);
  const Vec3 fissure = body.FissurePoint();
  frame.landmarks = {{NameOf(LandmarkRole::kUmbilicalFissure), fissure.z, {fissure.x, fissure.y}}};

  const auto measure = [&](const char* name, double value, const char* unit) {
    parameters->push_back({name, value, unit, "measured on the result"});
  };
  const auto liver_box = geometry::CalcBox(liver->mesh.positions);
  measure("measured_liver_transverse", liver_box.max.x - liver_box.min.x, "mm");
  measure("measured_liver_vertical", liver_box.max.y - liver_box.min.y, "mm");
  measure("measured_liver_depth", liver_box.max.z - liver_box.min.z, "mm");
  measure("measured_liver_volume",
          kMlPerCubicMm * geometry::CalcVolume(liver->mesh.positions, liver->mesh.triangles), "mL");
  measure("measured_gallbladder_volume",
          kMlPerCubicMm * geometry::CalcVolume(gallbladder->mesh.positions, gallbladder->mesh.triangles),
          "mL");
  for (const contours::TubePoints& tube : frame.tubes) {
    const std::string name = "measured_" + tube.name + "_length";
    measure(name.c_str(), CalcLengthMm(tube), "mm");
  }
  auto patient = AssemblePatient(frame, {std::move(*liver), std::move(*gallbladder)});
  if (!patient.ok()) return patient.error();
  patient->parameters = std::move(*parameters);
  return patient;
}

}  // namespace trocar::anatomy
