// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/centre_line_cut.h"

#include <algorithm>

#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"

namespace trocar::geometry {
namespace {

/// Shortest piece of an edge that a cut leaves, as a share of it [-].
constexpr double kShortest = 0.1;

std::uint32_t AddEnd(CentreLineGraph& graph, std::uint32_t a, std::uint32_t b, double t) {
  graph.rest.push_back(math::Lerp(graph.rest[a], graph.rest[b], t));
  graph.positions.push_back(math::Lerp(graph.positions[a], graph.positions[b], t));
  graph.radii.push_back(graph.radii[a] + t * (graph.radii[b] - graph.radii[a]));
  graph.is_cut_end.push_back(1);
  return static_cast<std::uint32_t>(graph.rest.size() - 1);
}

}  // namespace

void CentreLineGraph::ReserveCuts(std::size_t count) {
  for (auto* points : {&rest, &positions}) points->reserve(points->size() + 2 * count);
  radii.reserve(radii.size() + 2 * count);
  is_cut_end.reserve(is_cut_end.size() + 2 * count);
  edges.reserve(edges.size() + count);
}

std::size_t CentreLineGraph::CutCapacity() const {
  const std::size_t points =
      std::min({rest.capacity(), positions.capacity(), radii.capacity(), is_cut_end.capacity()});
  return std::min((points - rest.size()) / 2, edges.capacity() - edges.size());
}

std::uint32_t AddLine(std::span<const math::Vec3> points, std::span<const double> radii,
                      CentreLineGraph& graph) {
  TROCAR_ASSERT(points.size() >= 2 && radii.size() == points.size());
  const auto first = static_cast<std::uint32_t>(graph.rest.size());
  graph.rest.insert(graph.rest.end(), points.begin(), points.end());
  graph.positions.insert(graph.positions.end(), points.begin(), points.end());
  graph.radii.insert(graph.radii.end(), radii.begin(), radii.end());
  graph.is_cut_end.insert(graph.is_cut_end.end(), points.size(), 0);
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i) graph.edges.push_back({first + i, first + i + 1});
  return first;
}

std::size_t CutCentreLines(const FlatSweep& sweep, CentreLineGraph& graph,
                           std::span<CentreLineCut> cuts) noexcept {
  std::size_t count = 0;
  const std::size_t edges_before = graph.edges.size();
  for (std::uint32_t e = 0; e < edges_before && count < cuts.size(); ++e) {
    const std::uint32_t a = graph.edges[e][0], b = graph.edges[e][1];
    const auto at = FindCrossing(sweep, graph.positions[a], graph.positions[b]);
    if (!at) continue;
    const double length = math::Distance(graph.positions[a], graph.positions[b]);
    if ((graph.is_cut_end[a] && *at * length < kLeastStump) ||
        (graph.is_cut_end[b] && (1.0 - *at) * length < kLeastStump))
      continue;
    // a joint of two edges is cut once
    const math::Vec3 here = math::Lerp(graph.positions[a], graph.positions[b], *at);
    const bool is_cut_already = std::any_of(
        cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(count), [&](const CentreLineCut& cut) {
          const bool shares_point = cut.a == a || cut.b == a || cut.a == b || cut.b == b;
          return shares_point &&
                 math::Distance(graph.positions[cut.ends[0]], here) < kShortest * length + kLeastStump;
        });
    if (is_cut_already) continue;
    if (graph.CutCapacity() == 0) break;
    CentreLineCut cut{e, static_cast<std::uint32_t>(graph.edges.size()), a,
                      b, std::clamp(*at, kShortest, 1.0 - kShortest),    {}};
    for (auto& end : cut.ends) end = AddEnd(graph, a, b, cut.t);
    graph.edges[e] = {a, cut.ends[0]};
    graph.edges.push_back({cut.ends[1], b});
    cuts[count++] = cut;
  }
  return count;
}

void VisitState(base::StateArchive& archive, CentreLineGraph& graph) {
  archive.Field("rest", graph.rest);
  archive.Field("radii", graph.radii);
  archive.Field("edges", graph.edges);
  archive.Field("is_cut_end", graph.is_cut_end);
  if (!archive.IsRestoring() || !archive.ok()) return;
  const std::size_t points = graph.rest.size();
  const auto is_edge = [&](const Edge& edge) { return edge[0] < points && edge[1] < points; };
  if (graph.radii.size() != points || graph.is_cut_end.size() != points ||
      !std::all_of(graph.edges.begin(), graph.edges.end(), is_edge)) {
    archive.Fail("is no graph");
    return;
  }
  graph.positions = graph.rest;
}

}  // namespace trocar::geometry
