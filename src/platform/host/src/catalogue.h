// SPDX-License-Identifier: Apache-2.0
/// \file catalogue.h  A compiled catalogue of gettext read whole: its patterns, to find the one that a composed text was made from.
/// Source: GNU gettext manual, "The Format of GNU MO Files".
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trocar::host {

/// "cannot write {1}: {2}" and its translation.
struct CataloguePattern {
  std::vector<std::string> fixed;  ///< what stands before, between and after the places: one more than places
  std::vector<std::string> places;  ///< names, "1" or "each"
  std::string translation;
  std::size_t letters = 0;  ///< and signs in the fixed text; at least kLeastLetters
};

/// Letters and signs that a pattern's fixed text needs, so that "{1}: {2}" and "{1} of {2}" do not take everything.
inline constexpr std::size_t kLeastLetters = 3;

/// Names of places and what stood there.
using PatternPlaces = std::vector<std::pair<std::string, std::string>>;

/// The texts with places of a .mo file, the longest fixed text first. None of a file that is absent, damaged or of another byte order.
/// \note Not real-time safe: reads a file.
std::vector<CataloguePattern> ReadPatterns(const std::filesystem::path& file);

/// Texts at the pattern's places where the text has its fixed parts; else nothing. The parts are found from the left, each as
/// early as it can be; the last one ends the text.
std::optional<PatternPlaces> MatchPattern(const CataloguePattern& pattern, std::string_view text);

/// The text with {name} replaced by what stood there; unknown names stay.
std::string FillPattern(std::string_view text, const PatternPlaces& places);

}  // namespace trocar::host
