// SPDX-License-Identifier: Apache-2.0
#include "class_tables.h"

#include <algorithm>

namespace trocar::dataset {
namespace {

using cholecystectomy::InstrumentKind;
using cholecystectomy::Target;
using cholecystectomy::Verb;
using view::LabelClass;

constexpr std::array<SegmentationClass, 13> kCholecSeg8k = {
    {{0, "Black Background", 50, {127, 127, 127}},
     {1, "Abdominal Wall", 11, {210, 140, 140}},
     {2, "Liver", 21, {255, 114, 114}},
     {3, "Gastrointestinal Tract", 13, {231, 70, 156}},
     {4, "Fat", 12, {186, 183, 75}},
     {5, "Grasper", 31, {170, 255, 0}},
     {6, "Connective Tissue", 23, {255, 85, 0}},
     {7, "Blood", 24, {255, 0, 0}},
     {8, "Cystic Duct", 25, {255, 255, 0}},
     {9, "L-hook Electrocautery", 32, {169, 255, 184}},
     {10, "Gallbladder", 22, {255, 160, 165}},
     {11, "Hepatic Vein", 33, {0, 50, 128}},
     {12, "Liver Ligament", 5, {111, 74, 0}}}};
constexpr std::array<SegmentationClass, 7> kEndoscapes = {{{0, "background", 0, {0, 0, 0}},
                                                           {1, "cystic_plate", 0, {0, 0, 0}},
                                                           {2, "calot_triangle", 0, {0, 0, 0}},
                                                           {3, "cystic_artery", 0, {0, 0, 0}},
                                                           {4, "cystic_duct", 0, {0, 0, 0}},
                                                           {5, "gallbladder", 0, {0, 0, 0}},
                                                           {6, "tool", 0, {0, 0, 0}}}};

// the order is the data set's: an id is a place here
constexpr std::array<cholecystectomy::Triplet, 100> kTriplets = {
    {{InstrumentKind::kGrasper, Verb::kDissect, Target::kCysticPlate},
     {InstrumentKind::kGrasper, Verb::kDissect, Target::kGallbladder},
     {InstrumentKind::kGrasper, Verb::kDissect, Target::kOmentum},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kCysticArtery},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kCysticDuct},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kCysticPedicle},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kCysticPlate},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kGallbladder},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kGut},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kLiver},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kOmentum},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kPeritoneum},
     {InstrumentKind::kGrasper, Verb::kGrasp, Target::kSpecimenBag},
     {InstrumentKind::kGrasper, Verb::kPack, Target::kGallbladder},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kCysticDuct},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kCysticPedicle},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kCysticPlate},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kGallbladder},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kGut},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kLiver},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kOmentum},
     {InstrumentKind::kGrasper, Verb::kRetract, Target::kPeritoneum},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kAbdominalWallCavity},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kBloodVessel},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kCysticArtery},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kCysticDuct},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kCysticPedicle},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kCysticPlate},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kGallbladder},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kLiver},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kOmentum},
     {InstrumentKind::kBipolar, Verb::kCoagulate, Target::kPeritoneum},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kAdhesion},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kCysticArtery},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kCysticDuct},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kCysticPlate},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kGallbladder},
     {InstrumentKind::kBipolar, Verb::kDissect, Target::kOmentum},
     {InstrumentKind::kBipolar, Verb::kGrasp, Target::kCysticPlate},
     {InstrumentKind::kBipolar, Verb::kGrasp, Target::kLiver},
     {InstrumentKind::kBipolar, Verb::kGrasp, Target::kSpecimenBag},
     {InstrumentKind::kBipolar, Verb::kRetract, Target::kCysticDuct},
     {InstrumentKind::kBipolar, Verb::kRetract, Target::kCysticPedicle},
     {InstrumentKind::kBipolar, Verb::kRetract, Target::kGallbladder},
     {InstrumentKind::kBipolar, Verb::kRetract, Target::kLiver},
     {InstrumentKind::kBipolar, Verb::kRetract, Target::kOmentum},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kBloodVessel},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kCysticArtery},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kCysticDuct},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kCysticPedicle},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kCysticPlate},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kGallbladder},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kLiver},
     {InstrumentKind::kHook, Verb::kCoagulate, Target::kOmentum},
     {InstrumentKind::kHook, Verb::kCut, Target::kBloodVessel},
     {InstrumentKind::kHook, Verb::kCut, Target::kPeritoneum},
     {InstrumentKind::kHook, Verb::kDissect, Target::kBloodVessel},
     {InstrumentKind::kHook, Verb::kDissect, Target::kCysticArtery},
     {InstrumentKind::kHook, Verb::kDissect, Target::kCysticDuct},
     {InstrumentKind::kHook, Verb::kDissect, Target::kCysticPlate},
     {InstrumentKind::kHook, Verb::kDissect, Target::kGallbladder},
     {InstrumentKind::kHook, Verb::kDissect, Target::kOmentum},
     {InstrumentKind::kHook, Verb::kDissect, Target::kPeritoneum},
     {InstrumentKind::kHook, Verb::kRetract, Target::kGallbladder},
     {InstrumentKind::kHook, Verb::kRetract, Target::kLiver},
     {InstrumentKind::kScissors, Verb::kCoagulate, Target::kOmentum},
     {InstrumentKind::kScissors, Verb::kCut, Target::kAdhesion},
     {InstrumentKind::kScissors, Verb::kCut, Target::kBloodVessel},
     {InstrumentKind::kScissors, Verb::kCut, Target::kCysticArtery},
     {InstrumentKind::kScissors, Verb::kCut, Target::kCysticDuct},
     {InstrumentKind::kScissors, Verb::kCut, Target::kCysticPlate},
     {InstrumentKind::kScissors, Verb::kCut, Target::kLiver},
     {InstrumentKind::kScissors, Verb::kCut, Target::kOmentum},
     {InstrumentKind::kScissors, Verb::kCut, Target::kPeritoneum},
     {InstrumentKind::kScissors, Verb::kDissect, Target::kCysticPlate},
     {InstrumentKind::kScissors, Verb::kDissect, Target::kGallbladder},
     {InstrumentKind::kScissors, Verb::kDissect, Target::kOmentum},
     {InstrumentKind::kClipper, Verb::kClip, Target::kBloodVessel},
     {InstrumentKind::kClipper, Verb::kClip, Target::kCysticArtery},
     {InstrumentKind::kClipper, Verb::kClip, Target::kCysticDuct},
     {InstrumentKind::kClipper, Verb::kClip, Target::kCysticPedicle},
     {InstrumentKind::kClipper, Verb::kClip, Target::kCysticPlate},
     {InstrumentKind::kIrrigator, Verb::kAspirate, Target::kFluid},
     {InstrumentKind::kIrrigator, Verb::kDissect, Target::kCysticDuct},
     {InstrumentKind::kIrrigator, Verb::kDissect, Target::kCysticPedicle},
     {InstrumentKind::kIrrigator, Verb::kDissect, Target::kCysticPlate},
     {InstrumentKind::kIrrigator, Verb::kDissect, Target::kGallbladder},
     {InstrumentKind::kIrrigator, Verb::kDissect, Target::kOmentum},
     {InstrumentKind::kIrrigator, Verb::kIrrigate, Target::kAbdominalWallCavity},
     {InstrumentKind::kIrrigator, Verb::kIrrigate, Target::kCysticPedicle},
     {InstrumentKind::kIrrigator, Verb::kIrrigate, Target::kLiver},
     {InstrumentKind::kIrrigator, Verb::kRetract, Target::kGallbladder},
     {InstrumentKind::kIrrigator, Verb::kRetract, Target::kLiver},
     {InstrumentKind::kIrrigator, Verb::kRetract, Target::kOmentum},
     {InstrumentKind::kGrasper, Verb::kNullVerb, Target::kNullTarget},
     {InstrumentKind::kBipolar, Verb::kNullVerb, Target::kNullTarget},
     {InstrumentKind::kHook, Verb::kNullVerb, Target::kNullTarget},
     {InstrumentKind::kScissors, Verb::kNullVerb, Target::kNullTarget},
     {InstrumentKind::kClipper, Verb::kNullVerb, Target::kNullTarget},
     {InstrumentKind::kIrrigator, Verb::kNullVerb, Target::kNullTarget}}};

