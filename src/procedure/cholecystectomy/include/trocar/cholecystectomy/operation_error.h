// SPDX-License-Identifier: Apache-2.0
/// \file operation_error.h  Errors of a cholecystectomy, how grave they are, and the record of them.
/// Source: domain facts, section 1.4.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"

namespace trocar::cholecystectomy {

enum class Severity : std::uint8_t { kMinor, kMajor, kCritical };
/// "minor", "major", "critical"
std::string_view NameOf(Severity severity) noexcept;

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
Severity SeverityOf(OperationError error) noexcept;

struct ErrorEntry {
  OperationError error = OperationError::kExcessForce;
  double time = 0;         ///< [s]
  math::Vec3 place;        ///< world frame [m]
  std::int32_t hand = -1;  ///< or -1
};

void VisitState(base::StateArchive& archive, ErrorEntry& entry);

/// Errors in the order in which they happened. One that goes on is one: the same error by the same hand counts again after
/// a pause.
class ErrorLog {
 public:
  static constexpr std::size_t kCapacity = 256;  ///< later ones are counted, not listed
  static constexpr double kPause = 2.0;          ///< [s]

  ErrorLog() { entries_.reserve(kCapacity); }
  /// \note Real-time safe.
  void Add(const ErrorEntry& entry) noexcept;
  void Clear() noexcept;
  std::span<const ErrorEntry> Entries() const { return entries_; }
  std::size_t Count(OperationError error) const noexcept;
  std::size_t Count(Severity severity) const noexcept;
  std::size_t Count() const noexcept;

  void VisitState(base::StateArchive& archive);

 private:
  static constexpr std::size_t kHands = 4;  // none, and up to three
  std::vector<ErrorEntry> entries_;
  std::array<std::size_t, kOperationErrorCount> counts_{};
  std::array<std::array<double, kHands>, kOperationErrorCount> last_{};
};

}  // namespace trocar::cholecystectomy
