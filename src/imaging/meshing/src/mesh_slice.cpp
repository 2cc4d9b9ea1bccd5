// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/mesh_slice.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "trocar/base/to_integer.h"

namespace trocar::meshing {

using math::Vec2;
using math::Vec3;

std::vector<SliceSegment> CutMesh(const geometry::TriangleMesh& mesh, double height) {
  std::vector<SliceSegment> segments;
  for (const auto& t : mesh.triangles) {
    Vec2 ends[2];
    std::array<std::uint64_t, 2> edges{};
    int count = 0;
    for (int i = 0; i < 3; ++i) {
      // from the smaller index, so that both triangles of an edge find the same point
      const auto from = std::min(t[i], t[(i + 1) % 3]), to = std::max(t[i], t[(i + 1) % 3]);
      const Vec3 &a = mesh.positions[from], &b = mesh.positions[to];
      // a vertex in the plane counts as above it: every loop closes
      if ((a.z < height) == (b.z < height)) continue;
      const double part = (height - a.z) / (b.z - a.z);
      ends[count] = {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
      edges[count] = static_cast<std::uint64_t>(from) << 32 | to;
      ++count;
    }
    if (count == 2) segments.push_back({ends[0], ends[1], edges});
  }
  return segments;
}

std::vector<std::vector<Vec2>> JoinLoops(const std::vector<SliceSegment>& segments) {
  // each cut edge belongs to two segments
  std::map<std::uint64_t, std::array<std::size_t, 2>> at_edge;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (const auto edge : segments[s].edges) {
      auto [place, is_new] = at_edge.try_emplace(edge, std::array<std::size_t, 2>{s, kNone});
      if (!is_new) place->second[1] = s;
    }
  }
  std::vector<char> is_used(segments.size(), 0);
  std::vector<std::vector<Vec2>> loops;
  for (std::size_t first = 0; first < segments.size(); ++first) {
    if (is_used[first]) continue;
    std::vector<Vec2> loop;
    std::size_t here = first;
    std::uint64_t entered = segments[first].edges[0];
    while (here != kNone && !is_used[here]) {
      is_used[here] = 1;
      const int out = segments[here].edges[0] == entered ? 1 : 0;
      loop.push_back(out == 1 ? segments[here].b : segments[here].a);
      entered = segments[here].edges[out];
      const auto& pair = at_edge[entered];
      here = pair[0] == here ? pair[1] : pair[0];
    }
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

double CalcPolygonArea(const std::vector<Vec2>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

std::vector<float> CalcCoverage(const std::vector<SliceSegment>& segments, const SliceGrid& grid,
                                int samples) {
  std::vector<float> coverage(static_cast<std::size_t>(grid.width) * grid.height, 0.0f);
  const double step = grid.pixel / samples;
  const int rows = grid.height * samples, columns = grid.width * samples;
  const auto sample_at = [&](int i) { return (i + 0.5) * step - 0.5 * grid.pixel; };
  // crossings of each row of samples
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(rows));
  for (const SliceSegment& segment : segments) {
    const Vec2& low = segment.a.y < segment.b.y ? segment.a : segment.b;
    const Vec2& high = segment.a.y < segment.b.y ? segment.b : segment.a;
    int row = std::max(0, base::FloorTo<int>((low.y + 0.5 * grid.pixel) / step - 0.5));
    for (; row < rows && sample_at(row) < high.y; ++row) {
      const double y = sample_at(row);
      if (y >= low.y) crossings[row].push_back(low.x + (high.x - low.x) * (y - low.y) / (high.y - low.y));
    }
  }
  const float share = 1.0f / static_cast<float>(samples * samples);
  for (int row = 0; row < rows; ++row) {
    auto& xs = crossings[row];
    std::sort(xs.begin(), xs.end());
    for (std::size_t i = 0; i + 1 < xs.size(); i += 2) {
      int column = std::max(0, base::CeilTo<int>((xs[i] + 0.5 * grid.pixel) / step - 0.5));
      for (; column < columns && sample_at(column) < xs[i + 1]; ++column)
        coverage[static_cast<std::size_t>(row / samples) * grid.width + column / samples] += share;
    }
  }
  return coverage;
}

}  // namespace trocar::meshing
