// SPDX-License-Identifier: Apache-2.0
#include "phantom_tissue.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/distance.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using math::Hypot;
using math::Pow;
using math::Vec3;

constexpr int kLattice = 32;  // values a side
constexpr double kSkinMm = 2.2, kFatMm = 13, kMuscleMm = 9;
constexpr double kDiaphragmMm = 4;
constexpr double kMidlineShare = 0.61;  // of the liver's width, from the right, at which the spine lies

/// Colour, the colour towards which its texture goes, how strong and how coarse that is.
struct Look {
  Tint base, other;
  double amount, wavelength;
};
constexpr std::array<Look, static_cast<std::size_t>(Substance::kCount)> kLooks = {{
    {{44, 60, 108}, {54, 72, 122}, 0.5, 60},     // gel
    {{196, 158, 118}, {214, 180, 140}, 0.6, 6},  // skin
    {{214, 174, 92}, {242, 214, 142}, 0.9, 7},   // fat
    {{118, 44, 38}, {158, 80, 62}, 0.9, 5},      // muscle
    {{206, 176, 132}, {150, 92, 62}, 0.9, 3},    // bone
    {{186, 176, 156}, {206, 198, 180}, 0.6, 8},  // disc
    {{226, 212, 184}, {236, 226, 204}, 0.4, 5},  // cord
    {{78, 42, 44}, {148, 104, 98}, 1.0, 4},      // lung
    {{112, 40, 34}, {146, 66, 50}, 0.8, 9},      // heart
    {{46, 14, 20}, {66, 22, 26}, 0.6, 7},        // blood
    {{184, 146, 122}, {200, 166, 140}, 0.5, 4},  // vessel wall
    {{182, 116, 94}, {206, 146, 120}, 0.8, 5},   // bowel wall
    {{124, 96, 52}, {160, 130, 78}, 0.9, 9},     // bowel content
    {{116, 52, 42}, {138, 70, 54}, 0.6, 6},      // kidney
    {{86, 32, 34}, {108, 48, 44}, 0.8, 5},       // medulla
    {{80, 26, 34}, {98, 40, 44}, 0.7, 4},        // spleen
    {{206, 176, 128}, {226, 200, 156}, 0.7, 5},  // connective
    {{98, 46, 32}, {126, 66, 46}, 0.8, 11},      // liver
    {{96, 92, 42}, {114, 106, 54}, 0.6, 5},      // gallbladder wall, stained by bile
    {{62, 68, 26}, {84, 90, 40}, 0.7, 14},       // bile
    {{168, 158, 84}, {186, 176, 108}, 0.5, 4},   // duct
    {{150, 44, 36}, {170, 66, 54}, 0.5, 4},      // artery
    {{46, 14, 20}, {66, 22, 26}, 0.6, 7},        // blood of the aorta
}};

/// Distance to the axis of a pipe and the nearest axis point [mm].
double AxisDistance(const PhantomBody::Pipe& pipe, const Vec3& p, Vec3& nearest) {
  double best = 1e9;
  for (std::size_t i = 0; i + 1 < pipe.points.size(); ++i) {
    const double t = geometry::FindNearestOnSegment(p, pipe.points[i], pipe.points[i + 1]);
    const Vec3 at = math::Lerp(pipe.points[i], pipe.points[i + 1], t);
    const double distance = math::Distance(p, at);
    if (distance < best) best = distance, nearest = at;
  }
  return best;
}

/// The pipes' segments that come near the height y, as pipes of their own.
std::vector<PhantomBody::Pipe> Near(const std::vector<PhantomBody::Pipe>& pipes, double y) {
  std::vector<PhantomBody::Pipe> near;
  for (const PhantomBody::Pipe& pipe : pipes) {
    for (std::size_t i = 0; i + 1 < pipe.points.size(); ++i) {
      const auto [low, high] = std::minmax(pipe.points[i].y, pipe.points[i + 1].y);
      if (y < low - pipe.radius || y > high + pipe.radius) continue;
      PhantomBody::Pipe part = pipe;
      part.points = {pipe.points[i], pipe.points[i + 1]};
      near.push_back(std::move(part));
    }
  }
  return near;
}

