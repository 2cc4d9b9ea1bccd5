// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/mesh_export.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/geometry/tube.h"

namespace trocar::files {
namespace {

// Readers of their own, from the formats' specifications: nothing here is shared with the writers.

std::vector<NamedMesh> MakeParts() {
  return {{"liver", geometry::MakeSphere({1.0 / 3, -2.0, 1e-7}, 0.7, 2), "liver", {0.4, 0.1, 0.1}},
          {"duct",
           geometry::MakeTube({{{0, 0, 0}, {0.1, 0.02, 0}, {0.2, 0, 0}}, {0.01, 0.02, 0.01}}, 7),
           "duct",
           {0.5, 0.6, 0.2}},
          {"other_duct", geometry::MakeBox({-1, -1, -1}, {1, 2, 3}), "duct", {0.5, 0.6, 0.2}}};
}

template <typename T>
T Take(const std::string& bytes, std::size_t at) {
  T value;
  EXPECT_LE(at + sizeof(T), bytes.size());
  if (at + sizeof(T) > bytes.size()) return {};
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

using Floats = std::array<float, 3>;

Floats TakeFloats(const std::string& bytes, std::size_t at) {
  return {Take<float>(bytes, at), Take<float>(bytes, at + 4), Take<float>(bytes, at + 8)};
}

Floats AsFloats(const math::Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

math::Vec3 AsVector(const Floats& f) {
  return {f[0], f[1], f[2]};
}

TEST(FormatObj, ReadsBackExactlyGroupByGroup) {
  const auto parts = MakeParts();
  std::istringstream file(FormatObj(parts, "credit\nv 9 9 9"));
  std::vector<math::Vec3> vertices;
  std::map<std::string, geometry::TriangleMesh> groups;
  std::map<std::string, std::size_t> first;
  std::string line, group;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "g") {
      words >> group;
      first[group] = vertices.size();
    } else if (key == "v") {
      std::string x, y, z;
      words >> x >> y >> z;
      vertices.push_back({std::strtod(x.c_str(), nullptr), std::strtod(y.c_str(), nullptr),
                          std::strtod(z.c_str(), nullptr)});
      groups[group].positions.push_back(vertices.back());
    } else if (key == "f") {
      std::size_t a = 0, b = 0, c = 0;
      words >> a >> b >> c;
      const std::size_t base = first[group] + 1;
      groups[group].triangles.push_back({static_cast<std::uint32_t>(a - base),
                                         static_cast<std::uint32_t>(b - base),
                                         static_cast<std::uint32_t>(c - base)});
    } else {
      EXPECT_EQ(key, "#");
    }
  }
  ASSERT_EQ(groups.size(), parts.size());
  for (const NamedMesh& part : parts) EXPECT_EQ(groups[part.name], part.mesh) << part.name;
}

TEST(FormatStl, HoldsEveryTriangleWithItsNormal) {
  const geometry::TriangleMesh mesh = MakeParts()[0].mesh;
  const std::string file = FormatStl(mesh, std::string(200, 'x'));
  ASSERT_EQ(file.size(), 84 + 50 * mesh.triangles.size());
  EXPECT_NE(file.substr(0, 5), "solid");
  ASSERT_EQ(Take<std::uint32_t>(file, 80), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::size_t at = 84 + 50 * i;
    math::Vec3 p[3];
    for (int corner = 0; corner < 3; ++corner) {
      const Floats stored = TakeFloats(file, at + 12 + 12 * corner);
      p[corner] = AsVector(stored);
      EXPECT_EQ(stored, AsFloats(mesh.positions[mesh.triangles[i][corner]]));
    }
    const math::Vec3 expected = math::Normalized(Cross(p[1] - p[0], p[2] - p[0]));
    EXPECT_LT(Distance(AsVector(TakeFloats(file, at)), expected), 1e-5);
    EXPECT_EQ(Take<std::uint16_t>(file, at + 48), 0);
  }
}

TEST(FormatVtk, AsciiReadsBackExactly) {
  for (const NamedMesh& part : MakeParts()) {
    std::istringstream file(FormatVtk(part.mesh, "a\ntitle" + std::string(400, 'x'), VtkEncoding::kAscii));
    std::string line, word;
    std::getline(file, line);
    EXPECT_EQ(line, "# vtk DataFile Version 3.0");
    std::getline(file, line);
    EXPECT_LT(line.size(), 256u);
    std::size_t points = 0, polygons = 0, size = 0;
    file >> word;
    EXPECT_EQ(word, "ASCII");
    file >> word >> word >> word >> points >> word;
    EXPECT_EQ(word, "double");
    geometry::TriangleMesh mesh;
    for (std::size_t i = 0; i < points; ++i) {
      std::string x, y, z;
      file >> x >> y >> z;
      mesh.positions.push_back({std::stod(x), std::stod(y), std::stod(z)});
    }
    file >> word >> polygons >> size;
    EXPECT_EQ(word, "POLYGONS");
    EXPECT_EQ(size, 4 * polygons);
    for (std::size_t i = 0; i < polygons; ++i) {
      int corners = 0;
      geometry::Triangle t;
      file >> corners >> t[0] >> t[1] >> t[2];
      EXPECT_EQ(corners, 3);
      mesh.triangles.push_back(t);
    }
    ASSERT_TRUE(file);
    EXPECT_FALSE(file >> word);
    EXPECT_EQ(mesh, part.mesh);
  }
}

TEST(FormatVtk, BinaryIsBigEndianAndReadsBackExactly) {
  const geometry::TriangleMesh mesh = MakeParts()[0].mesh;
  const std::string file = FormatVtk(mesh, "title", VtkEncoding::kBinary);
  const auto number = [&](std::size_t at, int bytes) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(file.at(at + i));
    return value;
  };
  const std::string head = "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS " +
                           std::to_string(mesh.positions.size()) + " double\n";
  ASSERT_EQ(file.substr(0, head.size()), head);
  std::size_t at = head.size();
  for (const math::Vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis, at += 8) {
      const std::uint64_t bits = number(at, 8);
      double value;
      std::memcpy(&value, &bits, 8);
      EXPECT_EQ(value, p[axis]);
    }
  }
  const std::string middle = "\nPOLYGONS " + std::to_string(mesh.triangles.size()) + " " +
                             std::to_string(4 * mesh.triangles.size()) + "\n";
  ASSERT_EQ(file.substr(at, middle.size()), middle);
  at += middle.size();
  for (const geometry::Triangle& t : mesh.triangles) {
    EXPECT_EQ(number(at, 4), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(number(at + 4 + 4 * i, 4), t[i]);
    at += 16;
  }
  EXPECT_EQ(file.substr(at), "\n");
}

TEST(FormatGlb, HoldsNodesMaterialsLimitsAndPositions) {
  const auto parts = MakeParts();
  const std::string file = FormatGlb(parts, "credit \xff");
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(Take<std::uint32_t>(file, 4), 2u);
  ASSERT_EQ(Take<std::uint32_t>(file, 8), file.size());
  const auto json_size = Take<std::uint32_t>(file, 12);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0u);
  const auto json = nlohmann::json::parse(file.substr(20, json_size));
  const std::size_t bin = 20 + json_size;
  EXPECT_EQ(file.substr(bin + 4, 4), std::string("BIN\0", 4));
  const std::size_t data = bin + 8;
  ASSERT_EQ(data + Take<std::uint32_t>(file, bin), file.size());
  EXPECT_LE(json["buffers"][0]["byteLength"].get<std::size_t>(), file.size() - data);
  EXPECT_EQ(json["asset"]["version"], "2.0");
  EXPECT_EQ(json["scenes"][0]["nodes"], (std::vector<int>{0, 1, 2}));
  ASSERT_EQ(json["materials"].size(), 2u);  // the two ducts share one
  ASSERT_EQ(json["nodes"].size(), parts.size());

