// SPDX-License-Identifier: Apache-2.0
#include "trainer_box.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/render/ambient_occlusion.h"

namespace trocar::view {
namespace {

using geometry::TriangleMesh;
using math::Vec3;

constexpr double kRoom = 0.060;          // between the objects and the walls [m]
constexpr double kSideRoom = 0.050;      // more of it on either side: instruments come from there [m]
constexpr double kHeight = 0.180;        // of the walls [m]
constexpr double kUnderObjects = 0.006;  // of the floor [m]
constexpr double kLeastBoard = 0.100;    // shorter edge of a board [m]
// soft shade comes from a foot near by and from a wall farther off [m]
constexpr double kNear = 0.012, kFar = 0.070;
constexpr double kFromWall[] = {0.010, 0.028, 0.060};  // where a wall's shade bends most [m]
constexpr double kOpenDivision = 0.040;                // of a board where nothing stands [m]
constexpr double kLeastDivision = 0.002;               // [m]

/// Both ends and the divisions between, in order.
std::vector<double> FindLines(double low, double high, std::vector<double> divisions) {
  std::sort(divisions.begin(), divisions.end());
  std::vector<double> lines{low};
  for (const double line : divisions) {
    if (line > lines.back() + kLeastDivision && line < high - kLeastDivision) lines.push_back(line);
  }
  lines.push_back(high);
  return lines;
}

}  // namespace

bool HasTrainerBox(const scene::Scene& scene) {
  return !scene.objects.empty() && !scene.HasPatient();
}

TriangleMesh MakeFacedBox(const Vec3& min, const Vec3& max, const Divisions& divisions, DividedFaces faces) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool is_far : {false, true}) {
      const bool is_divided = faces == DividedFaces::kAll || (axis == 2 && is_far);
      const auto lines = [&](int along) {
        return FindLines(min[along], max[along],
                         is_divided ? divisions[static_cast<std::size_t>(along)] : std::vector<double>{});
      };
      const std::vector<double> columns = lines(u), rows = lines(v);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      const auto width = static_cast<std::uint32_t>(columns.size());
      for (const double row : rows) {
        for (const double column : columns) {
          Vec3 p = is_far ? max : min;
          p[u] = column;
          p[v] = row;
          mesh.positions.push_back(p);
        }
      }
      for (std::uint32_t row = 0; row + 1 < rows.size(); ++row) {
        for (std::uint32_t column = 0; column + 1 < width; ++column) {
          const std::uint32_t a = first + row * width + column, b = a + 1, c = a + width, d = c + 1;
          // counter-clockwise from outside
          mesh.triangles.push_back(is_far ? geometry::Triangle{a, b, d} : geometry::Triangle{a, d, b});
          mesh.triangles.push_back(is_far ? geometry::Triangle{a, d, c} : geometry::Triangle{a, c, d});
        }
      }
    }
  }
  return mesh;
}

bool IsBoard(const rigid::RigidShape& shape) {
  if (shape.kind != rigid::RigidShape::Kind::kBox) return false;
  const Vec3& half = shape.size;
  return std::min(half.x, half.y) >= 0.5 * kLeastBoard && half.z < std::min(half.x, half.y);
}

TriangleMesh MakeBoard(const Vec3& half, const math::Pose& X_world_board,
                       std::span<const TriangleMesh> still) {
  const math::Pose X_board_world = math::Inverse(X_world_board);
  Divisions divisions;
  for (const TriangleMesh& mesh : still) {
    Vec3 low = X_board_world * mesh.positions.front(), high = low;
    for (const Vec3& p_world : mesh.positions) {
      const Vec3 p = X_board_world * p_world;
      low = math::Min(low, p);
      high = math::Max(high, p);
    }
    if (low.z > half.z + kNear || high.z <= half.z + 1e-6) continue;  // it does not stand on it
    for (int k = 0; k < 2; ++k) {
      for (const double share : {0.0, 0.4, 1.0}) {
        divisions[static_cast<std::size_t>(k)].push_back(low[k] - share * kNear);
        divisions[static_cast<std::size_t>(k)].push_back(high[k] + share * kNear);
      }
    }
  }
  for (int k = 0; k < 2; ++k) {
    auto& lines = divisions[static_cast<std::size_t>(k)];
    const std::vector<double> feet = FindLines(-half[k], half[k], lines);
    for (std::size_t i = 0; i + 1 < feet.size(); ++i) {
      const int parts = static_cast<int>(std::ceil((feet[i + 1] - feet[i]) / kOpenDivision));
      for (int part = 1; part < parts; ++part)
        lines.push_back(std::lerp(feet[i], feet[i + 1], static_cast<double>(part) / parts));
    }
  }
  return MakeFacedBox(-1.0 * half, half, divisions, DividedFaces::kTop);
}

TriangleMesh MakeTrainerBox(const scene::Scene& scene) {
  Vec3 low = scene.laparoscope.p_world_port, high = low;
  for (const scene::SceneObject& object : scene.objects) {
    low = math::Min(low, object.body.X_world_body.translation);
    high = math::Max(high, object.body.X_world_body.translation);
  }
  const Vec3 min = low - Vec3{kRoom + kSideRoom, kRoom, kUnderObjects};
  const Vec3 max{high.x + kRoom + kSideRoom, high.y + kRoom + 0.03, low.z + kHeight};
  Divisions divisions;
  for (int k = 0; k < 3; ++k) {
    for (const double far : kFromWall) {
      divisions[static_cast<std::size_t>(k)].push_back(min[k] + far);
      divisions[static_cast<std::size_t>(k)].push_back(max[k] - far);
    }
  }
  TriangleMesh box = MakeFacedBox(min, max, divisions);
  for (auto& t : box.triangles) std::swap(t[1], t[2]);  // seen from inside
  return box;
}

std::vector<std::vector<double>> CalcTrainerOpenness(std::span<const TriangleMesh> still) {
  std::vector<const TriangleMesh*> occluders;
  std::vector<Vec3> positions, normals;
  for (const TriangleMesh& mesh : still) {
    occluders.push_back(&mesh);
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    normals.resize(positions.size());
    geometry::CalcVertexNormals(mesh.positions, mesh.triangles,
                                std::span(normals).last(mesh.positions.size()));
  }
  const std::vector<double> near = render::CalcAmbientOcclusion(occluders, positions, normals, kNear);
  const std::vector<double> far = render::CalcAmbientOcclusion(occluders, positions, normals, kFar);
  std::vector<std::vector<double>> open;
  std::size_t vertex = 0;
  for (const TriangleMesh& mesh : still) {
    std::vector<double>& of_mesh = open.emplace_back(mesh.positions.size());
    for (double& value : of_mesh) {
      value = near[vertex] * far[vertex];
      ++vertex;
    }
  }
  return open;
}

}  // namespace trocar::view
