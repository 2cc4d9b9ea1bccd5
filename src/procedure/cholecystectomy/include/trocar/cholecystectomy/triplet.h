// SPDX-License-Identifier: Apache-2.0
/// \file triplet.h  Acts in the words of the public video data sets: instrument, verb, target.
///
/// Source: CholecT50 (instruments, verbs, targets) and Cholec80 (phases, tools), CAMMA; domain facts, section 1.1.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "trocar/base/state_archive.h"

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

/// Progress of the operation so far.
struct OperationFacts {
  bool is_gallbladder_free = false;  ///< nothing holds it any more
  bool is_gallbladder_in_bag = false;
  bool is_bag_leaving = false;  ///< the bag is drawn into a port
};

/// Says in which phase an operation is, from what happens, in whatever order the surgeon chose.
///
/// Each act speaks for a phase; evidence fades with time, and another phase begins when it has clearly more of it.
class PhaseRecogniser {
 public:
  /// Seconds of work of one kind after which a phase has begun.
  static constexpr double kBeginSeconds = 2.0;
  /// In which evidence falls to 1/e [s].
  static constexpr double kFadeSeconds = 20.0;

  /// One tick.
  /// \param acts  of all instruments; those that do nothing may be left out
  /// \param seconds  > 0
  /// \note Real-time safe.
  void Update(std::span<const Triplet> acts, const OperationFacts& facts, double seconds) noexcept;

  Phase Current() const noexcept { return current_; }
  /// Time spent in a phase so far [s].
  double SecondsIn(Phase phase) const noexcept { return seconds_[static_cast<std::size_t>(phase)]; }

  void VisitState(base::StateArchive& archive);

 private:
  Phase current_ = Phase::kPreparation;
  std::array<double, kPhaseCount> evidence_{}, seconds_{};
};

}  // namespace trocar::cholecystectomy
