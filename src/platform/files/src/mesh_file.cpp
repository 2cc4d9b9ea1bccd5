// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/mesh_file.h"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>
#include <vector>

#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/safe_file.h"

namespace trocar::files {
namespace {

static_assert(std::endian::native == std::endian::little,
              "PLY reading and writing assumes a little-endian machine");

enum class Kind { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::optional<Kind> FindKind(std::string_view name) {
  struct Name {
    std::string_view text;
    Kind kind;
  };
  static constexpr Name kNames[] = {
      {"char", Kind::kInt8},     {"int8", Kind::kInt8},     {"uchar", Kind::kUint8},
      {"uint8", Kind::kUint8},   {"short", Kind::kInt16},   {"int16", Kind::kInt16},
      {"ushort", Kind::kUint16}, {"uint16", Kind::kUint16}, {"int", Kind::kInt32},
      {"int32", Kind::kInt32},   {"uint", Kind::kUint32},   {"uint32", Kind::kUint32},
      {"float", Kind::kFloat},   {"float32", Kind::kFloat}, {"double", Kind::kDouble},
      {"float64", Kind::kDouble}};
  for (const Name& entry : kNames) {
    if (entry.text == name) return entry.kind;
  }
  return std::nullopt;
}

struct Property {
  std::string name;
  Kind kind = Kind::kFloat;
  std::optional<Kind> list_count;  // set for a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// Reads numbers one after the other, from text or bytes; Ok() turns false at the first that is missing.
class NumberReader {
 public:
  NumberReader(std::string_view body, bool is_ascii) : rest_(body), is_ascii_(is_ascii) {}
  bool Ok() const { return ok_; }
  std::size_t Left() const { return rest_.size(); }

  double Next(Kind kind) { return is_ascii_ ? NextText() : NextBytes(kind); }

 private:
  double NextText() {
    const auto start = rest_.find_first_not_of(" \t\r\n");
    if (start == std::string_view::npos) return Fail();
    rest_.remove_prefix(start);
    const auto length = std::min(rest_.find_first_of(" \t\r\n"), rest_.size());
    const std::string token(rest_.substr(0, length));
    rest_.remove_prefix(length);
    char* end = nullptr;
    const double value = std::strtod(token.c_str(), &end);
    return end == token.c_str() + token.size() ? value : Fail();
  }

  double NextBytes(Kind kind) {
    switch (kind) {
      case Kind::kInt8:
        return Take<std::int8_t>();
      case Kind::kUint8:
        return Take<std::uint8_t>();
      case Kind::kInt16:
        return Take<std::int16_t>();
      case Kind::kUint16:
        return Take<std::uint16_t>();
      case Kind::kInt32:
        return Take<std::int32_t>();
      case Kind::kUint32:
        return Take<std::uint32_t>();
      case Kind::kFloat:
        return Take<float>();
      case Kind::kDouble:
        break;
    }
    return Take<double>();
  }

  template <typename T>
  double Take() {
    if (rest_.size() < sizeof(T)) return Fail();
    T value;
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    return static_cast<double>(value);
  }

  double Fail() {
    ok_ = false;
    return 0.0;
  }

