// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/hand_acts.h"

namespace trocar::cholecystectomy {

using instrument::ToolKind;
using surgery::FactKind;

InstrumentKind InstrumentOf(ToolKind tool) noexcept {
  switch (tool) {
    case ToolKind::kGrasper:
      return InstrumentKind::kGrasper;
    case ToolKind::kDissector:
      return InstrumentKind::kBipolar;
    case ToolKind::kHook:
      return InstrumentKind::kHook;
    case ToolKind::kScissors:
      return InstrumentKind::kScissors;
    case ToolKind::kClipApplier:
    case ToolKind::kLinearStapler:  // the data sets have none
      return InstrumentKind::kClipper;
    case ToolKind::kSuctionIrrigator:
      return InstrumentKind::kIrrigator;
    case ToolKind::kBag:
      return InstrumentKind::kSpecimenBag;
  }
  return InstrumentKind::kGrasper;
}

std::optional<Target> TargetOf(roles::OrganRole organ) noexcept {
  switch (organ) {
    case roles::OrganRole::kLiver:
      return Target::kLiver;
    case roles::OrganRole::kGallbladder:
      return Target::kGallbladder;
    case roles::OrganRole::kOther:
      break;
  }
  return std::nullopt;
}

Target TargetOf(roles::TubeRole tube) noexcept {
  if (tube == roles::TubeRole::kCysticDuct) return Target::kCysticDuct;
  return tube == roles::TubeRole::kCysticArtery ? Target::kCysticArtery : Target::kBloodVessel;
}

Target TargetOf(roles::StrandRole strand) noexcept {
  switch (strand) {
    case roles::StrandRole::kBed:
      return Target::kCysticPlate;
    case roles::StrandRole::kAdhesion:
      return Target::kAdhesion;
    case roles::StrandRole::kPeritoneum:
      return Target::kPeritoneum;
    case roles::StrandRole::kTriangle:
    case roles::StrandRole::kEnd:
    case roles::StrandRole::kBand:
      break;
  }
  return Target::kCysticPedicle;
}

Target TargetTable::OfSurface(std::int32_t surface) const noexcept {
  const auto i = static_cast<std::size_t>(surface);
  return surface >= 0 && i < surfaces.size() ? surfaces[i] : Target::kNullTarget;
}

Target TargetTable::Of(const surgery::Fact& fact) const noexcept {
  const auto strand = static_cast<std::size_t>(fact.strand);
  return fact.strand >= 0 && strand < strands.size() ? strands[strand] : OfSurface(fact.surface);
}

namespace {

Verb VerbOfCurrent(const surgery::Fact& fact) noexcept {
  if (!fact.is_coagulating) return Verb::kDissect;
  const bool is_bipolar = InstrumentOf(fact.tool) == InstrumentKind::kBipolar;
  return fact.strand >= 0 && !is_bipolar ? Verb::kDissect : Verb::kCoagulate;
}

}  // namespace

std::optional<Triplet> TripletOf(const surgery::Fact& fact, const TargetTable& targets) noexcept {
  const InstrumentKind tool = InstrumentOf(fact.tool);
  switch (fact.kind) {
    case FactKind::kStrandCut:
    case FactKind::kOrganCut:
    case FactKind::kTubeCut:
      return Triplet{tool, Verb::kCut, targets.Of(fact)};
    case FactKind::kStrandSpread:
      return Triplet{tool, Verb::kDissect, targets.Of(fact)};
    case FactKind::kCurrentInto:
      return Triplet{tool, VerbOfCurrent(fact), targets.Of(fact)};
    case FactKind::kClipClosed:
      return Triplet{tool, Verb::kClip, targets.Of(fact)};
    case FactKind::kRinse:
      return Triplet{
          tool, Verb::kIrrigate,
          targets.OfSurface(fact.surface) == Target::kLiver ? Target::kLiver : Target::kAbdominalWallCavity};
    case FactKind::kAspirate:
      return Triplet{tool, Verb::kAspirate, Target::kFluid};
    case FactKind::kBagOpen:
      return Triplet{tool, Verb::kPack, Target::kGallbladder};
    default:
      return std::nullopt;
  }
}

Triplet TripletOfHold(ToolKind tool, Target held, double pull, bool is_bag_open) noexcept {
  const bool is_packed = is_bag_open && held == Target::kGallbladder;
  return {InstrumentOf(tool),
          is_packed            ? Verb::kPack
          : pull > kRetraction ? Verb::kRetract
                               : Verb::kGrasp,
          held};
}

bool IsMoment(FactKind kind) noexcept {
  switch (kind) {
    case FactKind::kStrandCut:
    case FactKind::kOrganCut:
    case FactKind::kTubeCut:
    case FactKind::kStrandSpread:
    case FactKind::kClipClosed:
      return true;
    default:
      return false;
  }
}

void HandActs::Add(const Triplet& triplet, int hand, double seconds) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    if (acts_[i].triplet == triplet && hands_[i] == hand) return;
  }
  if (count_ == kCapacity) return;
  acts_[count_] = {triplet, seconds};
  hands_[count_++] = hand;
}

}  // namespace trocar::cholecystectomy
