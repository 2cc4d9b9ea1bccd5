// SPDX-License-Identifier: Apache-2.0
#include "trocar/patient/pathology.h"

#include <algorithm>
#include <string_view>
#include <variant>

#include "trocar/math/elementary.h"
#include "trocar/patient/patient.h"

namespace trocar::patient {
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

double NumberOf(const Patient& patient, std::string_view name, double otherwise) {
  const Parameter* parameter = patient.FindParameter(name);
  const double* number = parameter == nullptr ? nullptr : std::get_if<double>(&parameter->value);
  return number == nullptr ? otherwise : *number;
}

/// 1 for a slider at 0, `most` at 1, geometrically between.
double Grow(double most, double slider) {
  return slider == 0 ? 1.0 : math::Pow(most, std::clamp(slider, 0.0, 1.0));
}

}  // namespace

Pathology CalcPathology(const Patient& patient) {
  using roles::TissueRole;
  const auto slider = [&](std::string_view name) { return NumberOf(patient, name, 0.0); };
  Pathology pathology;
  const double stiff =
      Grow(kCirrhosisStiffness, slider("cirrhosis")) * Grow(kSteatosisStiffness, slider("steatosis"));
  MaterialFactors& liver = pathology.Of(TissueRole::kLiver);
  liver.young_modulus = liver.foundation_modulus = stiff;

  MaterialFactors& gallbladder = pathology.Of(TissueRole::kGallbladder);
  gallbladder.wall_thickness = NumberOf(patient, "gallbladder_wall", kUsualWallMm) / kUsualWallMm *
                               Grow(kAcuteThickness, slider("acute_cholecystitis")) *
                               Grow(kShrunkThickness, slider("scleroatrophy")) *
                               Grow(kHydropsThickness, slider("hydrops"));
  gallbladder.young_modulus = Grow(kShrunkStiffness, slider("scleroatrophy"));
  gallbladder.foundation_modulus = Grow(kHydropsFoundation, slider("hydrops"));

  const double fibrosis = slider("triangle_fibrosis");
  for (const TissueRole tube : {TissueRole::kDuct, TissueRole::kArtery})
    pathology.Of(tube).foundation_modulus = Grow(kFibrosisStiffness, fibrosis);
  pathology.Of(roles::kBedTissue).young_modulus = Grow(kFibrosisBed, fibrosis);
  pathology.bed_bleeding =
      Grow(kCirrhosisBleeding, slider("cirrhosis")) * Grow(kAcuteBleeding, slider("acute_cholecystitis"));
  pathology.adhesions = std::clamp(slider("adhesions"), 0.0, 1.0);
  return pathology;
}

}  // namespace trocar::patient
