// SPDX-License-Identifier: Apache-2.0
#include "generated_body.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/distance.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using math::Asin;
using math::Cbrt;
using math::Cos;
using math::Exp;
using math::Sin;
using math::Vec3;

constexpr double kGapMm = 1.3;  // between liver and gallbladder, so that their meshes do not touch

/// Extents of the model below at scale 1: where the search for the scale starts.
constexpr Vec3 kNominalMm = {222.5, 172, 118};

/// Largest of two distances, blended where they differ by less than `blend`.
double SmoothMax(double a, double b, double blend) {
  const double h = std::max(blend - std::fabs(a - b), 0.0) / blend;
  return std::max(a, b) + 0.25 * h * h * blend;
}
double SmoothMin(double a, double b, double blend) {
  return -SmoothMax(-a, -b, blend);
}

/// Smooth noise in about [-1, 1] with bumps `wavelength` apart: random values at lattice points, blended.
double CalcNoise(const Vec3& p, double wavelength, std::uint64_t seed) {
  double sum = 0;
  int cell[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double at = 2.0 * p[axis] / wavelength;
    cell[axis] = base::FloorTo<int>(at);
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

Vec3 Times(const Vec3& a, const Vec3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

constexpr geometry::Box kNothing = {{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}};
void Include(const Vec3& p, geometry::Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::min(box.min[axis], p[axis]);
    box.max[axis] = std::max(box.max[axis], p[axis]);
  }
}

}  // namespace

double Ellipsoid::Distance(const Vec3& p) const {
  const Vec3 q = {(p.x - centre.x) / radii.x, (p.y - centre.y) / radii.y, (p.z - centre.z) / radii.z};
  const Vec3 g = {q.x / radii.x, q.y / radii.y, q.z / radii.z};
  const double k0 = Norm(q), k1 = Norm(g);
  return k1 > 0 ? k0 * (k0 - 1.0) / k1 : -std::min({radii.x, radii.y, radii.z});
}

Vec3 Ellipsoid::OutwardAt(const Vec3& p) const {
  return math::Normalized(Vec3{(p.x - centre.x) / (radii.x * radii.x), (p.y - centre.y) / (radii.y * radii.y),
                               (p.z - centre.z) / (radii.z * radii.z)});
}

double Worm::Distance(const Vec3& p) const {
  double nearest = 1e9;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double t = geometry::FindNearestOnSegment(p, points[i], points[i + 1]);
    nearest = std::min(nearest, math::Distance(p, math::Lerp(points[i], points[i + 1], t)) -
                                    (radii[i] + t * (radii[i + 1] - radii[i])));
  }
  return nearest;
}

GeneratedBody::GeneratedBody(std::span<const patient::Parameter> parameters, std::uint64_t seed)
    : seed_(seed) {
  const auto number = [&](std::string_view name) { return NumberOf(parameters, name); };
  const double fat = number("steatosis");
  cirrhosis_ = number("cirrhosis");
  constexpr double kFatGrowth = 0.25;  // of the volume
  const Vec3 size = Cbrt(1.0 + kFatGrowth * fat) *
                    Vec3{number("liver_transverse"), number("liver_vertical"), number("liver_depth")};
  taper_ = number("right_lobe_taper");
  edge_blend_ = number("liver_edge_rounding") + 12.0 * fat;
  deep_ = std::clamp((size.z / size.x - 0.55) / 0.45, 0.0, 1.0);
  scale_ = Times(size, {1 / kNominalMm.x, 1 / kNominalMm.y, 1 / kNominalMm.z});
  // the visceral face gives the gallbladder its inclination, and both change the extents
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    FindPitch(parameters);
    box_ = FindLiverBox();
    const Vec3 found = box_.max - box_.min;
    scale_ = Times(scale_, {size.x / found.x, size.y / found.y, size.z / found.z});
  }
  FindPitch(parameters);
  MakeGrooves();
  constexpr double kMargin = 6.0;  // mm, also for nodules
  box_ = FindLiverBox();
  box_.min -= Vec3{kMargin, kMargin, kMargin}, box_.max += Vec3{kMargin, kMargin, kMargin};
}

