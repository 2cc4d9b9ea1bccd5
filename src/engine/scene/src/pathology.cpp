// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/pathology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"

namespace trocar::scene {
namespace {

// Literature compilation PMC6925591, table 1: shear modulus of liver 1.8 kPa, of diseased liver 19.8 kPa.
constexpr double kCirrhosisStiffness = 19.8 / 1.8;
// Fatty liver 5 to 7 kPa against 5.4 kPa: general knowledge, near normal.
constexpr double kSteatosisStiffness = 6.5 / 5.4;
constexpr double kUsualWallMm = 2.0;        // centre of the rule "gallbladder_wall": the scene's wall
constexpr double kAcuteThickness = 2.5;     // wall 2 to 3 times as thick (4 to 8 mm): general knowledge
constexpr double kShrunkThickness = 3.0;    // 4 to 10 mm: general knowledge
constexpr double kShrunkStiffness = 2.0;    // "stiff wall": no figure found, a tunable
constexpr double kHydropsThickness = 0.6;   // "thin wall": a tunable
constexpr double kHydropsFoundation = 5.0;  // tense, cannot be grasped: a tunable
constexpr double kFibrosisStiffness = 5.0;  // of what holds ducts and arteries in the triangle: a tunable
constexpr double kFibrosisBed = 2.0;        // likewise of the cystic plate: a tunable
// "bed bleeds", "easy bleeding": general knowledge, no figures found, tunables
constexpr double kCirrhosisBleeding = 4.0, kAcuteBleeding = 2.0;
constexpr double kAdhesionReach = 0.015;  // longest strand [m]
constexpr double kPatch = 0.012;          // size of a patch of adhesions [m]

double NumberOf(const patient::Patient& patient, std::string_view name, double otherwise) {
  const patient::Parameter* parameter = patient.FindParameter(name);
  const double* number = parameter == nullptr ? nullptr : std::get_if<double>(&parameter->value);
  return number == nullptr ? otherwise : *number;
}

/// 1 for a slider at 0, `most` at 1, geometrically between.
double Grow(double most, double slider) {
  return slider == 0 ? 1.0 : math::Pow(most, std::clamp(slider, 0.0, 1.0));
}

}  // namespace

Pathology CalcPathology(const patient::Patient& patient) {
  const auto slider = [&](std::string_view name) { return NumberOf(patient, name, 0.0); };
  Pathology pathology;
  const double stiff =
      Grow(kCirrhosisStiffness, slider("cirrhosis")) * Grow(kSteatosisStiffness, slider("steatosis"));
  pathology.liver.young_modulus = pathology.liver.foundation_modulus = stiff;

  pathology.gallbladder.wall_thickness = NumberOf(patient, "gallbladder_wall", kUsualWallMm) / kUsualWallMm *
                                         Grow(kAcuteThickness, slider("acute_cholecystitis")) *
                                         Grow(kShrunkThickness, slider("scleroatrophy")) *
                                         Grow(kHydropsThickness, slider("hydrops"));
  pathology.gallbladder.young_modulus = Grow(kShrunkStiffness, slider("scleroatrophy"));
  pathology.gallbladder.foundation_modulus = Grow(kHydropsFoundation, slider("hydrops"));

  const double fibrosis = slider("triangle_fibrosis");
  pathology.tubes.foundation_modulus = Grow(kFibrosisStiffness, fibrosis);
  pathology.bed.young_modulus = Grow(kFibrosisBed, fibrosis);
  pathology.bed_bleeding =
      Grow(kCirrhosisBleeding, slider("cirrhosis")) * Grow(kAcuteBleeding, slider("acute_cholecystitis"));
  pathology.adhesions = std::clamp(slider("adhesions"), 0.0, 1.0);
  return pathology;
}

std::vector<OrganMaterial> CalcPatientMaterials(const Scene& scene, const Pathology& pathology) {
  std::vector<OrganMaterial> materials = scene.materials;
  for (OrganMaterial& material : materials) {
    using roles::TissueRole;
    // one that names an organ of the patient's is of what the organ is
    if (material.tissue == TissueRole::kOther)
      material.tissue = roles::TissueOf(scene.patient.FindOrganRole(material.organ));
    MaterialFactors factors;
    if (material.tissue == TissueRole::kLiver) factors = pathology.liver;
    if (material.tissue == TissueRole::kGallbladder) factors = pathology.gallbladder;
    if (material.tissue == TissueRole::kGallbladderBed) factors = pathology.bed;
    if (material.tissue == TissueRole::kDuct || material.tissue == TissueRole::kArtery)
      factors = pathology.tubes;
    material.young_modulus *= factors.young_modulus;
    material.wall_thickness *= factors.wall_thickness;
    material.foundation_modulus *= factors.foundation_modulus;
    material.density *= factors.density;
  }
  return materials;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> FindAdhesions(const patient::Patient& patient,
                                                                   double share) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  const int liver = patient.OrganOf(roles::OrganRole::kLiver),
            gallbladder = patient.OrganOf(roles::OrganRole::kGallbladder);
  if (liver < 0 || gallbladder < 0 || !(share > 0)) return pairs;
  std::set<std::uint32_t> bed;
  if (const auto* region = patient.organs[gallbladder].RegionOf(roles::RegionRole::kGallbladderBed))
    bed.insert(region->vertices.begin(), region->vertices.end());
  const auto& wall = patient.organs[gallbladder].mesh.positions;
  const auto& surface = patient.organs[liver].mesh.positions;
  for (std::uint32_t v = 0; v < wall.size(); ++v) {
    if (bed.contains(v)) continue;
    // a patch has grown together or it has not: the same patches come first for every share
    std::uint64_t word = 0x61646865ULL;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = static_cast<std::int64_t>(std::floor(wall[v][axis] / kPatch));
      word = math::Random(word ^ static_cast<std::uint64_t>(cell)).NextWord();
    }
    if (math::Random(word).Uniform() >= share) continue;
    double nearest = std::numeric_limits<double>::max();
    std::uint32_t carrier = 0;
    for (std::uint32_t w = 0; w < surface.size(); ++w) {
      const double distance = math::SquaredDistance(wall[v], surface[w]);
      if (distance < nearest) nearest = distance, carrier = w;
    }
    if (nearest <= kAdhesionReach * kAdhesionReach) pairs.emplace_back(v, carrier);
  }
  return pairs;
}

}  // namespace trocar::scene
