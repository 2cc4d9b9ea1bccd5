// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <istream>
#include <limits>
#include <nlohmann/json.hpp>
#include <streambuf>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/host/json_text.h"
#include "trocar/host/printable.h"
#include "trocar/host/safe_file.h"

namespace trocar::host {

struct JsonDocument::Content {
  nlohmann::json root;
  std::string source;
  std::optional<base::Error> complaint;
};

namespace {

const nlohmann::json* Node(const void* node) {
  return static_cast<const nlohmann::json*>(node);
}

/// Longer ones say no more than a double holds.
constexpr std::size_t kMostDigits = 128;
/// Fields of an object that are searched one by one for a second of the same name.
constexpr std::size_t kFewFields = 16;

/// What a stranger wrote, for a message.
std::string Excerpt(std::string_view text) {
  constexpr std::size_t kEnd = 400;  // what is longer loses its middle in any case
  if (text.size() <= 2 * kEnd) return Printable(text);
  return Printable(std::string(text.substr(0, kEnd)).append(text.substr(text.size() - kEnd)));
}

/// Passes on the events of the library's parser, which builds and recurses nothing by itself, while they keep the limits.
template <class Sink>
class Watch {
 public:
  Watch(Sink& sink, std::string_view source, const JsonLimits& limits)
      : sink_(sink), source_(source), limits_(limits) {}

  const std::optional<base::Error>& Failure() const { return failure_; }
  bool Refuse(base::ErrorCode code, std::string message) {
    if (!failure_) failure_ = base::Error{code, std::move(message)};
    return false;
  }
  /// Whether a value has ended or begun since this was asked before.
  bool HasMoved() { return std::exchange(has_moved_, false); }

  // NOLINTBEGIN(readability-identifier-naming): the library calls its events so
  bool null() { return Count() && sink_.null(); }
  bool boolean(bool value) { return Count() && sink_.boolean(value); }
  bool number_integer(std::int64_t value) { return Count() && sink_.number_integer(value); }
  bool number_unsigned(std::uint64_t value) { return Count() && sink_.number_unsigned(value); }
  bool number_float(double value, const std::string& digits) {
    if (!Count()) return false;
    if (digits.size() > kMostDigits)
      return Refuse(base::ErrorCode::kFileTooLarge, Source() + ": at " + Path() + ": a number of more than " +
                                                        std::to_string(kMostDigits) + " digits");
    if (digits.find_first_of(".eE") == std::string::npos)
      return Refuse(base::ErrorCode::kJsonSyntax,
                    Source() + ": at " + Path() + ": the whole number " + digits +
                        " does not fit into 64 bits; write it with a decimal point");
    return sink_.number_float(value, digits);
  }
  bool string(std::string& text) { return Count() && CheckText(text) && sink_.string(text); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // text has none
  bool start_array(std::size_t) { return Open(false) && sink_.start_array(std::size_t(-1)); }
  bool start_object(std::size_t) { return Open(true) && sink_.start_object(std::size_t(-1)); }
  bool end_array() { return Close() && sink_.end_array(); }
  bool end_object() { return Close() && sink_.end_object(); }
  bool key(std::string& name) {
    has_moved_ = true;
    Level& object = levels_[depth_ - 1];
    if (object.count == limits_.fields)
      return Refuse(base::ErrorCode::kFileTooLarge, Source() + ": at " + Path() +
                                                        ": an object of more than " +
                                                        std::to_string(limits_.fields) + " fields");
    if (!CheckText(name)) return false;
    if (!Note(object, name)) {
      return Refuse(base::ErrorCode::kJsonSyntax,
                    Source() + ": the field " + Path() + " is given twice in one object; keep one of them");
    }
    return sink_.key(name);
  }
  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& why) {
    constexpr int kNumberOverflow = 406;
    if (why.id == kNumberOverflow) {
      (void)Count();
      return Refuse(base::ErrorCode::kJsonSyntax,
                    Source() + ": at " + Path() + ": the number " + Excerpt(token) + " is beyond 1.8e308");
    }
    // "[json.exception.parse_error.101] parse error at line 3, column 7: syntax error while parsing value - ..."
    std::string_view what = why.what();
    constexpr std::string_view kBefore = "] parse error at ";
    const std::size_t at = what.find(kBefore);
    if (at != std::string_view::npos) what.remove_prefix(at + kBefore.size());
    return Refuse(base::ErrorCode::kJsonSyntax, Source() + ": not valid JSON: " + Excerpt(what));
  }
  // NOLINTEND(readability-identifier-naming)