double GeneratedBody::LiverDistance(const Vec3& p) const {
  double liver = LobesDistance(p);
  if (liver < 30.0 && liver > -40.0) {
    liver = SmoothMax(liver, -fissure_.Distance(p), 5.0);
    liver = SmoothMax(liver, -porta_.Distance(p), 6.0);
    if (cirrhosis_ > 0) liver -= 2.6 * cirrhosis_ * CalcNoise(p, 17.0, seed_);
    liver = SmoothMax(liver, kGapMm - gallbladder_.Distance(p), 2.0);
  }
  return liver;
}

Ellipsoid GeneratedBody::Scaled(const Vec3& centre, const Vec3& radii) const {
  return {Times(centre, scale_), Times(radii, scale_)};
}

double GeneratedBody::DomeDistance(const Vec3& p) const {
  double dome = SmoothMin(right_.Distance(p), left_.Distance(p), 34.0);
  dome = SmoothMin(dome, tip_.Distance(p), 20.0);
  return SmoothMin(dome, lateral_.Distance(p), 30.0);
}

/// Without grooves and fossa.
double GeneratedBody::LobesDistance(const Vec3& p) const {
  double liver = SmoothMax(DomeDistance(p), -viscera_.Distance(p), edge_blend_);
  liver = SmoothMin(liver, SmoothMax(caudate_.Distance(p), -spine_.Distance(p), 6.0), 8.0);
  liver = SmoothMax(liver, -stomach_.Distance(p), 8.0);
  liver = SmoothMax(liver, -kidney_.Distance(p), 18.0);
  return SmoothMax(liver, -spine_.Distance(p), 12.0);
}

/// \param pitch  anterior part of the way to the viscera: the less, the steeper the visceral face [-]
void GeneratedBody::MakeLobes(double pitch) {
  const double right_size = 1.0 - 0.12 * cirrhosis_, caudate_size = 1.0 + 0.45 * cirrhosis_;
  // a deep liver's right lobe lies beside the spine; its left lobe stays in front and gets thinner
  const double back = 34.0 * deep_;
  right_ = Scaled({-50, 6, -6 - back}, right_size * Vec3{62, 80, 56 + back});
  lateral_ = Scaled({-52, -26 - 8 * taper_, 6 - back},
                    right_size * Vec3{52, 60, (1 - 0.5 * taper_) * (42 + 0.8 * back)});
  left_ = Scaled({20, 33, 13}, {72, 35, 36 - 6 * deep_});
  tip_ = Scaled({62, 40, 10}, {46, 20, 26});
  // the viscera push in from below, behind and the left: a wide concave face with a sharp lower edge. The less they
  // push from behind, the more they do from the left
  const double from_left = std::clamp(0.36 + 0.5 * (pitch + 0.50), 0.2, 0.62);
  const Vec3 down = math::Normalized(Vec3{from_left, -0.78, pitch});
  constexpr double kRadius = 165;
  viscera_ = Scaled(Vec3{0, -10, -12} + kRadius * down, {kRadius, kRadius, kRadius});
  stomach_ = Scaled({66, -14, -18}, {66, 46, 46});
  kidney_ = Scaled({-58, -52, -76 - 1.5 * back}, {36, 52, 36});
  spine_ = Scaled({22, 20, -82 - back}, {34, 140, 46 + back});
  caudate_ = Scaled({2, 24, -30}, caudate_size * Vec3{17, 24, 14});
}

void GeneratedBody::MakeGrooves() {
  const auto fissure_way = FindVisceralWay(4, -6, {0.24, 0, 0.97});
  const double edge = FindEdge(fissure_way);
  fissure_ = {};
  for (std::size_t i = 0; i < fissure_way.size(); ++i) {
    if (fissure_way[i].second > edge + 14.0) break;
    const double part = std::clamp(fissure_way[i].second / edge, 0.0, 1.0);
    // a thin lobe is not cut through
    constexpr double kShare = 0.4, kStep = 1.0;
    Vec3 above = fissure_way[i].first;
    while (DomeDistance(above) < 0) above.y += kStep;
    const double thickness = above.y - fissure_way[i].first.y;
    fissure_.points.push_back(fissure_way[i].first);
    fissure_.radii.push_back(std::clamp(kShare * thickness, 1.0, 3.0 + 7.0 * part * part));
  }
  porta_ = {{OnViscera(-16, -12), OnViscera(-2, -10), OnViscera(8, -6)}, {3.5, 5.5, 3.5}};
}