  std::string_view rest_;
  bool is_ascii_;
  bool ok_ = true;
};

struct Header {
  bool is_ascii = false;
  std::vector<Element> elements;
  std::string_view body;
};

base::Result<Header> ParseHeader(std::string_view content, const auto& fail) {
  Header header;
  bool has_format = false, is_first = true;
  while (true) {
    const auto end = content.find('\n');
    if (end == std::string_view::npos) return fail("the header has no end_header line");
    std::istringstream line{std::string(content.substr(0, end))};
    content.remove_prefix(end + 1);
    std::string word;
    line >> word;
    if (is_first && word != "ply") return fail("it does not start with the line 'ply'");
    is_first = false;
    if (word == "end_header") break;
    if (word == "format") {
      std::string format;
      line >> format;
      if (format != "ascii" && format != "binary_little_endian")
        return fail("format '" + format + "' is not read; save it as ascii or binary_little_endian");
      header.is_ascii = format == "ascii";
      has_format = true;
    } else if (word == "element") {
      Element element;
      line >> element.name >> element.count;
      if (!line) return fail("an element line has no count");
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty()) return fail("a property stands before any element");
      Property property;
      std::string kind;
      line >> kind;
      if (kind == "list") {
        std::string count_kind;
        line >> count_kind >> kind;
        property.list_count = FindKind(count_kind);
        if (!property.list_count) return fail("property type '" + count_kind + "' is not known");
      }
      const auto found = FindKind(kind);
      if (!found) return fail("property type '" + kind + "' is not known");
      property.kind = *found;
      line >> property.name;
      header.elements.back().properties.push_back(property);
    }
  }
  if (!has_format) return fail("the header has no format line");
  header.body = content;
  return header;
}

}  // namespace

std::string FormatPly(const geometry::TriangleMesh& mesh, std::string_view comment) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) text += "comment " + std::string(comment) + "\n";
  text += "element vertex " + std::to_string(mesh.positions.size()) +
          "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
          std::to_string(mesh.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  const auto append = [&text](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const math::Vec3& p : mesh.positions) append(p.x), append(p.y), append(p.z);
  for (const geometry::Triangle& t : mesh.triangles) {
    append(std::uint8_t{3});
    for (const auto vertex : t) append(vertex);
  }
  return text;
}

base::Result<geometry::TriangleMesh> ParsePly(std::string_view content, std::string_view source) {
  const auto fail = [&](const std::string& why) {
    return base::Error{base::ErrorCode::kMeshInvalid,
                       std::string(source) + " is not a usable PLY mesh: " + why};
  };
  const auto header = ParseHeader(content, fail);
  if (!header.ok()) return header.error();

  geometry::TriangleMesh mesh;
  NumberReader reader(header->body, header->is_ascii);
  for (const Element& element : header->elements) {
    // each entry takes at least one byte a property: a count that lies is refused before it is believed
    if (!element.properties.empty() && element.count > reader.Left() / element.properties.size()) {
      return fail(std::to_string(element.count) + " entries of '" + element.name +
                  "' are announced, but the file is too short for them");
    }
    if (element.properties.empty()) continue;
    for (std::uint64_t entry = 0; entry < element.count; ++entry) {
      math::Vec3 position;
      std::vector<double> face;
      for (const Property& property : element.properties) {
        const bool is_face = element.name == "face" && property.list_count &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (!property.list_count) {
          const double value = reader.Next(property.kind);
          if (property.name == "x") position.x = value;
          if (property.name == "y") position.y = value;
          if (property.name == "z") position.z = value;
          continue;
        }
        const double length = reader.Next(*property.list_count);
        if (is_face && length != 3)
          return fail("face " + std::to_string(entry) + " is no triangle; triangulate the mesh");
        for (double item = 0; item < length && reader.Ok(); ++item) {
          const double value = reader.Next(property.kind);
          if (is_face) face.push_back(value);
        }
      }
      if (!reader.Ok())
        return fail("it ends in '" + element.name + "' " + std::to_string(entry) +
                    ", or holds something that is no number there");
      if (element.name == "vertex") mesh.positions.push_back(position);
      if (face.size() == 3) {
        geometry::Triangle triangle;
        for (int i = 0; i < 3; ++i) {
          if (!(face[i] >= 0 && face[i] < 4294967295.0))
            return fail("face " + std::to_string(entry) + " has a bad index");
          triangle[i] = base::TruncateTo<std::uint32_t>(face[i]);
        }
        mesh.triangles.push_back(triangle);
      }
    }
  }
  if (const auto status = geometry::CheckMesh(mesh); !status.ok()) return fail(status.error().message);
  if (mesh.triangles.empty()) return fail("it has no triangles");
  return mesh;
}

base::Result<geometry::TriangleMesh> ReadPly(const std::filesystem::path& path) {
  const auto content = host::ReadFile(path, 1u << 30);
  if (!content.ok()) return content.error();
  return ParsePly(*content, path.string());
}

base::Status WritePly(const std::filesystem::path& path, const geometry::TriangleMesh& mesh,
                      std::string_view comment) {
  return host::WriteFile(path, FormatPly(mesh, comment));
}

}  // namespace trocar::files
