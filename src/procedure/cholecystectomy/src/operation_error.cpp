// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_error.h"

#include <algorithm>
#include <numeric>

#include "trocar/math/state_fields.h"

namespace trocar::cholecystectomy {
namespace {

struct Row {
  OperationError error;
  Severity severity;
  std::string_view name, explanation;
};

constexpr Row kRows[kOperationErrorCount] = {
    {OperationError::kWrongStructureClipped, Severity::kCritical, "wrong_structure_clipped",
     "A clip closes a bile duct or artery that must stay open. Only cystic duct and cystic artery are "
     "clipped."},
    {OperationError::kWrongStructureCut, Severity::kCritical, "wrong_structure_cut",
     "A bile duct or artery that must stay was cut. Only cystic duct and cystic artery are divided."},
    {OperationError::kWrongStructureBurnt, Severity::kCritical, "wrong_structure_burnt",
     "Current burnt a hole into a bile duct or artery that must stay. Keep the electrode close to the "
     "gallbladder."},
    {OperationError::kUnclippedCut, Severity::kCritical, "unclipped_cut",
     "Cystic duct or artery was divided without a tight clip on the patient's side."},
    {OperationError::kClipBeforeCriticalView, Severity::kMajor, "clip_before_critical_view",
     "A clip was placed before the critical view of safety was reached."},
    {OperationError::kTooFewClips, Severity::kMajor, "too_few_clips",
     "Fewer than two clips stay on the patient's side of a divided structure."},
    {OperationError::kClipCrossed, Severity::kMajor, "clip_crossed",
     "Two clips lie across each other: neither holds safely."},
    {OperationError::kClipPartial, Severity::kMajor, "clip_partial",
     "A clip does not reach around the whole structure. Bring its heel to the vessel and see both tips."},
    {OperationError::kClipSlipped, Severity::kMajor, "clip_slipped",
     "A clip slipped off the end of a divided structure. It must reach around the whole of it, cross no "
     "other clip and be left "
     "alone."},
    {OperationError::kBleeding, Severity::kMajor, "bleeding", "More than 50 mL of blood were lost."},
    {OperationError::kGallbladderPerforated, Severity::kMajor, "gallbladder_perforated",
     "The gallbladder was opened: bile and stones spill."},
    {OperationError::kStonesLeft, Severity::kMajor, "stones_left",
     "Spilled stones were left in the abdomen, where they may cause abscesses. Suck up the small ones and "
     "put the others into "
     "the bag."},
    {OperationError::kLiverBurnt, Severity::kMajor, "liver_burnt",
     "The electrode burnt deep into the liver. Stay in the plane of the cystic plate."},
    {OperationError::kEnergyNearDuct, Severity::kMajor, "energy_near_duct",
     "Current was used within 5 mm of a main duct."},
    {OperationError::kEnergyOutOfView, Severity::kMajor, "energy_out_of_view",
     "The pedal was pressed while the electrode was out of the picture."},
    {OperationError::kEnergyWithoutContact, Severity::kMinor, "energy_without_contact",
     "The pedal was pressed while the electrode touched nothing."},
    {OperationError::kClipDropped, Severity::kMinor, "clip_dropped",
     "A clip closed around nothing and is lost."},
    {OperationError::kLiverGrasped, Severity::kMinor, "liver_grasped",
     "The liver was taken in the jaws: it tears and bleeds."},
    {OperationError::kExcessForce, Severity::kMinor, "excess_force",
     "Tissue was pinched or pulled harder than it bears."},
    {OperationError::kStructureTorn, Severity::kMinor, "structure_torn",
     "Tissue was torn by pulling; dissect it instead."},
    {OperationError::kBlindInsertion, Severity::kMinor, "blind_insertion",
     "A tool was pushed in while its tip was out of the picture. Follow it with the camera."},
};

constexpr bool AreRowsInOrder() {
  for (std::size_t i = 0; i < kOperationErrorCount; ++i) {
    if (static_cast<std::size_t>(kRows[i].error) != i) return false;
  }
  return true;
}
static_assert(AreRowsInOrder());

const Row& RowOf(OperationError error) noexcept {
  return kRows[static_cast<std::size_t>(error)];
}

}  // namespace

std::string_view NameOf(Severity severity) noexcept {
  constexpr std::string_view kNames[] = {"minor", "major", "critical"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::string_view NameOf(OperationError error) noexcept {
  return RowOf(error).name;
}

std::string_view ExplanationOf(OperationError error) noexcept {
  return RowOf(error).explanation;
}

Severity SeverityOf(OperationError error) noexcept {
  return RowOf(error).severity;
}

void ErrorLog::Add(const ErrorEntry& entry) noexcept {
  const auto error = static_cast<std::size_t>(entry.error);
  const auto hand = static_cast<std::size_t>(std::clamp(entry.hand + 1, 0, static_cast<int>(kHands) - 1));
  const bool goes_on = last_[error][hand] > 0.0 && entry.time - last_[error][hand] < kPause;
  last_[error][hand] = std::max(entry.time, 1e-9);
  if (goes_on) return;
  ++counts_[error];
  if (entries_.size() < kCapacity) entries_.push_back(entry);
}

void ErrorLog::Clear() noexcept {
  entries_.clear();
  std::fill(std::begin(counts_), std::end(counts_), std::size_t{0});
  for (auto& hands : last_) std::fill(std::begin(hands), std::end(hands), 0.0);
}

std::size_t ErrorLog::Count(OperationError error) const noexcept {
  return counts_[static_cast<std::size_t>(error)];
}

std::size_t ErrorLog::Count(Severity severity) const noexcept {
  std::size_t count = 0;
  for (const Row& row : kRows) count += row.severity == severity ? Count(row.error) : 0;
  return count;
}

std::size_t ErrorLog::Count() const noexcept {
  return std::accumulate(std::begin(counts_), std::end(counts_), std::size_t{0});
}

void VisitState(base::StateArchive& archive, ErrorEntry& entry) {
  archive.Field("error", entry.error);
  archive.Field("time", entry.time);
  archive.Field("place", entry.place);
  archive.Field("hand", entry.hand);
}

void ErrorLog::VisitState(base::StateArchive& archive) {
  archive.Field("entries", entries_);
  archive.Field("counts", counts_);
  archive.Field("last", last_);
  const auto is_known = [](const ErrorEntry& entry) { return entry.error < OperationError::kCount; };
  if (archive.IsRestoring() &&
      (entries_.size() > kCapacity || !std::all_of(entries_.begin(), entries_.end(), is_known))) {
    Clear();
    archive.Fail("lists errors that there are not");
  }
}

}  // namespace trocar::cholecystectomy