/// Box of the lobes, from a coarse lattice: where lines along the axes leave them.
geometry::Box GeneratedBody::FindLiverBox() const {
  constexpr double kSpacing = 7.0, kReach = 10.0;  // mm
  geometry::Box lobes = kNothing;
  for (const Ellipsoid* lobe : {&right_, &lateral_, &left_, &tip_}) {
    Include(lobe->centre - lobe->radii, lobes);
    Include(lobe->centre + lobe->radii, lobes);
  }
  int size[3];
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = base::TruncateTo<int>((lobes.max[axis] - lobes.min[axis] + 2 * kReach) / kSpacing) + 2;
  const Vec3 first = lobes.min - Vec3{kReach, kReach, kReach};
  std::vector<double> values(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
  const int step[3] = {1, size[0], size[0] * size[1]};
  geometry::Box box = kNothing;
  for (int k = 0, at = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++at) {
        const Vec3 p = first + kSpacing * Vec3{double(i), double(j), double(k)};
        values[at] = LobesDistance(p);
        const int index[3] = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          if (index[axis] == 0) continue;
          const double before = values[at - step[axis]];
          if ((before < 0) == (values[at] < 0)) continue;
          Vec3 crossing = p;
          crossing[axis] -= kSpacing * values[at] / (values[at] - before);
          Include(crossing, box);
        }
      }
    }
  }
  return box;
}

/// Point of the visceral face above (x, z).
Vec3 GeneratedBody::OnViscera(double x, double z) const {
  const double a = (x - viscera_.centre.x) / viscera_.radii.x, b = (z - viscera_.centre.z) / viscera_.radii.z;
  return {x, viscera_.centre.y + viscera_.radii.y * std::sqrt(std::max(0.0, 1.0 - a * a - b * b)), z};
}

/// Points along the visceral face from above (x, z) in a level direction, with the length so far [mm].
std::vector<std::pair<Vec3, double>> GeneratedBody::FindVisceralWay(double x, double z,
                                                                    const Vec3& direction) const {
  constexpr int kSteps = 140;  // of 1 mm
  std::vector<std::pair<Vec3, double>> way;
  for (int i = 0; i <= kSteps; ++i) {
    const Vec3 p = OnViscera(x + i * direction.x, z + i * direction.z);
    way.emplace_back(p, way.empty() ? 0.0 : way.back().second + Distance(way.back().first, p));
  }
  return way;
}

/// Length of the way at which it leaves the liver in front.
double GeneratedBody::FindEdge(const std::vector<std::pair<Vec3, double>>& way) const {
  bool was_inside = false;
  for (const auto& [p, along] : way) {
    const bool is_inside = DomeDistance(p) < 0;
    if (was_inside && !is_inside) return along;
    was_inside = is_inside;
  }
  return way.back().second;
}

