// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/marching_cubes.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace trocar::meshing {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;
using math::Vec3;

constexpr double kEndDistance = 0.02;  // of an edge's length
constexpr float kLargest = 1e30f;      // the product of two is far from overflow in double
constexpr int kSlabLayers = 16;        // a fixed number, so that the result does not depend on the threads
constexpr std::uint32_t kNone = 0xffffffffu;

/// Vertex of every lattice edge that starts in one plane, by the edge's place and axis.
struct EdgeTable {
  std::vector<std::uint32_t> vertices;
  std::vector<std::size_t> filled;

  explicit EdgeTable(std::size_t slots) : vertices(slots, kNone) {}
  void Clear() {
    for (const auto slot : filled) vertices[slot] = kNone;
    filled.clear();
  }
};

/// One plane of values with a border of outside.
struct PaddedPlane {
  std::vector<float> values;
  std::vector<std::uint8_t> inside;
};

/// Some layers of cells, with vertices of their own also in the planes that they share with other slabs.
class Slab {
 public:
  Slab(const ScalarVolume& volume, int first_layer, int last_layer)
      : volume_(volume),
        width_(volume.size[0] + 2),
        height_(volume.size[1] + 2),
        below_(static_cast<std::size_t>(width_) * height_ * 3),
        above_(below_.vertices.size()) {
    PaddedPlane lower = PadPlane(first_layer), upper;
    for (int k = first_layer; k < last_layer; ++k) {
      upper = PadPlane(k + 1);
      MarchLayer(k, lower, upper);
      if (k == first_layer) {
        for (const auto slot : below_.filled) {
          if (slot % 3 != 2) first_plane_.emplace_back(slot, below_.vertices[slot]);
        }
      }
      below_.Clear();
      std::swap(below_, above_);
      std::swap(lower, upper);
    }
  }

  TriangleMesh mesh;

  /// (slot, vertex) of the plane shared with the slab below.
  const std::vector<std::pair<std::size_t, std::uint32_t>>& FirstPlane() const { return first_plane_; }
  /// Vertex in the plane shared with the slab above.
  std::uint32_t& OnLastPlane(std::size_t slot) { return below_.vertices[slot]; }
  const std::vector<std::size_t>& LastPlaneSlots() const { return below_.filled; }

 private:
  PaddedPlane PadPlane(int k) const {
    const float outside = static_cast<float>(-0.5 * volume_.spacing);
    const auto count = static_cast<std::size_t>(width_) * height_;
    PaddedPlane plane{std::vector<float>(count, outside), std::vector<std::uint8_t>(count, 0)};
    if (k < 0 || k >= volume_.size[2]) return plane;
    for (int j = 0; j < volume_.size[1]; ++j) {
      const float* from = &volume_.values[volume_.Index(0, j, k)];
      const auto to = static_cast<std::size_t>(j + 1) * width_ + 1;
      for (int i = 0; i < volume_.size[0]; ++i) {
        const float value = std::clamp(from[i], -kLargest, kLargest);
        plane.values[to + i] = value == value ? value : outside;
        plane.inside[to + i] = value > 0 ? 1 : 0;
      }
    }
    return plane;
  }

  void MarchLayer(int k, const PaddedPlane& lower, const PaddedPlane& upper) {
    std::vector<std::uint8_t> column(static_cast<std::size_t>(width_));
    for (int j = -1; j < volume_.size[1]; ++j) {
      const auto row = static_cast<std::size_t>(j + 1) * width_, next = row + width_;
      // signs of the four corners at each i: a cell is cut where two neighbours are not all in or all out
      for (int i = 0; i < width_; ++i) {
        column[i] = static_cast<std::uint8_t>(lower.inside[row + i] | lower.inside[next + i] << 1 |
                                              upper.inside[row + i] << 2 | upper.inside[next + i] << 3);
      }
      for (int i = 0; i + 1 < width_; ++i) {
        if (column[i] == column[i + 1] && (column[i] == 0 || column[i] == 15)) continue;
        const float values[8] = {lower.values[row + i],  lower.values[row + i + 1],
                                 lower.values[next + i], lower.values[next + i + 1],
                                 upper.values[row + i],  upper.values[row + i + 1],
                                 upper.values[next + i], upper.values[next + i + 1]};
        MarchCell(i - 1, j, k, values);
      }
    }
  }

