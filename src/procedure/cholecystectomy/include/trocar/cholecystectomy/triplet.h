// SPDX-License-Identifier: Apache-2.0
/// \file triplet.h  Acts in the words of the public video data sets: instrument, verb, target.
///
/// Source: CholecT50 (instruments, verbs, targets) and Cholec80 (phases, tools), CAMMA; domain facts, section 1.1.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace trocar::cholecystectomy {

enum class InstrumentKind : std::uint8_t {
  kGrasper,
  kBipolar,
  kHook,
  kScissors,
  kClipper,
  kIrrigator,
  kSpecimenBag,
  kCount
};
enum class Verb : std::uint8_t {
  kGrasp,
  kRetract,
  kDissect,
  kCoagulate,
  kClip,
  kCut,
  kAspirate,
  kIrrigate,
  kPack,
  kNullVerb,
  kCount
};
enum class Target : std::uint8_t {
  kGallbladder,
  kCysticPlate,
  kCysticDuct,
  kCysticArtery,
  kCysticPedicle,
  kBloodVessel,
  kFluid,
  kAbdominalWallCavity,
  kLiver,
  kAdhesion,
  kOmentum,
  kPeritoneum,
  kGut,
  kSpecimenBag,
  kNullTarget,
  kCount
};
/// Names as the data sets write them: "grasper", "specimen_bag"; "dissect", "null_verb"; "cystic_plate", ...
std::string_view NameOf(InstrumentKind instrument) noexcept;
std::string_view NameOf(Verb verb) noexcept;
std::string_view NameOf(Target target) noexcept;

/// Act of one instrument on one target.
struct Triplet {
  InstrumentKind instrument = InstrumentKind::kGrasper;
  Verb verb = Verb::kNullVerb;
  Target target = Target::kNullTarget;

  friend bool operator==(const Triplet&, const Triplet&) = default;
};
/// "hook,dissect,cystic_plate"
std::string NameOf(const Triplet& triplet);

/// Phases by their names in Cholec80.
enum class Phase : std::uint8_t {
  kPreparation,
  kCalotTriangleDissection,
  kClippingCutting,
  kGallbladderDissection,
  kGallbladderPackaging,
  kCleaningCoagulation,
  kGallbladderRetraction,
  kCount
};
inline constexpr int kPhaseCount = static_cast<int>(Phase::kCount);
/// "Preparation", "CalotTriangleDissection", ...
std::string_view NameOf(Phase phase) noexcept;

}  // namespace trocar::cholecystectomy
