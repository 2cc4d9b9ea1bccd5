// SPDX-License-Identifier: Apache-2.0
/// \file error_log.h  Errors of an operation: rows of a procedure's table, how grave they are, and the record of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"

namespace trocar::surgery {

enum class Severity : std::uint8_t { kMinor, kMajor, kCritical };
/// "minor", "major", "critical"
std::string_view NameOf(Severity severity) noexcept;

/// Row of a procedure's table of errors. States and recordings hold its number. A procedure names its rows by an enumeration of
/// its own, in their order.
struct ErrorId {
  std::uint8_t row = 0;

  constexpr ErrorId() = default;
  constexpr explicit ErrorId(std::uint8_t of) : row(of) {}
  template <typename Error>
  requires std::is_enum_v<Error> && std::is_same_v<std::underlying_type_t<Error>, std::uint8_t>
  constexpr ErrorId(Error error)
      : row(static_cast<std::uint8_t>(error)) {}  // NOLINT: the enumeration is the row's name

  friend constexpr bool operator==(ErrorId, ErrorId) = default;
};

/// An error of a procedure; constant.
struct ErrorRow {
  std::string_view name;         ///< in files: "clip_dropped"
  std::string_view explanation;  ///< for the trainee, a sentence
  Severity severity = Severity::kMinor;
};

struct ErrorEntry {
  ErrorId error;
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

  /// Of no procedure: there are no errors.
  ErrorLog() = default;
  /// \param table  outlives the log
  explicit ErrorLog(std::span<const ErrorRow> table);

  /// \pre  the error is a row of the table (TROCAR_ASSERT)
  /// \note Real-time safe.
  void Add(const ErrorEntry& entry) noexcept;
  void Clear() noexcept;
  std::span<const ErrorEntry> Entries() const { return entries_; }
  std::span<const ErrorRow> Table() const { return table_; }
  const ErrorRow& RowOf(const ErrorEntry& entry) const { return table_[entry.error.row]; }
  /// 0 of a row that there is not.
  std::size_t Count(ErrorId error) const noexcept;
  std::size_t Count(Severity severity) const noexcept;
  std::size_t Count() const noexcept;
  void VisitState(base::StateArchive& archive);

 private:
  static constexpr std::size_t kHands = 4;  // none, and up to three
  std::span<const ErrorRow> table_;         // constant
  std::vector<ErrorEntry> entries_;
  std::vector<std::size_t> counts_;               // (table)
  std::vector<std::array<double, kHands>> last_;  // (table) when it was seen last [s]; 0: never
};

}  // namespace trocar::surgery
