// SPDX-License-Identifier: Apache-2.0
#include "pressure_stiffness.h"

#include <algorithm>

#include "node_vectors.h"
#include "trocar/base/assert.h"

namespace trocar::tissue {
namespace {

constexpr std::size_t kNoEntry = static_cast<std::size_t>(-1);

}  // namespace

void PressureStiffness::SetModel(const OrderedModel& model) noexcept {
  model_ = &model;
  surfaces_.clear(), triangles_.clear();
  has_pressure_ = false;
}

void PressureStiffness::Reserve(std::size_t nodes, std::size_t entries) {
  surfaces_.reserve(kMaxConstraints);
  triangles_.reserve(2 * nodes);  // a closed surface has twice as many as nodes, less four
  surface_of_.reserve(nodes), factor_.reserve(nodes);
  left_.reserve(entries), right_.reserve(entries), follower_stiffness_.reserve(3 * entries);
}

void PressureStiffness::SetSurfaces(std::span<const PressedSurface> surfaces) {
  TROCAR_ASSERT(surfaces.size() <= kMaxConstraints);
  bool are_known = surfaces.size() == surfaces_.size();
  auto known = triangles_.cbegin();
  for (std::size_t c = 0; are_known && c < surfaces.size(); ++c) {
    const auto& [first_node, triangles] = surfaces[c];
    are_known = first_node == surfaces_[c].first_node && triangles.size() == surfaces_[c].triangle_count &&
                std::equal(triangles.begin(), triangles.end(), known);
    known += static_cast<std::ptrdiff_t>(surfaces_[c].triangle_count);
  }
  if (are_known) return;
  surfaces_.clear(), triangles_.clear();
  for (const auto& [first_node, triangles] : surfaces) {
    surfaces_.push_back({first_node, triangles.size()});
    triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
  }
  FindCorners();
}

std::size_t PressureStiffness::FindEntry(std::uint32_t a, std::uint32_t b) const noexcept {
  const NodeGraph& graph = model_->graph;
  for (auto h = graph.starts[a]; h < graph.starts[a + 1]; ++h) {
    if (graph.others[h] == b) return model_->layout.Entry(a, h - graph.starts[a]);
  }
  return kNoEntry;
}

/// A link that is no edge, or whose edge has one triangle, has its own node on either side: nothing lies across it.
void PressureStiffness::FindCorners() noexcept {
  const SliceLayout& layout = model_->layout;
  const std::size_t entries = layout.Steps() * kSliceNodes;
  surface_of_.assign(layout.PaddedNodes(), kNoSurface);
  factor_.resize(layout.PaddedNodes());
  left_.resize(entries), right_.resize(entries), follower_stiffness_.resize(3 * entries);
  const auto for_each_entry = [&](const auto& work) {
    for (std::uint32_t slice = 0; slice < layout.Slices(); ++slice) {
      for (std::uint32_t step = layout.starts[slice]; step < layout.starts[slice + 1]; ++step) {
        for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane)
          work(std::size_t{step} * kSliceNodes + lane, slice * kSliceNodes + lane);
      }
    }
  };
  for_each_entry([&](std::size_t entry, std::uint32_t node) { left_[entry] = right_[entry] = node; });
  auto triangle = triangles_.begin();
  for (std::size_t c = 0; c < surfaces_.size(); ++c) {
    for (std::size_t t = 0; t < surfaces_[c].triangle_count; ++t, ++triangle) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto node = [&](std::size_t k) {
          return model_->new_of_old[surfaces_[c].first_node + (*triangle)[(corner + k) % 3]];
        };
        surface_of_[node(0)] = static_cast<std::uint8_t>(c);
        const std::size_t there = FindEntry(node(0), node(1)), back = FindEntry(node(1), node(0));
        if (there == kNoEntry || back == kNoEntry) continue;
        left_[there] = node(2), right_[back] = node(2);
      }
    }
  }
  for_each_entry([&](std::size_t entry, std::uint32_t node) {
    if (left_[entry] == node || right_[entry] == node) left_[entry] = right_[entry] = node;
  });
}

void PressureStiffness::Update(const Kernels& kernels, Workers& workers, std::span<const double> pressure,
                               std::span<const Double4> position) noexcept {
  has_pressure_ = std::any_of(pressure.begin(), pressure.end(), [](double p) { return p != 0.0; });
  if (!has_pressure_) return;
  const FollowerPass pass{model_->layout.Table(), left_.data(),    right_.data(),
                          factor_.data(),         position.data(), follower_stiffness_.data()};
  ForEachNodeChunk(workers, factor_.size(),
                   [&](std::uint32_t first, std::uint32_t last, std::uint32_t /*chunk*/) {
                     for (std::uint32_t i = first; i < last; ++i)
                       factor_[i] = surface_of_[i] == kNoSurface ? 0.0 : pressure[surface_of_[i]] / 6.0;
                     kernels.calc_follower_stiffness(pass, first / kSliceNodes, last / kSliceNodes);
                   });
}

}  // namespace trocar::tissue
