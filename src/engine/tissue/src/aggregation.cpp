// SPDX-License-Identifier: Apache-2.0
#include "aggregation.h"

#include <numeric>
#include <utility>

namespace trocar::tissue {

void Aggregation::ListMembers(const std::vector<std::uint32_t>& aggregate, std::uint32_t count,
                              std::vector<std::uint32_t>& starts, std::vector<std::uint32_t>& members) {
  // counted one place too far, so that filling moves each start to where it belongs
  starts.assign(count + 2, 0);
  for (const std::uint32_t a : aggregate) {
    if (a != kNone) ++starts[a + 2];
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  members.resize(starts.back());
  for (std::uint32_t i = 0; i < aggregate.size(); ++i) {
    if (aggregate[i] != kNone) members[starts[aggregate[i] + 1]++] = i;
  }
  starts.pop_back();
}

/// \param keeps_single  whether a node without links becomes an aggregate of its own
/// \return number of the aggregates in pairs_
std::uint32_t Aggregation::JoinPairs(const LinkGraph& from, bool keeps_single) {
  const NodeGraph& graph = from.graph;
  pairs_.assign(graph.Size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < graph.Size(); ++i) {
    if (pairs_[i] != kNone || (!keeps_single && graph.starts[i] == graph.starts[i + 1])) continue;
    pairs_[i] = count;
    std::uint32_t best = kNone;
    double most = 0;
    for (auto h = graph.starts[i]; h < graph.starts[i + 1]; ++h) {
      if (pairs_[graph.others[h]] == kNone && from.stiffness[h] > most)
        most = from.stiffness[h], best = graph.others[h];
    }
    if (best != kNone) pairs_[best] = count;
    ++count;
  }
  return count;
}

void Aggregation::MakeQuotient(const LinkGraph& from, std::uint32_t count, LinkGraph& to) {
  ListMembers(pairs_, count, starts_, members_);
  places_.assign(count, kNone);
  to.graph.Clear();
  to.stiffness.clear();
  auto& others = to.graph.others;
  auto& sums = to.stiffness;
  for (std::uint32_t a = 0; a < count; ++a) {
    const auto first = static_cast<std::uint32_t>(others.size());
    for (auto m = starts_[a]; m < starts_[a + 1]; ++m) {
      const std::uint32_t i = members_[m];
      for (auto h = from.graph.starts[i]; h < from.graph.starts[i + 1]; ++h) {
        const std::uint32_t other = pairs_[from.graph.others[h]];
        if (other == a) continue;
        std::uint32_t& place = places_[other];
        if (place == kNone || place < first) {
          place = static_cast<std::uint32_t>(others.size());
          others.push_back(other);
          sums.push_back(from.stiffness[h]);
        } else {
          sums[place] += from.stiffness[h];
        }
      }
    }
    for (std::size_t at = first + 1; at < others.size(); ++at) {
      const std::uint32_t other = others[at];
      const double sum = sums[at];
      std::size_t place = at;
      for (; place > first && other < others[place - 1]; --place)
        others[place] = others[place - 1], sums[place] = sums[place - 1];
      others[place] = other, sums[place] = sum;
    }
    to.graph.starts.push_back(static_cast<std::uint32_t>(others.size()));
  }
}

void Aggregation::Join(const LinkGraph& fine, int pairings) {
  MakeQuotient(fine, JoinPairs(fine, false), coarse_);
  aggregate_ = pairs_;
  for (int pairing = 1; pairing < pairings; ++pairing) {
    std::swap(coarse_, halfway_);
    MakeQuotient(halfway_, JoinPairs(halfway_, true), coarse_);
    for (std::uint32_t& a : aggregate_) {
      if (a != kNone) a = pairs_[a];
    }
  }
}

void LinkGraph::Reserve(std::size_t nodes, std::size_t links) {
  graph.starts.reserve(nodes + 1);
  graph.others.reserve(links);
  stiffness.reserve(links);
}

void Aggregation::Reserve(std::size_t nodes, std::size_t links) {
  for (LinkGraph* graph : {&coarse_, &halfway_}) graph->Reserve(nodes, links);
  for (auto* list : {&aggregate_, &pairs_, &starts_, &members_, &places_}) list->reserve(nodes + 2);
}

}  // namespace trocar::tissue
