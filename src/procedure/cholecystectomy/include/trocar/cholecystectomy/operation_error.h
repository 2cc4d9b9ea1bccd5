// SPDX-License-Identifier: Apache-2.0
/// \file operation_error.h  Errors of a cholecystectomy, and how grave they are.
/// Source: domain facts, section 1.4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "trocar/surgery/error_log.h"

namespace trocar::cholecystectomy {

enum class OperationError : std::uint8_t {
  // critical: the operation has failed
  kWrongStructureClipped,  ///< a main duct or the right hepatic artery
  kWrongStructureCut,
  kWrongStructureBurnt,
  kUnclippedCut,  ///< cystic duct or artery divided without a clip on the side that stays
  // major
  kClipBeforeCriticalView,
  kTooFewClips,  ///< fewer than two stay with the patient
  kClipCrossed,
  kClipPartial,
  kClipSlipped,  ///< off the end of what it closed
  kBleeding,     ///< more than 50 mL
  kGallbladderPerforated,
  kStonesLeft,  ///< spilled and not retrieved, when the gallbladder has left
  kLiverBurnt,
  kEnergyNearDuct,  ///< current within 5 mm of a main duct
  kEnergyOutOfView,
  // minor
  kEnergyWithoutContact,
  kClipDropped,
  kLiverGrasped,
  kExcessForce,
  kStructureTorn,
  kBlindInsertion,
  kCount
};
inline constexpr std::size_t kOperationErrorCount = static_cast<std::size_t>(OperationError::kCount);

/// "wrong_structure_clipped", ...
std::string_view NameOf(OperationError error) noexcept;
/// Explanation for the trainee, a sentence.
std::string_view ExplanationOf(OperationError error) noexcept;
surgery::Severity SeverityOf(OperationError error) noexcept;

/// All of them, in the order of the enumeration.
std::span<const surgery::ErrorRow> OperationErrors() noexcept;

}  // namespace trocar::cholecystectomy
