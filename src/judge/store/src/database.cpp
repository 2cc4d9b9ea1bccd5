// SPDX-License-Identifier: Apache-2.0
#include "database.h"

#include <array>

namespace trocar::store {
namespace {

constexpr char kMark = '\x01';  // begins what is escaped

/// Length of the UTF-8 character at the start of `text`, or 0 (RFC 3629: no overlong forms, no surrogates).
std::size_t CalcCharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto follows = [&](std::size_t i) { return i < text.size() && (byte(i) & 0xC0u) == 0x80u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    if (!follows(1) || !follows(2)) return 0;
    if (first == 0xE0 && byte(1) < 0xA0) return 0;
    if (first == 0xED && byte(1) > 0x9F) return 0;
    return 3;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    if (!follows(1) || !follows(2) || !follows(3)) return 0;
    if (first == 0xF0 && byte(1) < 0x90) return 0;
    if (first == 0xF4 && byte(1) > 0x8F) return 0;
    return 4;
  }
  return 0;
}

bool IsPlain(std::string_view text) {
  if (!text.empty() && text.front() == kMark) return false;
  while (!text.empty()) {
    const std::size_t length = text.front() == '\0' ? 0 : CalcCharacterLength(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

constexpr std::string_view kDigits = "0123456789abcdef";

}  // namespace

std::string EncodeText(std::string_view text) {
  if (IsPlain(text)) return std::string(text);
  std::string encoded(1, kMark);
  while (!text.empty()) {
    const std::size_t length = text.front() == '\0' || text.front() == '\\' ? 0 : CalcCharacterLength(text);
    if (length > 0) {
      encoded += text.substr(0, length);
      text.remove_prefix(length);
    } else {
      const auto byte = static_cast<unsigned char>(text.front());
      encoded += {'\\', kDigits[byte >> 4], kDigits[byte & 15]};
      text.remove_prefix(1);
    }
  }
  return encoded;
}

std::string DecodeText(std::string_view text) {
  if (text.empty() || text.front() != kMark) return std::string(text);
  std::string decoded;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 2 >= text.size()) {
      decoded += text[i];
      continue;
    }
    const std::size_t high = kDigits.find(text[i + 1]), low = kDigits.find(text[i + 2]);
    decoded += static_cast<char>((high & 15) << 4 | (low & 15));
    i += 2;
  }
  return decoded;
}

std::int64_t Row::Int(std::size_t column) const {
  const auto* value = std::get_if<std::int64_t>(&values[column]);
  TROCAR_ASSERT(value != nullptr);
  return *value;
}

double Row::Real(std::size_t column) const {
  if (const auto* whole = std::get_if<std::int64_t>(&values[column])) return static_cast<double>(*whole);
  const auto* value = std::get_if<double>(&values[column]);
  TROCAR_ASSERT(value != nullptr);
  return *value;
}

const std::string& Row::Text(std::size_t column) const {
  const auto* value = std::get_if<std::string>(&values[column]);
  TROCAR_ASSERT(value != nullptr);
  return *value;
}

std::optional<double> Row::RealOrNull(std::size_t column) const {
  if (IsNull(column)) return std::nullopt;
  return Real(column);
}

std::optional<std::int64_t> Row::IntOrNull(std::size_t column) const {
  if (IsNull(column)) return std::nullopt;
  return Int(column);
}

}  // namespace trocar::store
