// SPDX-License-Identifier: Apache-2.0
#include "catalogue.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "trocar/host/safe_file.h"

namespace trocar::host {
namespace {

constexpr std::uint32_t kMagic = 0x950412de;
constexpr char kContextEnd = '\004';

/// Reads 32-bit numbers and texts within the file's bounds.
class MoFile {
 public:
  explicit MoFile(std::string bytes) : bytes_(std::move(bytes)) {}

  std::uint32_t Number(std::size_t at) const {
    std::uint32_t value = 0;
    if (at <= bytes_.size() && bytes_.size() - at >= sizeof value)
      std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }

  /// Of a table's row: length and offset; the first of several plurals.
  std::string_view Text(std::size_t row) const {
    const std::size_t length = Number(row), offset = Number(row + 4);
    if (offset > bytes_.size() || length > bytes_.size() - offset) return {};
    const std::string_view text(bytes_.data() + offset, length);
    return text.substr(0, text.find('\0'));
  }

  std::size_t Size() const { return bytes_.size(); }

 private:
  std::string bytes_;
};

bool IsPlaceName(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

CataloguePattern ParsePattern(std::string_view text, std::string_view translation) {
  CataloguePattern pattern{{""}, {}, std::string(translation), 0};
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    const std::size_t close = open == std::string_view::npos ? open : text.find('}', open);
    if (close == std::string_view::npos) {
      pattern.fixed.back() += text;
      break;
    }
    const std::string_view name = text.substr(open + 1, close - open - 1);
    pattern.fixed.back() += text.substr(0, open);
    if (IsPlaceName(name)) {
      pattern.places.emplace_back(name);
      pattern.fixed.emplace_back();
    } else {
      pattern.fixed.back() += text.substr(open, close - open + 1);
    }
    text.remove_prefix(close + 1);
  }
  for (const std::string& part : pattern.fixed)
    pattern.letters +=
        static_cast<std::size_t>(std::count_if(part.begin(), part.end(), [](char c) { return c != ' '; }));
  return pattern;
}

}  // namespace

std::vector<CataloguePattern> ReadPatterns(const std::filesystem::path& file) {
  auto bytes = ReadFile(file);
  if (!bytes.ok()) return {};
  const MoFile mo(*std::move(bytes));
  if (mo.Number(0) != kMagic) return {};
  const std::size_t count = mo.Number(8), originals = mo.Number(12), translations = mo.Number(16);
  std::vector<CataloguePattern> patterns;
  for (std::size_t i = 0; i < std::min(count, mo.Size() / 8); ++i) {
    const std::string_view text = mo.Text(originals + 8 * i);
    if (text.find('{') == std::string_view::npos || text.find(kContextEnd) != std::string_view::npos)
      continue;
    CataloguePattern pattern = ParsePattern(text, mo.Text(translations + 8 * i));
    if (!pattern.places.empty() && pattern.letters >= kLeastLetters) patterns.push_back(std::move(pattern));
  }
  std::stable_sort(
      patterns.begin(), patterns.end(),
      [](const CataloguePattern& a, const CataloguePattern& b) { return a.letters > b.letters; });
  return patterns;
}

std::optional<PatternPlaces> MatchPattern(const CataloguePattern& pattern, std::string_view text) {
  if (!text.starts_with(pattern.fixed.front())) return {};
  text.remove_prefix(pattern.fixed.front().size());
  PatternPlaces places;
  for (std::size_t i = 0; i < pattern.places.size(); ++i) {
    const std::string& next = pattern.fixed[i + 1];
    const bool is_last = i + 1 == pattern.places.size();
    // the last fixed part stands at the end, the others as early as they can; two places never touch
    if (is_last && !text.ends_with(next)) return {};
    if (!is_last && next.empty()) return {};
    const std::size_t end = is_last ? text.size() - next.size() : text.find(next);
    if (end == std::string_view::npos) return {};
    places.emplace_back(pattern.places[i], text.substr(0, end));
    text.remove_prefix(end + next.size());
  }
  return places;
}

std::string FillPattern(std::string_view text, const PatternPlaces& places) {
  std::string filled;
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    const std::size_t close = open == std::string_view::npos ? open : text.find('}', open);
    filled += text.substr(0, open);
    if (close == std::string_view::npos) {
      if (open != std::string_view::npos) filled += text.substr(open);
      break;
    }
    const std::string_view name = text.substr(open + 1, close - open - 1);
    const auto found =
        std::find_if(places.begin(), places.end(), [&](const auto& place) { return place.first == name; });
    filled += found != places.end() ? std::string_view(found->second) : text.substr(open, close - open + 1);
    text.remove_prefix(close + 1);
  }
  return filled;
}

}  // namespace trocar::host
