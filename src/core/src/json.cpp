// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "trocar/core/safe_file.h"

namespace trocar::core {

struct JsonDocument::Content {
  nlohmann::json root;
  std::string source;
  std::optional<Error> complaint;
};

namespace {

/// Deeper files are refused before the recursive parser can exhaust the stack.
constexpr int kMaxDepth = 64;

const nlohmann::json* Node(const void* node) {
  return static_cast<const nlohmann::json*>(node);
}

bool IsTooDeep(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// Notices the first field that an object gives twice: the parser that builds the document keeps the last of them.
///
/// A pass of its own, because a callback of the building parser would make it search each list anew at each element.
class TwiceWatch : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool start_object(std::size_t) override {
    open_.emplace_back();
    return true;
  }
  bool end_object() override {
    open_.pop_back();
    return true;
  }
  bool key(string_t& name) override {
    open_.back().key = name;
    if (open_.back().seen.insert(name).second) return true;
    twice_.emplace();
    for (const Object& object : open_) *twice_ += (twice_->empty() ? "" : ".") + object.key;
    return false;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;  // the parser that builds the document says it better
  }

  /// "settings.tolerance"
  const std::optional<std::string>& Twice() const { return twice_; }

 private:
  struct Object {
    std::set<std::string> seen;
    std::string key;
  };
  std::vector<Object> open_;
  std::optional<std::string> twice_;
};

std::string NumberText(double value) {
  return nlohmann::json(value).dump();
}

}  // namespace

// --- views

void JsonView::Complain(std::string_view text, ErrorCode code) const {
  auto& content = *document_->content_;
  if (content.complaint) return;
  content.complaint =
      Error{code, content.source + ": at " + (path_.empty() ? "the top" : path_) + ": " + std::string(text)};
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
    Complain("must be a finite number", ErrorCode::kNumberNotFinite);
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
  return static_cast<int>(value);
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

Status JsonDocument::Check() const {
  if (content_->complaint) return *content_->complaint;
  return {};
}

Result<JsonDocument> JsonDocument::Parse(std::string_view text, std::string source) {
  if (IsTooDeep(text)) {
    return Error{ErrorCode::kJsonSyntax,
                 source + ": nested deeper than " + std::to_string(kMaxDepth) + " levels"};
  }
  auto content = std::make_unique<Content>();
  content->source = std::move(source);
  TwiceWatch watch;
  try {
    content->root = nlohmann::json::parse(text);
    (void)nlohmann::json::sax_parse(text, &watch);
  } catch (const nlohmann::json::exception& failure) {
    return Error{ErrorCode::kJsonSyntax, content->source + ": not valid JSON: " + failure.what()};
  }
  if (watch.Twice()) {
    return Error{ErrorCode::kJsonSyntax, content->source + ": the field " + *watch.Twice() +
                                             " is given twice in one object; keep one of them"};
  }
  return JsonDocument(std::move(content));
}

Result<JsonDocument> JsonDocument::Read(const std::filesystem::path& path) {
  auto text = ReadFile(path);
  if (!text.ok()) return text.error();
  return Parse(*text, path.string());
}

}  // namespace trocar::core
