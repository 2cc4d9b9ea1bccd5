// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/mesh_export.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/json_text.h"
#include "trocar/host/version.h"

namespace trocar::files {
namespace {

static_assert(std::endian::native == std::endian::little, "writing assumes a little-endian machine");

constexpr std::size_t kStlHeader = 80;
constexpr std::size_t kVtkTitle = 255;
// glTF 2.0, section 3: constants of OpenGL
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963,
              kTriangles = 4;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A,
                        kBinChunk = 0x004E4942;
constexpr double kTissueRoughness = 0.45;  // moist

/// Shortest text that reads back to the same double.
void AppendNumber(std::string& text, double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), value).ptr;
  text.append(buffer, end);
}

std::string OneLine(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return line;
}

template <typename T>
void AppendBytes(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
void AppendBigEndian(std::string& bytes, const T& value) {
  const auto* first = reinterpret_cast<const char*>(&value);
  bytes.append(std::make_reverse_iterator(first + sizeof(T)), std::make_reverse_iterator(first));
}

std::array<float, 3> ToFloats(const math::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Builds the buffer of a .glb with the views and accessors that describe it.
class GlbBuffer {
 public:
  /// \return number of the accessor
  std::size_t AddVectors(std::span<const math::Vec3> vectors, bool with_limits) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    std::array<float, 3> low = {kLargest, kLargest, kLargest}, high = {-kLargest, -kLargest, -kLargest};
    const std::size_t start = bytes_.size();
    for (const math::Vec3& vector : vectors) {
      const auto values = ToFloats(vector);
      for (int axis = 0; axis < 3; ++axis) {
        TROCAR_ASSERT(std::isfinite(values[axis]));
        low[axis] = std::min(low[axis], values[axis]);
        high[axis] = std::max(high[axis], values[axis]);
      }
      AppendBytes(bytes_, values);
    }
    nlohmann::ordered_json accessor = {{"bufferView", AddView(start, kArrayBuffer)},
                                       {"componentType", kFloat},
                                       {"count", vectors.size()},
                                       {"type", "VEC3"}};
    // limits of what is stored, not of what was given
    if (with_limits) accessor["min"] = low, accessor["max"] = high;
    accessors_.push_back(accessor);
    return accessors_.size() - 1;
  }

  std::size_t AddTriangles(std::span<const geometry::Triangle> triangles) {
    const std::size_t start = bytes_.size();
    for (const geometry::Triangle& t : triangles) AppendBytes(bytes_, t);
    accessors_.push_back({{"bufferView", AddView(start, kElementArrayBuffer)},
                          {"componentType", kUnsignedInt},
                          {"count", 3 * triangles.size()},
                          {"type", "SCALAR"}});
    return accessors_.size() - 1;
  }

  const std::string& Bytes() const { return bytes_; }
  const nlohmann::ordered_json& Views() const { return views_; }
  const nlohmann::ordered_json& Accessors() const { return accessors_; }

 private:
  std::size_t AddView(std::size_t start, int target) {
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes_.size() - start}, {"target", target}});
    return views_.size() - 1;
  }

  std::string bytes_;
  nlohmann::ordered_json views_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array();
};

void AppendChunk(std::string& file, std::uint32_t type, std::string content, char padding) {
  content.append((4 - content.size() % 4) % 4, padding);
  AppendBytes(file, static_cast<std::uint32_t>(content.size()));
  AppendBytes(file, type);
  file += content;
}

}  // namespace

std::string FormatObj(std::span<const NamedMesh> meshes, std::string_view comment) {
  std::string text = "# " + OneLine(comment) + "\n";
  std::size_t first = 1;  // vertices are counted from 1 through the whole file
  for (const NamedMesh& part : meshes) {
    text += "g " + part.name + "\n";
    for (const math::Vec3& p : part.mesh.positions) {
      text += "v";
      for (int axis = 0; axis < 3; ++axis) text += ' ', AppendNumber(text, p[axis]);
      text += '\n';
    }
    for (const geometry::Triangle& t : part.mesh.triangles) {
      text += "f";
      for (const auto vertex : t) text += ' ' + std::to_string(first + vertex);
      text += '\n';
    }
    first += part.mesh.positions.size();
  }
  return text;
}

