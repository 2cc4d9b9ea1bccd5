// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_words.h  A snapshot as a row of 64-bit words, one for each value, and rows as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

/// The row of a layout: which words there are.
struct WordRow {
  std::vector<std::size_t> lengths;               ///< of all lists, in the order of their visit
  std::size_t count = 0;                          ///< of words
  std::size_t first_position = 0, positions = 0;  ///< words of Snapshot::positions, three a node
  /// Of the kinds of all words and the lengths of all lists: the same on every platform, another where a field or an enumerator
  /// came or went.
  std::uint64_t fingerprint = 0;
};
WordRow DescribeRow(const Snapshot& shape);

/// \param words  (row.count)
/// \return false where a list has another length than in the row
/// \note Real-time safe.
bool WriteWords(const Snapshot& snapshot, const WordRow& row, std::span<std::uint64_t> words) noexcept;
/// \param words  (row.count)
/// \param[in,out] snapshot  of the row's lengths
/// \return false where a word is no value of its field: too large, or no enumerator
/// \note Real-time safe.
bool ReadWords(std::span<const std::uint64_t> words, Snapshot& snapshot) noexcept;

/// The most bytes that PutDelta writes, and what it may scribble on behind them.
std::size_t MostDeltaBytes(std::size_t words) noexcept;
/// Writes how `now` differs from `base`: blocks of eight words, each with the bits that its largest difference needs.
/// \param now, base  of the same length
/// \param[out] bytes  (MostDeltaBytes)
/// \return how many were written
/// \note Real-time safe.
std::size_t PutDelta(std::span<const std::uint64_t> now, std::span<const std::uint64_t> base,
                     std::span<std::byte> bytes) noexcept;
/// Reads what PutDelta wrote.
/// \param[out] now  of the length of `base`
/// \return false where the bytes are not exactly a difference of so many words
/// \note Real-time safe.
bool TakeDelta(std::span<const std::byte> bytes, std::span<const std::uint64_t> base,
               std::span<std::uint64_t> now) noexcept;

}  // namespace trocar::simulation