  /// "slices[3].contours"
  std::string Path() const {
    std::string path;
    for (std::size_t i = 0; i < depth_ && path.size() < kLongPath; ++i) {
      const Level& level = levels_[i];
      if (!level.is_object) {
        path += '[' + std::to_string(level.count == 0 ? 0 : level.count - 1) + ']';
      } else if (level.count > 0) {
        path += (path.empty() ? "" : ".") + level.name;
      }
    }
    return path.empty() ? "the top" : Excerpt(path);
  }

 private:
  static constexpr std::size_t kLongPath = 1000;

  /// A list or an object that is not closed yet; kept for the next one of its depth.
  struct Level {
    bool is_object = false;
    std::size_t count = 0;                 // of its values or fields so far
    std::string name;                      // of the last field
    std::vector<std::string> few;          // the first fields
    std::unordered_set<std::string> many;  // the others
  };

  std::string Source() const { return std::string(source_); }
  bool Count() {
    has_moved_ = true;
    if (depth_ > 0 && !levels_[depth_ - 1].is_object) ++levels_[depth_ - 1].count;
    if (++values_ <= limits_.values) return true;
    return Refuse(base::ErrorCode::kFileTooLarge,
                  Source() + ": at " + Path() + ": more than " + std::to_string(limits_.values) + " values");
  }
  bool CheckText(const std::string& text) {
    if (text.size() > limits_.text)
      return Refuse(base::ErrorCode::kFileTooLarge, Source() + ": at " + Path() + ": a text of more than " +
                                                        std::to_string(limits_.text) + " bytes");
    if (text.find('\0') == std::string::npos) return true;
    return Refuse(base::ErrorCode::kJsonSyntax,
                  Source() + ": at " + Path() + ": a text holds the character U+0000; leave it out");
  }
  bool Open(bool is_object) {
    if (!Count()) return false;
    if (depth_ == limits_.depth)
      return Refuse(base::ErrorCode::kFileTooLarge, Source() + ": at " + Path() + ": nested deeper than " +
                                                        std::to_string(limits_.depth) + " levels");
    if (levels_.size() == depth_) levels_.emplace_back();
    Level& level = levels_[depth_++];
    level.is_object = is_object;
    level.count = 0;
    level.many.clear();
    return true;
  }
  bool Close() {
    has_moved_ = true;
    --depth_;
    return true;
  }
  /// \return false where the object has this field already
  static bool Note(Level& object, const std::string& name) {
    object.name = name;
    const auto few_end = object.few.begin() + static_cast<std::ptrdiff_t>(std::min(object.count, kFewFields));
    bool is_new = std::find(object.few.begin(), few_end, name) == few_end;
    if (object.count >= kFewFields) {
      is_new = is_new && object.many.insert(name).second;
    } else if (is_new) {
      if (object.few.size() == object.count) object.few.emplace_back();
      object.few[object.count] = name;
    }
    ++object.count;
    return is_new;
  }

  Sink& sink_;
  std::string_view source_;
  const JsonLimits& limits_;
  std::vector<Level> levels_;
  std::size_t depth_ = 0;
  std::size_t values_ = 0;
  bool has_moved_ = false;
  std::optional<base::Error> failure_;
};

/// Builds the library's value. \pre what comes has passed a Watch: no name twice, of bounded depth
template <class Json>
class Builder {
 public:
  explicit Builder(Json& root) : next_(&root) {}