Vec3 Millimetres(const Vec3& metres) {
  return 1000.0 * metres;
}

BodyPlan PlanBody(const patient::Patient& patient) {
  const auto box = [&](roles::OrganRole role) {
    return geometry::CalcBox(patient.organs[patient.OrganOf(role)].mesh.positions);
  };
  const geometry::Box liver = box(roles::OrganRole::kLiver),
                      gallbladder = box(roles::OrganRole::kGallbladder);
  const patient::Landmark* fundus = patient.LandmarkOf(roles::LandmarkRole::kFundus);
  const patient::Landmark* neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  BodyPlan plan;
  plan.liver = {Millimetres(liver.min), Millimetres(liver.max)};
  plan.lowest = 1000.0 * gallbladder.min.y;
  plan.fundus = Millimetres(fundus != nullptr ? fundus->position : gallbladder.min);
  plan.porta = Millimetres(neck != nullptr ? neck->position : gallbladder.max);
  return plan;
}

}  // namespace

NoiseField::NoiseField(std::uint64_t seed) : values_(kLattice * kLattice * kLattice) {
  math::Random random(seed ^ 0x7068616e746f6dULL);
  for (float& value : values_) value = static_cast<float>(random.Uniform(-1.0, 1.0));
}

double NoiseField::At(const Vec3& p, double wavelength) const {
  int low[3], high[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double at = 2.0 * p[axis] / wavelength;
    const double cell = std::floor(at), t = at - cell;
    low[axis] = base::TruncateTo<int>(cell) & (kLattice - 1);
    high[axis] = (low[axis] + 1) & (kLattice - 1);
    part[axis] = t * t * (3 - 2 * t);
  }
  const auto value = [&](int x, int y, int z) { return values_[(z * kLattice + y) * kLattice + x]; };
  const auto row = [&](int y, int z) {
    return value(low[0], y, z) + part[0] * (value(high[0], y, z) - value(low[0], y, z));
  };
  const auto plane = [&](int z) { return row(low[1], z) + part[1] * (row(high[1], z) - row(low[1], z)); };
  return plane(low[2]) + part[2] * (plane(high[2]) - plane(low[2]));
}

Tint CalcTint(Substance substance, const Vec3& p, const NoiseField& noise) {
  const Look& look = kLooks[static_cast<std::size_t>(substance)];
  // each substance has its own place in the noise
  const Substance place = substance == Substance::kAorticBlood ? Substance::kBlood : substance;
  const Vec3 moved = p + 37.0 * static_cast<double>(place) * Vec3{1, 0.7, 0.3};
  const double share = std::clamp(0.5 + look.amount * 0.75 * noise.Rough(moved, look.wavelength), 0.0, 1.0);
  Tint tint;
  for (int i = 0; i < 3; ++i) tint[i] = look.base[i] + share * (look.other[i] - look.base[i]);
  return tint;
}

double PhantomBody::Ball::Distance(const Vec3& p) const {
  const Vec3 q = {(p.x - centre.x) / radii.x, (p.y - centre.y) / radii.y, (p.z - centre.z) / radii.z};
  const Vec3 g = {q.x / radii.x, q.y / radii.y, q.z / radii.z};
  const double length = Norm(q), slope = Norm(g);
  return slope > 0 ? length * (length - 1.0) / slope : -std::min({radii.x, radii.y, radii.z});
}

PhantomBody::PhantomBody(const patient::Patient& patient, std::uint64_t seed)
    : PhantomBody(PlanBody(patient), seed) {}