  const auto start_of = [&](std::size_t accessor) {
    const auto& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<std::size_t>()];
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    return data + view["byteOffset"].get<std::size_t>();
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(json["nodes"][i]["name"], parts[i].name);
    const auto& mesh = json["meshes"][json["nodes"][i]["mesh"].get<std::size_t>()];
    EXPECT_EQ(mesh["name"], parts[i].name);
    const auto& primitive = mesh["primitives"][0];
    const auto& material = json["materials"][primitive["material"].get<std::size_t>()];
    EXPECT_EQ(material["name"], parts[i].material);
    EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"][0], parts[i].colour[0]);
    const std::size_t positions = primitive["attributes"]["POSITION"],
                      normals = primitive["attributes"]["NORMAL"], indices = primitive["indices"];
    ASSERT_EQ(json["accessors"][positions]["count"], parts[i].mesh.positions.size());
    ASSERT_EQ(json["accessors"][indices]["count"], 3 * parts[i].mesh.triangles.size());
    Floats low = AsFloats(parts[i].mesh.positions[0]), high = low;
    for (std::size_t v = 0; v < parts[i].mesh.positions.size(); ++v) {
      const Floats p = TakeFloats(file, start_of(positions) + 12 * v);
      EXPECT_EQ(p, AsFloats(parts[i].mesh.positions[v]));
      EXPECT_NEAR(math::Norm(AsVector(TakeFloats(file, start_of(normals) + 12 * v))), 1.0, 1e-6);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(json["accessors"][positions]["min"][axis].get<float>(), low[axis]);
      EXPECT_EQ(json["accessors"][positions]["max"][axis].get<float>(), high[axis]);
    }
    for (std::size_t t = 0; t < parts[i].mesh.triangles.size(); ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        EXPECT_EQ(Take<std::uint32_t>(file, start_of(indices) + 12 * t + 4 * corner),
                  parts[i].mesh.triangles[t][corner]);
      }
    }
  }
}

}  // namespace
}  // namespace trocar::files