/// Along the visceral face, fundus in front of the edge.
/// \return inclination of its axis below the axial plane, before a fold [rad]
double GeneratedBody::MakeGallbladder(std::span<const patient::Parameter> parameters) {
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
  const double neck = number("gallbladder_neck");
  const double pouch = TextOf(parameters, "hartmann_pouch") == "yes" ? number("hartmann_pouch_depth") : 0.0;
  const auto radius_at = [&](double t) { return radius * CalcGallbladderProfile(t, neck); };
  // a pouch sags from the free wall of the infundibulum: steeply towards the duct, slowly towards the body
  const auto sag_at = [&](double t) {
    constexpr double kPlace = 0.09, kToDuct = 0.08, kToBody = 0.18;  // along the axis [-]
    const double away = (t - kPlace) / (t < kPlace ? kToDuct : kToBody);
    return pouch * Exp(-away * away);
  };

  const double azimuth = number("gallbladder_azimuth") * math::kDegree;
  const Vec3 direction = {-Sin(azimuth), 0, Cos(azimuth)};
  const double start = -0.5 * length;
  const auto way = FindVisceralWay(-13 * scale_.x + start * direction.x, start * direction.z, direction);
  const double tip = FindEdge(way) + number("fundus_overhang");
  const double bend = number("gallbladder_bend") * math::kDegree, embedding = number("gallbladder_embedding");
  const auto point_at = [&](double along) {
    std::size_t i = 0;
    while (i + 2 < way.size() && way[i + 1].second < along) ++i;
    const double t = (along - way[i].second) / (way[i + 1].second - way[i].second);
    return math::Lerp(way[i].first, way[i + 1].first, t);
  };
  const double from = tip - length + radius_at(0), to = tip - radius_at(1);
  constexpr int kParts = 26;
  Worm axis;
  for (int i = 0; i <= kParts; ++i) {
    const double t = static_cast<double>(i) / kParts;
    const Vec3 on = point_at(from + t * (to - from));
    const Vec3 below = -viscera_.OutwardAt(on);
    const Vec3 side = math::Normalized(Cross(below, direction));
    const double r = radius_at(t);
    // the neck hangs free of the fossa and turns towards the duct
    const double free = (1 - t) * (1 - t) * (1 - t), from_middle = 2 * t - 1;
    const double sagitta = length * bend / 8 * (1 - from_middle * from_middle);
    // as much radius as way, so that the wall on the liver's side stays; it lies over the duct
    const double sag = sag_at(t), wider = 0.35 * sag;
    axis.points.push_back(on + (r * (1 - 2 * embedding) + 5.0 * free + wider) * below + sagitta * side -
                          0.6 * sag * direction);
    axis.radii.push_back(r + wider);
  }
  const Vec3 whole = axis.points.back() - axis.points.front();
  if (TextOf(parameters, "phrygian_cap") == "yes") FoldFundus(axis);
  gallbladder_ = std::move(axis);
  const auto& points = gallbladder_.points;
  const Vec3 onwards = math::Normalized(points[0] - points[1]);
  // beside a pouch the duct leaves on the liver's side
  const Vec3 up = viscera_.OutwardAt(points[0]);
  const Vec3 way_out = pouch > 0 ? math::Normalized(onwards + up - Dot(up, onwards) * onwards) : onwards;
  neck_ = points[0] + gallbladder_.radii[0] * way_out;
  return Asin(std::clamp(-whole.y / Norm(whole), -1.0, 1.0));
}

/// Turns the last quarter of the axis back, away from the liver.
void GeneratedBody::FoldFundus(Worm& axis) const {
  const std::size_t n = axis.points.size(), hinge = n - n / 4;
  const Vec3 forward = math::Normalized(axis.points[hinge] - axis.points[hinge - 1]);
  const Vec3 below = -viscera_.OutwardAt(axis.points[hinge]);
  const Vec3 down = math::Normalized(below - Dot(below, forward) * forward);
  constexpr double kFold = 125 * math::kDegree;
  const double step = Distance(axis.points[hinge], axis.points[hinge - 1]);
  Vec3 at = axis.points[hinge - 1];
  for (std::size_t i = hinge; i < n; ++i) {
    const double turned = kFold * std::min(1.0, static_cast<double>(i - hinge + 1) / 3.0);
    at += step * (Cos(turned) * forward + Sin(turned) * down);
    axis.points[i] = at;
    axis.radii[i] *= 0.86;
  }
}

/// Pitches the visceral face until the gallbladder has its inclination, as far as the shape allows, and makes lobes
/// and gallbladder so.
void GeneratedBody::FindPitch(std::span<const patient::Parameter> parameters) {
  const double wanted = NumberOf(parameters, "gallbladder_inclination") * math::kDegree;
  double steep = -1.3, flat = 0.9;
  constexpr int kHalvings = 16;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (steep + flat);
    MakeLobes(middle);
    (MakeGallbladder(parameters) > wanted ? steep : flat) = middle;
  }
}

}  // namespace trocar::anatomy