  // NOLINTBEGIN(readability-identifier-naming): the library calls its events so
  bool null() { return Put(nullptr) != nullptr; }
  bool boolean(bool value) { return Put(value) != nullptr; }
  bool number_integer(std::int64_t value) { return Put(value) != nullptr; }
  bool number_unsigned(std::uint64_t value) { return Put(value) != nullptr; }
  bool number_float(double value, const std::string&) { return Put(value) != nullptr; }
  bool string(std::string& text) { return Put(std::move(text)) != nullptr; }
  bool start_array(std::size_t) { return Open(Json::value_t::array); }
  bool start_object(std::size_t) { return Open(Json::value_t::object); }
  bool end_array() { return Close(); }
  bool end_object() { return Close(); }
  bool key(std::string& name) {
    auto& fields = *open_.back()->template get_ptr<typename Json::object_t*>();
    if constexpr (std::is_same_v<Json, nlohmann::ordered_json>) {
      // its own way of adding a field searches all those before
      using Fields = typename Json::object_t::Container;
      next_ = &static_cast<Fields&>(fields).emplace_back(std::move(name), nullptr).second;
    } else {
      next_ = &fields.emplace(std::move(name), nullptr).first->second;
    }
    return true;
  }
  // NOLINTEND(readability-identifier-naming)

 private:
  template <class Value>
  Json* Put(Value&& value) {
    if (!open_.empty() && open_.back()->is_array()) {
      auto& elements = *open_.back()->template get_ptr<typename Json::array_t*>();
      return &elements.emplace_back(std::forward<Value>(value));
    }
    *next_ = Json(std::forward<Value>(value));
    return next_;
  }
  bool Open(typename Json::value_t kind) {
    open_.push_back(Put(kind));
    return true;
  }
  bool Close() {
    open_.pop_back();
    return true;
  }

  Json* next_;  // the root, or the value of the field whose name came last
  std::vector<Json*> open_;
};

base::Error ZeroByte(const std::string& source) {
  return base::Error{base::ErrorCode::kJsonSyntax, source + ": not valid JSON: it holds a zero byte"};
}

base::Error TooLong(const std::string& source, std::size_t most_bytes) {
  return base::Error{base::ErrorCode::kFileTooLarge, source + ": longer than " + std::to_string(most_bytes) +
                                                         " bytes, which is the most that is read here"};
}

/// The bytes of a stream for the library's parser, which would gather a token of any length and end at a zero byte.
struct StreamBytes {
  std::streambuf& buffer;
  std::size_t most_bytes, most_token;
  std::function<bool()> has_moved;  // to another token
  std::size_t bytes = 0, token = 0;
  bool has_zero = false, is_long = false;

  std::optional<char> Peek() {
    constexpr std::size_t kAtLeast = 4096;  // white space, and numbers
    const int next = buffer.sgetc();
    if (next == std::char_traits<char>::eof()) return {};
    has_zero = has_zero || next == 0;
    if (token > most_token + kAtLeast && has_moved()) token = 0;
    is_long = is_long || bytes > most_bytes || token > most_token + kAtLeast;
    if (has_zero || is_long) return {};
    return static_cast<char>(next);
  }
  void Skip() {
    buffer.sbumpc();
    ++bytes, ++token;
  }
};

class StreamIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  explicit StreamIterator(StreamBytes* bytes = nullptr) : bytes_(bytes) {}
  char operator*() const { return *bytes_->Peek(); }
  StreamIterator& operator++() { return bytes_->Skip(), *this; }
  bool operator==(const StreamIterator& other) const { return IsAtEnd() == other.IsAtEnd(); }
  bool operator!=(const StreamIterator& other) const { return !(*this == other); }

 private:
  bool IsAtEnd() const { return bytes_ == nullptr || !bytes_->Peek(); }
  StreamBytes* bytes_;
};

std::string NumberText(double value) {
  return FormatJson(nlohmann::json(value));
}

}  // namespace

std::string QuoteJson(std::string_view text) {
  return FormatJson(nlohmann::json(std::string(text)));
}

// --- views

