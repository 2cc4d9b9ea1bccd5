// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/cuttable_tubes.h"

#include <algorithm>

#include "trocar/base/assert.h"
#include "trocar/base/state_archive.h"

namespace trocar::surgery {

using geometry::kNone;

namespace {

/// Springs and nodes that one cut changes at most: the edge, its two pieces, and as many bending springs on each side.
constexpr std::size_t kSpringsACut = 3 + 3 * 8;
constexpr std::size_t kNodesACut = 4;

bool Joins(const auto& spring, std::uint32_t a, std::uint32_t b) {
  return (spring.a == a && spring.b == b) || (spring.a == b && spring.b == a);
}

/// The spring between two nodes with what the tick changed so far; stiffness 0 where there is none.
tissue::Spring FindSpring(const TopologyChange& change, const tissue::TissueDefinition& definition,
                          std::uint32_t a, std::uint32_t b) {
  for (const SpringChange& spring : change.springs) {
    if (Joins(spring, a, b)) return {a, b, spring.stiffness, spring.rest_length, spring.law};
  }
  for (const tissue::Spring& spring : definition.springs) {
    if (Joins(spring, a, b)) return spring;
  }
  return {a, b, 0.0, 0.0, 0};
}

void SetSpring(std::uint32_t a, std::uint32_t b, double stiffness, double rest_length, std::uint32_t law,
               const std::array<std::uint32_t, 2>& inherits, TopologyChange& change) {
  for (SpringChange& spring : change.springs) {
    if (!Joins(spring, a, b)) continue;
    spring.stiffness = stiffness;
    spring.rest_length = rest_length;
    return;
  }
  change.springs.push_back({std::min(a, b), std::max(a, b), stiffness, rest_length, law, inherits});
}

/// The node's entry in the change, made from the definition where there is none yet.
NodeChange& EditNode(std::uint32_t node, const tissue::TissueDefinition& definition, TopologyChange& change) {
  for (NodeChange& entry : change.nodes) {
    if (entry.node == node) return entry;
  }
  NodeChange entry;
  entry.node = node;
  entry.mass = definition.mass[node];
  entry.shape_stiffness = definition.shape_stiffness[node];
  change.nodes.push_back(entry);
  return change.nodes.back();
}

}  // namespace

CuttableTubes::CuttableTubes(std::uint32_t first_spare, std::uint32_t spare_count)
    : next_spare_(first_spare), end_spare_(first_spare + spare_count) {}

void CuttableTubes::AddTube(std::uint32_t first_node, std::span<const math::Vec3> points,
                            std::span<const double> radii) {
  TROCAR_ASSERT(next_spare_ <= end_spare_);
  geometry::AddLine(points, radii, graph_);
  for (std::uint32_t i = 0; i < points.size(); ++i) nodes_.push_back(first_node + i);
  const std::size_t cuts = (end_spare_ - next_spare_) / 2;
  graph_.ReserveCuts(cuts);
  nodes_.reserve(nodes_.size() + 2 * cuts);
}

void CuttableTubes::ReserveFor(TopologyChange& change) const {
  change.Reserve(change.nodes.capacity() + kNodesACut * kMostCuts,
                 change.springs.capacity() + kSpringsACut * kMostCuts, change.cut_strands.capacity());
}

std::size_t CuttableTubes::Cut(const BladeMove& move, const tissue::TissueDefinition& definition,
                               std::span<const math::Vec3> position, TopologyChange& change,
                               std::span<geometry::CentreLineCut> cuts) noexcept {
  for (std::size_t p = 0; p < nodes_.size(); ++p) graph_.positions[p] = position[nodes_[p]];
  std::size_t count = 0;
  const geometry::BladeMoves moves = geometry::MakeFlatMoves(move.before, move.now);
  for (const geometry::FlatMove& part : moves.Moves()) {
    const std::size_t capacity =
        std::min<std::size_t>({cuts.size() - count, kMostCuts - count, (end_spare_ - next_spare_) / 2});
    const std::size_t made = geometry::CutCentreLines(part.sweep, graph_, cuts.subspan(count, capacity));
    for (std::size_t i = 0; i < 2 * made; ++i) nodes_.push_back(next_spare_++);
    for (std::size_t i = count; i < count + made; ++i) ListCut(cuts[i], definition, change);
    count += made;
  }
  return count;
}

void CuttableTubes::ListCut(const geometry::CentreLineCut& cut, const tissue::TissueDefinition& definition,
                            TopologyChange& change) noexcept {
  const std::uint32_t a = nodes_[cut.a], b = nodes_[cut.b];
  const std::uint32_t ends[2] = {nodes_[cut.ends[0]], nodes_[cut.ends[1]]};
  const double shares[2] = {cut.t, 1.0 - cut.t};
  // half of each end's mass and foundation belongs to the edge; its pieces share that by length
  const auto share_out = [&](double NodeChange::*amount) {
    const double edge =
        0.5 * (EditNode(a, definition, change).*amount + EditNode(b, definition, change).*amount);
    EditNode(a, definition, change).*amount *= 0.5;
    EditNode(b, definition, change).*amount *= 0.5;
    EditNode(a, definition, change).*amount += 0.5 * shares[0] * edge;
    EditNode(b, definition, change).*amount += 0.5 * shares[1] * edge;
    for (int i = 0; i < 2; ++i) EditNode(ends[i], definition, change).*amount = 0.5 * shares[i] * edge;
  };
  for (int i = 0; i < 2; ++i) {
    NodeChange& end = EditNode(ends[i], definition, change);
    end.is_new = true;
    end.from = {a, b, kNone};
    end.weights = {1.0 - cut.t, cut.t, 0.0};
    end.rest = graph_.rest[cut.ends[static_cast<std::size_t>(i)]];
    end.position = graph_.positions[cut.ends[static_cast<std::size_t>(i)]];
  }
  share_out(&NodeChange::mass);
  share_out(&NodeChange::shape_stiffness);

  const tissue::Spring whole = FindSpring(change, definition, a, b);
  SetSpring(a, b, 0.0, 0.0, 0, {kNone, kNone}, change);
  SetSpring(a, ends[0], whole.stiffness / shares[0], whole.rest_length * shares[0], whole.law, {a, b},
            change);
  SetSpring(ends[1], b, whole.stiffness / shares[1], whole.rest_length * shares[1], whole.law, {a, b},
            change);
  // bending springs over the cut end in the stump
  const auto shorten = [&](std::uint32_t kept_point, std::uint32_t lost, std::size_t end) {
    const std::uint32_t kept = nodes_[kept_point];
    const tissue::Spring bending = FindSpring(change, definition, kept, lost);
    if (bending.stiffness <= 0.0) return;
    const double length = math::Distance(graph_.rest[kept_point], graph_.rest[cut.ends[end]]);
    SetSpring(kept, lost, 0.0, 0.0, 0, {kNone, kNone}, change);
    SetSpring(kept, ends[end], bending.stiffness * bending.rest_length / length, length, bending.law,
              {kept, lost}, change);
  };
  for (std::uint32_t e = 0; e < graph_.edges.size(); ++e) {
    const auto& edge = graph_.edges[e];
    if (e == cut.edge || e == cut.new_edge) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      if (edge[i] == cut.a) shorten(edge[1 - i], b, 0);
      if (edge[i] == cut.b) shorten(edge[1 - i], a, 1);
    }
  }
}

void CuttableTubes::VisitState(base::StateArchive& archive) {
  archive.Field("graph", graph_);
  archive.Field("nodes", nodes_);
  archive.Field("next_spare", next_spare_);
  if (archive.IsRestoring() && archive.ok() &&
      (nodes_.size() != graph_.rest.size() || next_spare_ > end_spare_))
    archive.Fail("has points without a node");
}

}  // namespace trocar::surgery
