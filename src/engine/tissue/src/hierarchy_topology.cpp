// SPDX-License-Identifier: Apache-2.0
#include "hierarchy_topology.h"

#include <algorithm>
#include <utility>

#include "trocar/base/spare_capacity.h"

namespace trocar::tissue {
namespace {

/// Slices of a coarser level that a thread gathers at a time.
constexpr std::uint32_t kChunkCoarseSlices = 8;
/// Passes of pairwise joining for one level: up to 2^n nodes in an aggregate.
constexpr int kPairings = 2;

}  // namespace

std::uint32_t CoarseChunkSize(std::uint32_t slices) {
  return std::max(kChunkCoarseSlices, slices / Workers::kMaxChunks + 1);
}

void LevelTopology::SetGraph(const NodeGraph& graph) {
  SetSliceLayout(graph, layout);
  aggregate.clear(), member_starts.clear(), members.clear();
  coarsened.clear(), coarsened_starts.clear(), mirror_entry.clear();
}

void LevelTopology::Reserve(std::size_t nodes, std::size_t steps) {
  layout.starts.reserve(nodes / kSliceNodes + 2);
  for (auto* entries : {&layout.others, &mirror_entry}) entries->reserve(steps * kSliceNodes);
  coarsened.reserve(steps * kSliceNodes / 2);
  for (auto* list : {&aggregate, &member_starts, &members, &coarsened_starts}) list->reserve(nodes + 2);
}

std::vector<LevelCapacity> CalcLevelCapacities(const HierarchyTopology& like, double share) {
  std::vector<LevelCapacity> capacities;
  LevelCapacity level;
  const std::size_t spare_levels = share > 0.0 ? 2 : 0;
  for (std::size_t at = 0; at < std::min(like.level_count + spare_levels, kMaxLevels); ++at) {
    LevelCapacity own;
    if (at < like.level_count) {
      const SliceLayout& layout = like.levels[at].layout;
      own = {layout.PaddedNodes(), layout.Steps()};
    }
    level = {std::max(base::AddSpare(own.nodes, share), share > 0.0 ? level.nodes / 2 : 0),
             std::max(base::AddSpare(own.steps, share), share > 0.0 ? level.steps / 2 : 0)};
    capacities.push_back(level);
  }
  return capacities;
}

void HierarchyBuilder::Build(const NodeGraph& graph, std::span<const double> stiffness,
                             HierarchyTopology& made) {
  fine_.graph.starts = graph.starts;
  fine_.graph.others = graph.others;
  fine_.stiffness.assign(stiffness.begin(), stiffness.end());
  if (made.levels.empty()) made.levels.emplace_back();
  made.levels.front().SetGraph(graph);
  std::size_t& count = made.level_count;
  for (count = 1; fine_.graph.Size() > kDirectNodes && count < kMaxLevels; ++count) {
    aggregation_.Join(fine_, kPairings);
    const NodeGraph& coarse = aggregation_.Coarse().graph;
    if (coarse.Size() == 0 || 10 * coarse.Size() > 9 * fine_.graph.Size()) break;  // hardly a link left
    if (made.levels.size() == count) made.levels.emplace_back();
    made.levels[count].SetGraph(coarse);
    FillTransfer(fine_.graph, coarse, count - 1, made);
    std::swap(fine_, aggregation_.Coarse());
  }
}

/// The way from a level to the next: members of the aggregates, and the coarse link that each link is part of.
void HierarchyBuilder::FillTransfer(const NodeGraph& fine, const NodeGraph& coarse, std::size_t at,
                                    HierarchyTopology& made) {
  constexpr std::uint32_t kNoEntry = LevelTopology::kNoEntry;
  LevelTopology& level = made.levels[at];
  LevelTopology& next = made.levels[at + 1];
  level.aggregate = aggregation_.Aggregate();
  Aggregation::ListMembers(level.aggregate, coarse.Size(), level.member_starts, level.members);
  const std::uint32_t chunk_nodes = CoarseChunkSize(next.layout.Slices()) * kSliceNodes;
  coarse_entry_.assign(level.layout.Steps() * kSliceNodes, kNoEntry);
  next.mirror_entry.assign(next.layout.Steps() * kSliceNodes, kNoEntry);
  places_.assign(coarse.Size(), 0), counts_.assign(coarse.Size(), 0);
  level.coarsened_starts.clear();
  std::uint32_t coarsened = 0;
  for (std::uint32_t from = 0; from < coarse.Size(); ++from) {
    if (from % chunk_nodes == 0) level.coarsened_starts.push_back(coarsened);
    for (auto h = coarse.starts[from]; h < coarse.starts[from + 1]; ++h) {
      const std::uint32_t to = coarse.others[h];
      places_[to] = static_cast<std::uint32_t>(next.layout.Entry(from, h - coarse.starts[from]));
      // rows are in ascending order: this is the next of the other's row
      if (to > from) next.mirror_entry[next.layout.Entry(to, counts_[to]++)] = places_[to];
    }
    for (auto m = level.member_starts[from]; m < level.member_starts[from + 1]; ++m) {
      const std::uint32_t i = level.members[m];
      for (auto h = fine.starts[i]; h < fine.starts[i + 1]; ++h) {
        const std::uint32_t to = level.aggregate[fine.others[h]];
        if (to <= from) continue;
        coarse_entry_[level.layout.Entry(i, h - fine.starts[i])] = places_[to];
        ++coarsened;
      }
    }
  }
  level.coarsened_starts.push_back(coarsened);
  level.coarsened.resize(coarsened);
  counts_.assign(level.coarsened_starts.begin(), level.coarsened_starts.end());
  std::uint32_t entry = 0;
  for (std::uint32_t slice = 0; slice < level.layout.Slices(); ++slice) {
    for (const std::uint32_t end = level.layout.starts[slice + 1] * kSliceNodes; entry < end; ++entry) {
      if (coarse_entry_[entry] == kNoEntry) continue;
      const std::uint32_t node = slice * kSliceNodes + entry % kSliceNodes;
      level.coarsened[counts_[level.aggregate[node] / chunk_nodes]++] = {entry, coarse_entry_[entry], node};
    }
  }
}

void HierarchyBuilder::Reserve(const HierarchyTopology& like, double share, HierarchyTopology& own) {
  const std::vector<LevelCapacity> capacities = CalcLevelCapacities(like, share);
  const SliceLayout& finest = like.levels.front().layout;
  const std::size_t nodes = base::AddSpare(finest.node_count, share),
                    links = base::AddSpare(finest.others.size(), share);
  fine_.Reserve(nodes, links);
  aggregation_.Reserve(nodes, links);
  for (auto* list : {&places_, &counts_}) list->reserve(nodes);
  coarse_entry_.reserve(links);
  own.levels.reserve(kMaxLevels);
  own.levels.resize(capacities.size());
  for (std::size_t at = 0; at < capacities.size(); ++at)
    own.levels[at].Reserve(capacities[at].nodes, capacities[at].steps);
}

}  // namespace trocar::tissue