std::string FormatStl(const geometry::TriangleMesh& mesh, std::string_view comment) {
  // a file that begins with "solid" would be taken for the text form
  std::string file = "binary STL " + OneLine(comment);
  file.resize(kStlHeader, ' ');
  AppendBytes(file, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const geometry::Triangle& t : mesh.triangles) {
    AppendBytes(file, ToFloats(math::Normalized(geometry::CalcAreaNormal(mesh.positions, t))));
    for (const auto vertex : t) AppendBytes(file, ToFloats(mesh.positions[vertex]));
    AppendBytes(file, std::uint16_t{0});
  }
  return file;
}

std::string FormatGlb(std::span<const NamedMesh> meshes, std::string_view copyright) {
  using Json = nlohmann::ordered_json;
  GlbBuffer buffer;
  Json nodes = Json::array(), glb_meshes = Json::array(), materials = Json::array(), roots = Json::array();
  for (const NamedMesh& part : meshes) {
    TROCAR_ASSERT(!part.mesh.triangles.empty());
    const auto known = std::find_if(materials.begin(), materials.end(),
                                    [&](const Json& material) { return material["name"] == part.material; });
    const auto material = static_cast<std::size_t>(known - materials.begin());
    if (known == materials.end()) {
      materials.push_back({{"name", part.material},
                           {"pbrMetallicRoughness",
                            {{"baseColorFactor", {part.colour[0], part.colour[1], part.colour[2], 1.0}},
                             {"metallicFactor", 0.0},
                             {"roughnessFactor", kTissueRoughness}}}});
    }
    std::vector<math::Vec3> normals(part.mesh.positions.size());
    geometry::CalcVertexNormals(part.mesh.positions, part.mesh.triangles, normals);
    const std::size_t positions = buffer.AddVectors(part.mesh.positions, true);
    const std::size_t directions = buffer.AddVectors(normals, false);
    const std::size_t indices = buffer.AddTriangles(part.mesh.triangles);
    roots.push_back(nodes.size());
    nodes.push_back({{"name", part.name}, {"mesh", glb_meshes.size()}});
    Json primitive = {{"attributes", {{"POSITION", positions}, {"NORMAL", directions}}},
                      {"indices", indices},
                      {"material", material},
                      {"mode", kTriangles}};
    glb_meshes.push_back({{"name", part.name}, {"primitives", Json::array({primitive})}});
  }
  Json asset = {{"version", "2.0"}, {"generator", "Trocar " + std::string(host::VersionText())}};
  if (!copyright.empty()) asset["copyright"] = std::string(copyright);
  Json json = {{"asset", asset}, {"scene", 0}, {"scenes", Json::array({Json{{"nodes", roots}}})}};
  json["nodes"] = nodes;
  json["meshes"] = glb_meshes;
  json["materials"] = materials;
  json["accessors"] = buffer.Accessors();
  json["bufferViews"] = buffer.Views();
  json["buffers"] = Json::array({Json{{"byteLength", buffer.Bytes().size()}}});

  std::string chunks;
  AppendChunk(chunks, kJsonChunk, host::FormatJson(json), ' ');
  AppendChunk(chunks, kBinChunk, buffer.Bytes(), '\0');
  std::string file;
  AppendBytes(file, kGlbMagic);
  AppendBytes(file, kGlbVersion);
  AppendBytes(file, static_cast<std::uint32_t>(3 * sizeof(std::uint32_t) + chunks.size()));
  return file + chunks;
}

std::string FormatVtk(const geometry::TriangleMesh& mesh, std::string_view title, VtkEncoding encoding) {
  const bool is_ascii = encoding == VtkEncoding::kAscii;
  std::string text = "# vtk DataFile Version 3.0\n" + OneLine(title).substr(0, kVtkTitle) + "\n" +
                     (is_ascii ? "ASCII" : "BINARY") + "\nDATASET POLYDATA\nPOINTS " +
                     std::to_string(mesh.positions.size()) + " double\n";
  for (const math::Vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_ascii) {
        AppendBigEndian(text, p[axis]);
        continue;
      }
      AppendNumber(text, p[axis]);
      text += axis < 2 ? ' ' : '\n';
    }
  }
  if (!is_ascii) text += '\n';
  const std::size_t count = mesh.triangles.size();
  text += "POLYGONS " + std::to_string(count) + " " + std::to_string(4 * count) + "\n";
  for (const geometry::Triangle& t : mesh.triangles) {
    if (is_ascii) {
      text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
      continue;
    }
    AppendBigEndian(text, std::int32_t{3});
    for (const auto vertex : t) AppendBigEndian(text, static_cast<std::int32_t>(vertex));
  }
  if (!is_ascii) text += '\n';
  return text;
}

}  // namespace trocar::files
