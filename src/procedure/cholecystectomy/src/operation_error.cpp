// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_error.h"

#include <array>

namespace trocar::cholecystectomy {
namespace {

using surgery::Severity;

struct Row {
  OperationError error;
  surgery::ErrorRow row;
};

constexpr Row kRows[kOperationErrorCount] = {
    {OperationError::kWrongStructureClipped,
     {"wrong_structure_clipped",
      "A clip closes a bile duct or artery that must stay open. Only cystic duct and cystic artery are "
      "clipped.",
      Severity::kCritical}},
    {OperationError::kWrongStructureCut,
     {"wrong_structure_cut",
      "A bile duct or artery that must stay was cut. Only cystic duct and cystic artery are divided.",
      Severity::kCritical}},
    {OperationError::kWrongStructureBurnt,
     {"wrong_structure_burnt",
      "Current burnt a hole into a bile duct or artery that must stay. Keep the electrode close to the "
      "gallbladder.",
      Severity::kCritical}},
    {OperationError::kUnclippedCut,
     {"unclipped_cut", "Cystic duct or artery was divided without a tight clip on the patient's side.",
      Severity::kCritical}},
    {OperationError::kClipBeforeCriticalView,
     {"clip_before_critical_view", "A clip was placed before the critical view of safety was reached.",
      Severity::kMajor}},
    {OperationError::kTooFewClips,
     {"too_few_clips", "Fewer than two clips stay on the patient's side of a divided structure.",
      Severity::kMajor}},
    {OperationError::kClipCrossed,
     {"clip_crossed", "Two clips lie across each other: neither holds safely.", Severity::kMajor}},
    {OperationError::kClipPartial,
     {"clip_partial",
      "A clip does not reach around the whole structure. Bring its heel to the vessel and see both tips.",
      Severity::kMajor}},
    {OperationError::kClipSlipped,
     {"clip_slipped",
      "A clip slipped off the end of a divided structure. It must reach around the whole of it, cross no "
      "other clip and be left "
      "alone.",
      Severity::kMajor}},
    {OperationError::kBleeding, {"bleeding", "More than 50 mL of blood were lost.", Severity::kMajor}},
    {OperationError::kGallbladderPerforated,
     {"gallbladder_perforated", "The gallbladder was opened: bile and stones spill.", Severity::kMajor}},
    {OperationError::kStonesLeft,
     {"stones_left",
      "Spilled stones were left in the abdomen, where they may cause abscesses. Suck up the small ones and "
      "put the others into "
      "the bag.",
      Severity::kMajor}},
    {OperationError::kLiverBurnt,
     {"liver_burnt", "The electrode burnt deep into the liver. Stay in the plane of the cystic plate.",
      Severity::kMajor}},
    {OperationError::kEnergyNearDuct,
     {"energy_near_duct", "Current was used within 5 mm of a main duct.", Severity::kMajor}},
    {OperationError::kEnergyOutOfView,
     {"energy_out_of_view", "The pedal was pressed while the electrode was out of the picture.",
      Severity::kMajor}},
    {OperationError::kEnergyWithoutContact,
     {"energy_without_contact", "The pedal was pressed while the electrode touched nothing.",
      Severity::kMinor}},
    {OperationError::kClipDropped,
     {"clip_dropped", "A clip closed around nothing and is lost.", Severity::kMinor}},
    {OperationError::kLiverGrasped,
     {"liver_grasped", "The liver was taken in the jaws: it tears and bleeds.", Severity::kMinor}},
    {OperationError::kExcessForce,
     {"excess_force", "Tissue was pinched or pulled harder than it bears.", Severity::kMinor}},
    {OperationError::kStructureTorn,
     {"structure_torn", "Tissue was torn by pulling; dissect it instead.", Severity::kMinor}},
    {OperationError::kBlindInsertion,
     {"blind_insertion",
      "A tool was pushed in while its tip was out of the picture. Follow it with the camera.",
      Severity::kMinor}},
};

constexpr bool AreRowsInOrder() {
  for (std::size_t i = 0; i < kOperationErrorCount; ++i) {
    if (static_cast<std::size_t>(kRows[i].error) != i) return false;
  }
  return true;
}
static_assert(AreRowsInOrder());

constexpr std::array<surgery::ErrorRow, kOperationErrorCount> kTable = [] {
  std::array<surgery::ErrorRow, kOperationErrorCount> table{};
  for (std::size_t i = 0; i < kOperationErrorCount; ++i) table[i] = kRows[i].row;
  return table;
}();

const surgery::ErrorRow& RowOf(OperationError error) noexcept {
  return kTable[static_cast<std::size_t>(error)];
}

}  // namespace

std::string_view NameOf(OperationError error) noexcept {
  return RowOf(error).name;
}

std::string_view ExplanationOf(OperationError error) noexcept {
  return RowOf(error).explanation;
}

Severity SeverityOf(OperationError error) noexcept {
  return RowOf(error).severity;
}

std::span<const surgery::ErrorRow> OperationErrors() noexcept {
  return kTable;
}

}  // namespace trocar::cholecystectomy