  void MarchCell(int i, int j, int k, const float (&values)[8]) {
    unsigned inside = 0, joined = 0;
    for (unsigned c = 0; c < 8; ++c) inside |= values[c] > 0 ? 1u << c : 0u;
    const unsigned ambiguous = FindAmbiguousFaces(inside);
    for (unsigned f = 0; ambiguous >> f != 0; ++f) {
      if ((ambiguous >> f & 1u) == 0) continue;
      const auto& face = kCellFaces[f];
      const std::size_t first = values[face[0]] > 0 ? 0 : 1;
      const bool is_joined = IsJoinedAtSaddle(values[face[first]], values[face[first + 1]],
                                              values[face[first + 2]], values[face[(first + 3) & 3]]);
      joined |= is_joined ? 1u << f : 0u;
    }
    for (const CellLoop& loop : FindCellLoops(inside, joined)) {
      const std::size_t n = loop.edges.size();
      std::uint32_t corners[12];
      for (std::size_t e = 0; e < n; ++e) corners[e] = VertexOn(i, j, k, loop.edges[e], values);
      if (!loop.has_centre) {
        for (std::size_t e = 1; e + 1 < n; ++e)
          mesh.triangles.push_back({corners[0], corners[e], corners[e + 1]});
        continue;
      }
      Vec3 centre;
      for (std::size_t e = 0; e < n; ++e) centre += mesh.positions[corners[e]];
      const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(centre / static_cast<double>(n));
      for (std::size_t e = 0; e < n; ++e)
        mesh.triangles.push_back({middle, corners[e], corners[(e + 1) % n]});
    }
  }

  std::uint32_t VertexOn(int i, int j, int k, int edge, const float (&values)[8]) {
    const int a = kCellEdges[edge][0], b = kCellEdges[edge][1];
    EdgeTable& table = (a >> 2 & 1) != 0 ? above_ : below_;
    const auto place = static_cast<std::size_t>(j + 1 + (a >> 1 & 1)) * width_ + (i + 1 + (a & 1));
    const std::size_t slot = place * 3 + edge / 4;
    std::uint32_t& vertex = table.vertices[slot];
    if (vertex != kNone) return vertex;
    const double from = values[a], to = values[b];
    const double t = std::clamp(from / (from - to), kEndDistance, 1.0 - kEndDistance);
    vertex = static_cast<std::uint32_t>(mesh.positions.size());
    table.filled.push_back(slot);
    mesh.positions.push_back(math::Lerp(volume_.Position(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2 & 1)),
                                        volume_.Position(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1)),
                                        t));
    return vertex;
  }

  const ScalarVolume& volume_;
  int width_, height_;
  EdgeTable below_, above_;
  std::vector<std::pair<std::size_t, std::uint32_t>> first_plane_;
};

/// Puts the slabs together; vertices in a shared plane become those of the slab below.
TriangleMesh JoinSlabs(std::vector<Slab>& slabs) {
  TriangleMesh mesh;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    Slab& slab = slabs[s];
    std::vector<std::uint32_t> number(slab.mesh.positions.size(), kNone);
    if (s > 0) {
      for (const auto& [slot, vertex] : slab.FirstPlane()) number[vertex] = slabs[s - 1].OnLastPlane(slot);
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] != kNone) continue;
      number[v] = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(slab.mesh.positions[v]);
    }
    for (const Triangle& t : slab.mesh.triangles)
      mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    for (const auto slot : slab.LastPlaneSlots()) slab.OnLastPlane(slot) = number[slab.OnLastPlane(slot)];
  }
  return mesh;
}

}  // namespace

TriangleMesh MarchCubes(const ScalarVolume& volume) {
  if (volume.values.empty()) return {};
  // layers of cells from -1 to size - 1
  const int layers = volume.size[2] + 1;
  const int count = (layers + kSlabLayers - 1) / kSlabLayers;
  std::vector<std::vector<Slab>> parts(static_cast<std::size_t>(count));
  oneapi::tbb::parallel_for(0, count, [&](int s) {
    const int first = s * kSlabLayers - 1;
    parts[static_cast<std::size_t>(s)].emplace_back(volume, first,
                                                    std::min(first + kSlabLayers, volume.size[2]));
  });
  std::vector<Slab> slabs;
  slabs.reserve(parts.size());
  for (auto& part : parts) slabs.push_back(std::move(part.front()));
  return JoinSlabs(slabs);
}

}  // namespace trocar::meshing
