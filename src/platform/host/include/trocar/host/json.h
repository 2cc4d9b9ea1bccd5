// SPDX-License-Identifier: Apache-2.0
/// \file json.h  Reading of JSON within limits: every complaint says in which file and at which field.
///
/// Nothing else in this program parses JSON (tests/json_doors): whoever wrote a text, its size, depth, numbers, names
/// and texts are looked at before anything is built of it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::host {

class JsonDocument;

/// Limits of a JSON text. A text beyond them is refused with kFileTooLarge. Mistakes that no limit governs (two fields of
/// one name, bytes that are no UTF-8, zero bytes, numbers that no double or 64-bit integer holds) give kJsonSyntax.
struct JsonLimits {
  std::size_t bytes = std::size_t{16} << 20;
  std::size_t depth = 64;          ///< lists and objects within each other
  std::size_t values = 1'000'000;  ///< of the whole text
  std::size_t fields = 100'000;    ///< of one object
  std::size_t text = 1u << 20;     ///< of one text or field name [bytes]
};

/// Of what is small by nature, and read many times or unasked: outcomes, settings, messages.
inline constexpr JsonLimits kSmallJson{1u << 20, 32, 50'000, 10'000, 1u << 18};
/// Of what measures a whole person or attempt: outlines on each slice, traces.
inline constexpr JsonLimits kLargeJson{std::size_t{64} << 20, 64, 8'000'000, 100'000, 1u << 20};

/// A text as a value of the JSON library, for whoever passes on or changes fields that it does not know.
///
/// \tparam Json   nlohmann::json or nlohmann::ordered_json, whose header the caller includes
/// \param source  name used in messages
/// \return kJsonSyntax with line and column, or with the field; kFileTooLarge
template <class Json>
base::Result<Json> ParseJson(std::string_view text, std::string_view source, const JsonLimits& limits = {});

/// Passes the events of a stream on, for what need not fit into memory; `limits.bytes` 0: any size.
///
/// \tparam Sax  nlohmann::json_sax<nlohmann::json>
/// \return as ParseJson; success, too, where `events` itself ended it by returning false
template <class Sax>
base::Status ParseJsonEvents(std::istream& stream, std::string_view source, Sax& events,
                             const JsonLimits& limits);

/// Closed interval that a number must lie in.
struct NumberRange {
  double min = -1e300;
  double max = 1e300;
};

/// One value inside a JsonDocument.
///
/// Readers return a harmless value when the field is missing or wrong and note the first complaint in the
/// document; read everything, then ask JsonDocument::Check() once. Valid as long as its document.
class JsonView {
 public:
  bool Has(std::string_view key) const;
  /// Complains about every key of this object that is not in the list, so that a misspelt setting is not
  /// lost.
  void AllowOnly(std::initializer_list<std::string_view> keys) const;

  JsonView Object(std::string_view key) const;
  /// Elements of an array field; empty with a complaint when it is missing or no array.
  std::vector<JsonView> Array(std::string_view key) const;
  /// Elements of this value, which must be an array.
  std::vector<JsonView> Elements() const;
  /// Names of this object's fields, in alphabetical order.
  std::vector<std::string> Keys() const;

  double Number(std::string_view key, NumberRange range = {}) const;
  double NumberOr(std::string_view key, double fallback, NumberRange range = {}) const;
  int Integer(std::string_view key, NumberRange range = {-2147483648.0, 2147483647.0}) const;
  int IntegerOr(std::string_view key, int fallback, NumberRange range = {-2147483648.0, 2147483647.0}) const;
  bool BooleanOr(std::string_view key, bool fallback) const;
  std::string Text(std::string_view key) const;
  std::string TextOr(std::string_view key, std::string_view fallback) const;
  /// A field that is an array of exactly `count` finite numbers, each in `range`.
  std::vector<double> Numbers(std::string_view key, std::size_t count, NumberRange range = {}) const;

  /// This value as a number, a text, or an array of exactly `count` numbers.
  double AsNumber(NumberRange range = {}) const;
  std::string AsText() const;
  std::vector<double> AsNumbers(std::size_t count, NumberRange range = {}) const;

  /// Notes a complaint about this value: "FILE: at slices[3].contours: TEXT".
  void Complain(std::string_view text, base::ErrorCode code = base::ErrorCode::kJsonField) const;
  /// "slices[3].contours"
  const std::string& Path() const { return path_; }

 private:
  friend class JsonDocument;
  JsonView(const JsonDocument* document, const void* node, std::string path)
      : document_(document), node_(node), path_(std::move(path)) {}
  JsonView Child(std::string_view key) const;

  const JsonDocument* document_;
  const void* node_;  // nlohmann::json, or null for a value that is not there
  std::string path_;
};

/// A parsed file and the first complaint about it.
class JsonDocument {
 public:
  /// \param source  name used in messages
  /// \return kJsonSyntax with line and column, or with the field that an object gives twice; kFileTooLarge
  static base::Result<JsonDocument> Parse(std::string_view text, std::string source,
                                          const JsonLimits& limits = {});
  /// \return ReadFile's error, too
  static base::Result<JsonDocument> Read(const std::filesystem::path& path, const JsonLimits& limits = {});

  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  ~JsonDocument();

  JsonView Root() const;
  /// The first complaint of any view, or success.
  base::Status Check() const;

 private:
  friend class JsonView;
  struct Content;
  explicit JsonDocument(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::host
