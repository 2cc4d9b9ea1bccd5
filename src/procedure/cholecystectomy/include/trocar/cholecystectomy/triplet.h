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

/// Act of one hand in a tick, as evidence of a phase.
struct SeenAct {
  Triplet triplet;
  double seconds = 0;  ///< for which it counts, > 0
};

/// Progress of the operation so far.
struct OperationFacts {
  bool is_gallbladder_free = false;  ///< nothing holds it any more
  bool is_gallbladder_in_bag = false;
  bool is_bag_leaving = false;  ///< the bag is drawn into a port
  bool has_divided = false;     ///< a clip was closed, or a structure that enters the gallbladder was cut
  int structures_entering = 0;  ///< the gallbladder, and not cut
  bool is_upper_bed =
      false;  ///< in this tick the bed is dissected beyond its middle, seen from the infundibulum
};

/// Says in which phase an operation is, from what is done. docs/operation.md has the definitions.
///
/// Each act speaks for a phase, or for none; evidence fades with time, and another phase begins when it has clearly more of it.
/// Phases follow the order of Cholec80: dissection before the first clip is that of the hepatocystic triangle, the lower half of the
/// bed with it, which the critical view asks for; afterwards it is that of the gallbladder. Fluids are cleaned from when the
/// gallbladder is free. Nothing goes back to the preparation, and nothing to the triangle once a structure is clipped or cut.
class PhaseRecogniser {
 public:
  /// Seconds of work of one kind after which a phase has begun: one clip, one cut or one spread is as many.
  static constexpr double kBeginSeconds = 1.0;
  /// In which evidence falls to 1/e [s].
  static constexpr double kFadeSeconds = 20.0;

  /// One tick.
  /// \param acts  of all instruments, those included that only are there (null_verb)
  /// \param seconds  > 0
  /// \note Real-time safe.
  void Update(std::span<const SeenAct> acts, const OperationFacts& facts, double seconds) noexcept;

  Phase Current() const noexcept { return current_; }
  /// Time spent in a phase so far [s].
  double SecondsIn(Phase phase) const noexcept { return seconds_[static_cast<std::size_t>(phase)]; }

  void VisitState(base::StateArchive& archive);

 private:
  Phase current_ = Phase::kPreparation;
  std::array<double, kPhaseCount> evidence_{}, seconds_{};
};

}  // namespace trocar::cholecystectomy