PhantomBody::PhantomBody(const BodyPlan& plan, std::uint64_t seed) : noise_(seed), liver_(plan.liver) {
  const Vec3 &fundus = plan.fundus, &porta = plan.porta;
  const double mid = midline_ = liver_.min.x + kMidlineShare * (liver_.max.x - liver_.min.x);
  const double top = liver_.max.y, bottom = liver_.min.y, back = liver_.min.z, front = liver_.max.z;
  half_width_ = std::max({160.0, mid - liver_.min.x + 32, liver_.max.x - mid + 32});
  const double last = back - 92, first = front + 32;
  middle_z_ = 0.5 * (first + last);
  half_depth_ = 0.5 * (first - last);
  constexpr double kBlock = 14;  // of gel around the body
  const double lowest = std::min(bottom, plan.lowest);
  extent_ = {{mid - half_width_ - kBlock, lowest - 12, last - kBlock},
             {mid + half_width_ + kBlock, top + 10, first + kBlock}};

  right_kidney_ = {{mid - 76, bottom + 36, back - 6}, {27, 48, 26}};
  left_kidney_ = {{mid + 72, bottom + 52, back - 6}, {27, 50, 26}};
  spleen_ = {{mid + 106, top - 66, back + 6}, {28, 46, 38}};
  stomach_ = {{mid + 50, top - 84, back + 42}, {56, 44, 38}};
  heart_ = {{mid + 28, top + 16, front - 46}, {50, 30, 40}};

  const auto gut = [&](std::vector<Vec3> points, double radius, double gas) {
    pipes_.push_back({std::move(points), radius, 2.6, Substance::kBowelWall, Substance::kBowelContent, gas});
  };
  // the colon's right flexure lies beside the gallbladder, full of gas: the hard case of the photographs
  gut({{mid - 108, bottom - 40, back + 14},
       {mid - 106, bottom + 6, back + 26},
       {fundus.x - 30, fundus.y - 8, fundus.z - 44},
       {fundus.x + 20, fundus.y + 2, fundus.z - 26},
       {mid - 10, fundus.y - 46, front - 22},
       {mid + 70, fundus.y - 34, front - 26},
       {mid + 118, top - 96, back + 50},
       {mid + 116, bottom - 30, back + 22}},
      21, -0.35);
  // duodenum around the pancreas' head
  gut({{mid + 14, porta.y - 16, back + 52},
       {mid - 22, porta.y - 14, back + 50},
       {mid - 36, porta.y - 34, back + 34},
       {mid - 34, bottom - 30, back + 28}},
      13, 0.5);
  math::Random random(seed ^ 0x626f77656cULL);
  Vec3 at = {mid + 60, fundus.y - 60, back + 50};
  std::vector<Vec3> loops;
  for (int i = 0; i < 26; ++i) {
    loops.push_back(at);
    at = {std::clamp(at.x + random.Uniform(-62, 62), mid - 80, mid + 100),
          std::clamp(at.y + random.Uniform(-26, 26), extent_.min.y - 20, fundus.y - 30),
          std::clamp(at.z + random.Uniform(-48, 48), back + 26, front - 22)};
  }
  gut(loops, 12, 0.8);
  pipes_.push_back({{{mid + 9, extent_.min.y - 20, back + 17}, {mid + 5, extent_.max.y + 20, back + 13}},
                    10.5,
                    1.6,
                    Substance::kVesselWall,
                    Substance::kAorticBlood});
  pipes_.push_back({{{mid - 19, extent_.min.y - 20, back + 14}, {mid - 22, extent_.max.y + 20, back + 22}},
                    11,
                    0.8,
                    Substance::kVesselWall,
                    Substance::kBlood});

  const auto vein = [&](std::vector<Vec3> points, double radius, double wall) {
    veins_.push_back({std::move(points), radius, wall, Substance::kVesselWall, Substance::kBlood});
  };
  const Vec3 cava = {mid - 21, top - 24, back + 24};
  const double x0 = liver_.min.x, width = liver_.max.x - liver_.min.x;
  vein({cava, {x0 + 0.30 * width, top - 50, middle_z_ + 4}, {x0 + 0.16 * width, bottom + 60, middle_z_ + 20}},
       4.5, 0.4);
  vein({cava, {x0 + 0.42 * width, top - 44, front - 50}, {x0 + 0.40 * width, bottom + 84, front - 26}}, 4.2,
       0.4);
  vein({cava, {x0 + 0.62 * width, top - 36, front - 48}, {x0 + 0.80 * width, top - 44, front - 34}}, 3.6,
       0.4);
  const Vec3 gate = porta + Vec3{14, 8, -4};
  vein({gate,
        {x0 + 0.36 * width, porta.y + 22, porta.z - 14},
        {x0 + 0.20 * width, porta.y + 26, middle_z_ + 10}},
       5.2, 1.2);
  vein({{x0 + 0.30 * width, porta.y + 24, porta.z - 12},
        {x0 + 0.22 * width, porta.y - 18, middle_z_ - 6},
        {x0 + 0.2 * width, bottom + 40, middle_z_}},
       3.6, 1.0);
  vein({gate,
        {x0 + 0.60 * width, porta.y + 34, porta.z + 10},
        {x0 + 0.72 * width, porta.y + 46, porta.z + 26}},
       4.2, 1.2);
}