void JsonView::Complain(std::string_view text, base::ErrorCode code) const {
  auto& content = *document_->content_;
  if (content.complaint) return;
  content.complaint =
      base::Error{code, content.source + ": at " + (path_.empty() ? "the top" : Excerpt(path_)) + ": " +
                            std::string(text)};
}

JsonView JsonView::Child(std::string_view key) const {
  std::string path = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  const void* node = nullptr;
  if (node_ != nullptr && Node(node_)->is_object()) {
    const auto found = Node(node_)->find(key);
    if (found != Node(node_)->end()) node = &*found;
  }
  return {document_, node, std::move(path)};
}

bool JsonView::Has(std::string_view key) const {
  return Child(key).node_ != nullptr;
}

void JsonView::AllowOnly(std::initializer_list<std::string_view> keys) const {
  if (node_ == nullptr || !Node(node_)->is_object()) return;
  for (const auto& item : Node(node_)->items()) {
    if (std::find(keys.begin(), keys.end(), item.key()) != keys.end()) continue;
    std::string known;
    for (const auto key : keys) known += (known.empty() ? "" : ", ") + std::string(key);
    Child(item.key()).Complain("this field is not known; known are " + known);
  }
}

JsonView JsonView::Object(std::string_view key) const {
  JsonView child = Child(key);
  if (child.node_ == nullptr || !Node(child.node_)->is_object()) {
    child.Complain(child.node_ == nullptr ? "is missing; an object { } is needed" : "must be an object { }");
    child.node_ = nullptr;
  }
  return child;
}

std::vector<JsonView> JsonView::Elements() const {
  std::vector<JsonView> elements;
  if (node_ == nullptr || !Node(node_)->is_array()) {
    Complain(node_ == nullptr ? "is missing; a list [ ] is needed" : "must be a list [ ]");
    return elements;
  }
  elements.reserve(Node(node_)->size());
  std::size_t index = 0;
  for (const auto& element : *Node(node_)) {
    elements.push_back(JsonView(document_, &element, path_ + "[" + std::to_string(index++) + "]"));
  }
  return elements;
}

std::vector<JsonView> JsonView::Array(std::string_view key) const {
  return Child(key).Elements();
}

std::vector<std::string> JsonView::Keys() const {
  std::vector<std::string> keys;
  if (node_ == nullptr || !Node(node_)->is_object()) return keys;
  for (const auto& item : Node(node_)->items()) keys.push_back(item.key());
  return keys;
}

double JsonView::AsNumber(NumberRange range) const {
  if (node_ == nullptr || !Node(node_)->is_number()) {
    Complain(node_ == nullptr ? "is missing; a number is needed" : "must be a number");
    return range.min > 0.0 ? range.min : 0.0;
  }
  const double value = Node(node_)->get<double>();
  if (!std::isfinite(value)) {
    Complain("must be a finite number", base::ErrorCode::kNumberNotFinite);
    return range.min > 0.0 ? range.min : 0.0;
  }
  if (value < range.min || value > range.max) {
    Complain("is " + NumberText(value) + ", but must lie between " + NumberText(range.min) + " and " +
             NumberText(range.max));
    return std::clamp(value, range.min, range.max);
  }
  return value;
}

double JsonView::Number(std::string_view key, NumberRange range) const {
  return Child(key).AsNumber(range);
}

double JsonView::NumberOr(std::string_view key, double fallback, NumberRange range) const {
  return Has(key) ? Number(key, range) : fallback;
}

int JsonView::Integer(std::string_view key, NumberRange range) const {
  const JsonView child = Child(key);
  const double value = child.AsNumber(range);
  if (value != std::floor(value)) child.Complain("must be a whole number");
  return base::TruncateTo<int>(value);
}

int JsonView::IntegerOr(std::string_view key, int fallback, NumberRange range) const {
  return Has(key) ? Integer(key, range) : fallback;
}

bool JsonView::BooleanOr(std::string_view key, bool fallback) const {
  const JsonView child = Child(key);
  if (child.node_ == nullptr) return fallback;
  if (!Node(child.node_)->is_boolean()) {
    child.Complain("must be true or false");
    return fallback;
  }
  return Node(child.node_)->get<bool>();
}