constexpr std::array<std::string_view, cholecystectomy::kPhaseCount> kPhases = {
    "preparation",           "carlot-triangle-dissection", "clipping-and-cutting",  "gallbladder-dissection",
    "gallbladder-packaging", "cleaning-and-coagulation",   "gallbladder-extraction"};

}  // namespace

std::span<const SegmentationClass> CholecSeg8kClasses() noexcept {
  return kCholecSeg8k;
}
std::span<const SegmentationClass> EndoscapesClasses() noexcept {
  return kEndoscapes;
}

int ToCholecSeg8k(LabelClass label) noexcept {
  switch (label) {
    case LabelClass::kAbdominalWall:
      return 1;
    case LabelClass::kLiver:
      return 2;
    case LabelClass::kBowel:
      return 3;
    case LabelClass::kOmentum:
    case LabelClass::kTriangleFat:
    case LabelClass::kLigamentFat:
      return 4;
    case LabelClass::kGrasper:
    case LabelClass::kDissector:
      return 5;
    case LabelClass::kConnectiveTissue:
    case LabelClass::kBileDuct:
    case LabelClass::kCysticArtery:
    case LabelClass::kArtery:
      return 6;
    case LabelClass::kBlood:
      return 7;
    case LabelClass::kCysticDuct:
      return 8;
    case LabelClass::kHook:
      return 9;
    case LabelClass::kGallbladder:
      return 10;
    default:
      return 0;
  }
}

int ToEndoscapes(LabelClass label) noexcept {
  switch (label) {
    case LabelClass::kTriangleFat:
      return 2;
    case LabelClass::kCysticArtery:
      return 3;
    case LabelClass::kCysticDuct:
      return 4;
    case LabelClass::kGallbladder:
      return 5;
    default:
      return view::ToolOf(label) ? 6 : 0;
  }
}

std::array<double, 3> EndoscapesCriteria(const scene::ViewScore& view) noexcept {
  // ours are triangle, plate, structures
  return {0.5 * view.Points(2), 0.5 * view.Points(0), 0.5 * view.Points(1)};
}

std::span<const cholecystectomy::Triplet> CholecT50Triplets() noexcept {
  return kTriplets;
}
int FindCholecT50Triplet(const cholecystectomy::Triplet& triplet) noexcept {
  const auto found = std::find(kTriplets.begin(), kTriplets.end(), triplet);
  return found == kTriplets.end() ? -1 : static_cast<int>(found - kTriplets.begin());
}

std::string_view CholecT50Name(cholecystectomy::Phase phase) noexcept {
  return kPhases[static_cast<std::size_t>(phase)];
}

}  // namespace trocar::dataset