std::vector<PhantomBody::Pipe> PhantomBody::FindPipes(double y) const {
  return Near(pipes_, y);
}
std::vector<PhantomBody::Pipe> PhantomBody::FindVeins(double y) const {
  return Near(veins_, y);
}

/// Depth below the skin [mm], first order; negative outside.
double PhantomBody::OutlineDepth(const Vec3& p) const {
  constexpr double kRoundness = 2.4;  // 2: an ellipse
  const double x = std::fabs(p.x - midline_) / half_width_, z = std::fabs(p.z - middle_z_) / half_depth_;
  const double a = Pow(x, kRoundness), b = Pow(z, kRoundness);
  const double f = Pow(a + b, 1 / kRoundness);
  if (f < 0.3) return half_depth_;
  const double scale = Pow(f, 1 - kRoundness);
  const double slope =
      Hypot(scale * Pow(x, kRoundness - 1) / half_width_, scale * Pow(z, kRoundness - 1) / half_depth_);
  return (1 - f) / slope + 1.5 * noise_.At({p.x, p.y, p.z}, 120);
}

Substance PhantomBody::FindWall(const Vec3& p, double depth) const {
  if (depth < kSkinMm) return Substance::kSkin;
  const double fat = kFatMm * (1 + 0.25 * noise_.At(p, 150));
  if (depth < fat) return Substance::kFat;
  // ribs run down to the front, below them only muscle
  constexpr double kRibDistance = 31, kRibSlope = 0.5, kRibHalf = 5.5;
  const double along = p.y + kRibSlope * (p.z - middle_z_);
  const double to_rib = std::fabs(along - kRibDistance * std::round(along / kRibDistance));
  const bool has_ribs = p.y > liver_.min.y + 0.5 * (p.z - middle_z_);
  const double in_muscle = depth - fat;
  const double off_middle = in_muscle - 0.5 * kMuscleMm;
  if (has_ribs && to_rib * to_rib + 2.2 * off_middle * off_middle < kRibHalf * kRibHalf)
    return Substance::kBone;
  // layers of muscle with thin fat between them
  return std::fabs(in_muscle - 0.45 * kMuscleMm) < 0.5 && !has_ribs ? Substance::kFat : Substance::kMuscle;
}

Substance PhantomBody::FindSpine(const Vec3& p, bool& is_there) const {
  is_there = true;
  const double x = p.x - midline_, z = p.z - (liver_.min.z - 8);
  constexpr double kVertebra = 33, kDiscHeight = 8;
  if (Hypot(x / 21, z / 16) < 1) {
    return p.y - kVertebra * std::floor(p.y / kVertebra) < kDiscHeight ? Substance::kDisc : Substance::kBone;
  }
  const double canal = Hypot(x, z + 24);
  if (canal < 5) return Substance::kCord;
  if (canal < 8) return Substance::kFat;
  const bool has_arch = p.y - kVertebra * std::floor(p.y / kVertebra) > 12;
  if (has_arch && (canal < 12 || (std::fabs(x) < 3.5 && z < -30 && z > -58))) return Substance::kBone;
  if (has_arch && std::fabs(z + 20) < 4 && std::fabs(x) < 34) return Substance::kBone;
  for (const double side : {-1.0, 1.0}) {
    if (Hypot((x - side * 29) / 27, (z + 38) / 22) < 1) return Substance::kMuscle;
    const bool is_low = p.y < liver_.min.y + 90;
    if (is_low && Hypot((x - side * 34) / 14, (z + 4) / 13) < 1) return Substance::kMuscle;
    // crura of the diaphragm
    if (Hypot((x - side * 15) / 6, (z - 15) / 10) < 1) return Substance::kMuscle;
  }
  is_there = false;
  return Substance::kFat;
}