std::string JsonView::AsText() const {
  if (node_ == nullptr || !Node(node_)->is_string()) {
    Complain(node_ == nullptr ? "is missing; a text is needed" : "must be a text in quotes");
    return {};
  }
  return Node(node_)->get<std::string>();
}

std::string JsonView::Text(std::string_view key) const {
  return Child(key).AsText();
}

std::string JsonView::TextOr(std::string_view key, std::string_view fallback) const {
  return Has(key) ? Text(key) : std::string(fallback);
}

std::vector<double> JsonView::AsNumbers(std::size_t count, NumberRange range) const {
  std::vector<double> numbers;
  for (const JsonView& element : Elements()) numbers.push_back(element.AsNumber(range));
  if (numbers.size() != count) {
    Complain("must be a list of " + std::to_string(count) + " numbers");
    numbers.resize(count, 0.0);
  }
  return numbers;
}

std::vector<double> JsonView::Numbers(std::string_view key, std::size_t count, NumberRange range) const {
  return Child(key).AsNumbers(count, range);
}

// --- documents

JsonDocument::JsonDocument(std::unique_ptr<Content> content) : content_(std::move(content)) {}
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

JsonView JsonDocument::Root() const {
  return {this, &content_->root, ""};
}

base::Status JsonDocument::Check() const {
  if (content_->complaint) return *content_->complaint;
  return {};
}

base::Result<JsonDocument> JsonDocument::Parse(std::string_view text, std::string source,
                                               const JsonLimits& limits) {
  auto root = ParseJson<nlohmann::json>(text, source, limits);
  if (!root.ok()) return root.error();
  auto content = std::make_unique<Content>();
  content->root = std::move(*root);
  content->source = std::move(source);
  return JsonDocument(std::move(content));
}

base::Result<JsonDocument> JsonDocument::Read(const std::filesystem::path& path, const JsonLimits& limits) {
  auto text = ReadFile(path, limits.bytes);
  if (!text.ok()) return text.error();
  return Parse(*text, path.string(), limits);
}

// --- the reader

template <class Json>
base::Result<Json> ParseJson(std::string_view text, std::string_view source, const JsonLimits& limits) {
  if (text.size() > limits.bytes) return TooLong(std::string(source), limits.bytes);
  // the library would take it for the end
  if (text.find('\0') != std::string_view::npos) return ZeroByte(std::string(source));
  Json root;
  Builder<Json> builder(root);
  Watch<Builder<Json>> watch(builder, source, limits);
  (void)Json::sax_parse(text.begin(), text.end(), &watch);
  if (watch.Failure()) return *watch.Failure();
  return root;
}

template base::Result<nlohmann::json> ParseJson(std::string_view, std::string_view, const JsonLimits&);
template base::Result<nlohmann::ordered_json> ParseJson(std::string_view, std::string_view,
                                                        const JsonLimits&);

template <class Sax>
base::Status ParseJsonEvents(std::istream& stream, std::string_view source, Sax& events,
                             const JsonLimits& limits) {
  Watch<Sax> watch(events, source, limits);
  constexpr std::size_t kEscape = 6;  // \uNNNN for one byte
  StreamBytes bytes{*stream.rdbuf(),
                    limits.bytes == 0 ? std::numeric_limits<std::size_t>::max() : limits.bytes,
                    kEscape * limits.text, [&] { return watch.HasMoved(); }};
  (void)nlohmann::json::sax_parse(StreamIterator(&bytes), StreamIterator(), &watch);
  if (bytes.has_zero) return ZeroByte(std::string(source));
  if (bytes.is_long) return TooLong(std::string(source), std::min(bytes.most_bytes, bytes.most_token));
  if (watch.Failure()) return *watch.Failure();
  return {};
}

template base::Status ParseJsonEvents(std::istream&, std::string_view, nlohmann::json_sax<nlohmann::json>&,
                                      const JsonLimits&);

}  // namespace trocar::host