Substance PhantomBody::Find(const Vec3& place, const std::vector<Pipe>& pipes, double liver_distance) const {
  const double depth = OutlineDepth(place);
  if (depth < 0) return Substance::kGel;
  // nothing in a body is as even as a formula
  constexpr double kBend = 3.0, kBendLength = 34;
  const Vec3 p = place + kBend * Vec3{noise_.At(place, kBendLength), 0,
                                      noise_.At(place + Vec3{91, 57, 23}, kBendLength)};
  const double wall = kFatMm * (1 + 0.25 * noise_.At(p, 150)) + kMuscleMm;
  bool is_spine = false;
  const Substance spine = FindSpine(p, is_spine);
  if (is_spine && depth > kFatMm) return spine;
  if (depth < wall) return FindWall(p, depth);

  for (const Pipe& pipe : pipes) {
    Vec3 axis;
    const double distance = AxisDistance(pipe, p, axis);
    if (distance > pipe.radius) continue;
    if (distance > pipe.radius - pipe.wall) return pipe.skin;
    // gas rises to the front of a person who lies on the back
    return p.z - axis.z > pipe.gas * pipe.radius ? Substance::kGel : pipe.filling;
  }
  const double spleen = spleen_.Distance(p), stomach = stomach_.Distance(p), heart = heart_.Distance(p);
  if (heart < 0) return heart > -7 && noise_.At(p, 30) > 0.2 ? Substance::kFat : Substance::kHeart;
  if (spleen < 0) return Substance::kSpleen;
  if (stomach < 0) {
    if (stomach > -4) return Substance::kBowelWall;
    return p.z > stomach_.centre.z + 12 ? Substance::kGel : Substance::kBowelContent;
  }
  for (const Ball* kidney : {&right_kidney_, &left_kidney_}) {
    const double inside = kidney->Distance(p);
    if (inside > 0) continue;
    const Vec3 from_hilum = p - kidney->centre - Vec3{kidney->centre.x < midline_ ? 15.0 : -15.0, 0, 3};
    const Vec3 by_axis{from_hilum.x / 15, from_hilum.y / 22, from_hilum.z / 8};
    if (Norm(by_axis) < 1 + 0.5 * noise_.At(p, 16)) return Substance::kFat;
    return inside > -9 || noise_.At(p, 18) > 0.3 ? Substance::kKidney : Substance::kMedulla;
  }
  // the lungs reach down furthest behind
  const double lung_floor =
      liver_.max.y - 0.34 * (liver_.max.y - liver_.min.y) + 0.45 * (p.z - middle_z_) + 9.0 * noise_.At(p, 60);
  if (p.y > lung_floor) {
    const double to_organ = std::min({liver_distance, spleen, stomach});
    if (to_organ < kDiaphragmMm) return Substance::kMuscle;
    // fat around the great vessels, and around the heart
    const bool is_between = Hypot((p.x - midline_) / 32, (p.z - liver_.min.z - 16) / 34) < 1 || heart < 14;
    if (!is_between) return Substance::kLung;
  }
  return liver_distance < 3 ? Substance::kConnective : Substance::kFat;
}

Substance PhantomBody::FindInLiver(const Vec3& p, const std::vector<Pipe>& veins) const {
  for (const Pipe& vein : veins) {
    Vec3 axis;
    const double distance = AxisDistance(vein, p, axis);
    if (distance < vein.radius) return distance > vein.radius - vein.wall ? vein.skin : vein.filling;
  }
  return Substance::kLiver;
}

}  // namespace trocar::anatomy
