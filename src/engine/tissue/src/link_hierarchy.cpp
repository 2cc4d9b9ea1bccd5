// SPDX-License-Identifier: Apache-2.0
#include "link_hierarchy.h"

#include <algorithm>
#include <cmath>

#include "node_vectors.h"

namespace trocar::tissue {

using math::Symmetric3;

namespace {

/// Slices a thread takes at a time: eight parts of a patient, so that two or four threads have the same to do.
constexpr std::uint32_t kChunkSlices = 28;
/// On coarse links [-]: an aggregate is about two nodes wide, over which a step is twice as steep as a slope. A half is
/// right for slopes alone; between 0.6 and 0.8 conjugate gradients need the fewest iterations.
constexpr double kCoarseLinkScale = 0.7;
/// Of block Jacobi [-]; eigenvalues of D^-1 K reach 2, and a cycle is positive definite below 1.
constexpr float kDamping = 0.85f;
/// Sweeps on a coarsest level that is too large for a direct solution: links are gone, so one would do.
constexpr int kCoarsestSweeps = 4;

std::uint32_t SliceChunkSize(std::uint32_t slices) {
  return std::max(kChunkSlices, slices / (Workers::kMaxChunks - 1) + 1);
}

/// Calls work(first, last) for every chunk of the slices.
template <typename Work>
void ForEachSliceChunk(Workers& workers, std::uint32_t slices, const Work& work) noexcept {
  const std::uint32_t size = SliceChunkSize(slices);
  workers.Run((slices + size - 1) / size,
              [&](std::uint32_t chunk) { work(chunk * size, std::min(slices, (chunk + 1) * size)); });
}

/// Place of the first of a node's six values.
std::size_t DiagonalAt(std::uint32_t i) {
  return std::size_t{i / kSliceNodes} * 6 * kSliceNodes + i % kSliceNodes;
}
/// Place of the first of an entry's six values.
std::size_t OffDiagonalAt(std::size_t entry) {
  return entry / kSliceNodes * 6 * kSliceNodes + entry % kSliceNodes;
}

Symmetric3 ReadSymmetric(const float* values, std::size_t stride) {
  Symmetric3 m;
  for (std::size_t i = 0; i < 6; ++i) m[i] = static_cast<double>(values[i * stride]);
  return m;
}

/// to += scale link, six values kStride apart.
template <std::size_t kStride>
inline void AddLink(const LinkLevel& level, std::size_t entry, float scale, float* to) noexcept {
  const std::array<float, 6> link = level.Link(entry, true);
  for (std::size_t v = 0; v < 6; ++v) to[v * kStride] += scale * link[v];
}

/// Which nodes are held or have a held neighbour: few are.
void MarkNearHeld(LinkLevel& level) noexcept {
  std::fill(level.near_held.begin(), level.near_held.end(), std::uint8_t{0});
  const std::uint32_t n = level.Size();
  for (std::uint32_t i = 0; i < n; ++i) {
    if (level.is_free[i] != 0.0f) continue;
    level.near_held[i] = 1;
    for (std::uint32_t h = 0; h < level.layout->RowSteps(i); ++h)
      level.near_held[level.layout->others[level.layout->Entry(i, h)]] = 1;
  }
}

/// Copies the links, known in the rows of their lower nodes, into those of the upper ones.
void MirrorLinks(const LevelTopology& topology, LinkLevel& level, std::uint32_t first_slice,
                 std::uint32_t last_slice) noexcept {
  const SliceLayout& layout = topology.layout;
  const std::size_t last = std::size_t{layout.starts[last_slice]} * kSliceNodes;
  const std::uint32_t* const mirror = topology.mirror_entry.data();
  float* const links = level.links.data();
  for (std::size_t entry = std::size_t{layout.starts[first_slice]} * kSliceNodes; entry < last; ++entry) {
    if (mirror[entry] == LevelTopology::kNoEntry) continue;
    const float* const from = links + OffDiagonalAt(mirror[entry]);
    float* const to = links + OffDiagonalAt(entry);
    for (std::size_t v = 0; v < 6; ++v) to[v * kSliceNodes] = from[v * kSliceNodes];
  }
}
}  // namespace

void LinkLevel::SetLayout(const SliceLayout& of) {
  layout = &of;
  const std::size_t padded = of.PaddedNodes(), entries = of.Steps() * kSliceNodes;
  links.assign(link_floats * entries, 0.0f);
  diagonal_excess.assign(6 * padded, 0.0f), inverse.assign(6 * padded, 0.0f), is_free.assign(padded, 0.0f);
  x.assign(padded, {}), b.assign(padded, {}), r.assign(padded, {});
  near_held.assign(of.node_count, 0);
  elements.Clear();
}

void LinkLevel::Reserve(const LevelCapacity& capacity) {
  const auto [nodes, steps] = capacity;
  near_held.reserve(nodes);
  links.reserve(link_floats * steps * kSliceNodes);
  for (auto* blocks : {&diagonal_excess, &inverse}) blocks->reserve(6 * nodes);
  is_free.reserve(nodes);
  for (auto* vector : {&x, &b, &r}) vector->reserve(nodes);
  elements.Reserve();
}

LinkMatrix LinkLevel::Matrix() const {
  return {layout->Table(), links.data(),   link_floats, diagonal_excess.data(),
          inverse.data(),  is_free.data(), nullptr};
}

void RunPass(const Kernels& kernels, Workers& workers, const LinkLevel& level, LinkPass pass, const Float4* x,
             const Float4* b, float factor, Float4* out, const float* follower) noexcept {
  LinkMatrix matrix = level.Matrix();
  matrix.follower = follower;
  ForEachSliceChunk(workers, level.layout->Slices(), [&](std::uint32_t first, std::uint32_t last) {
    kernels.multiply(matrix, pass, x, b, factor, out, first, last);
  });
}

LinkHierarchy::LinkHierarchy(const HierarchyTopology& topology, const NodeGraph& graph, double spare_share) {
  const std::vector<LevelCapacity> capacities = CalcLevelCapacities(topology, spare_share);
  levels_.reserve(kMaxLevels);
  levels_.resize(capacities.size());
  levels_.front().link_floats = kSpringLinkFloats;
  for (std::size_t at = 0; at < capacities.size(); ++at) levels_[at].Reserve(capacities[at]);
  constexpr std::size_t kMostUnknowns = 3 * kDirectNodes;
  for (auto* matrix : {&factor_, &rows_}) matrix->reserve(kMostUnknowns * kMostUnknowns);
  inverse_.reserve(kMostUnknowns * kMostUnknowns);
  coarsened_nodes_.reserve(ElementArrays::kNodeCapacity);
  less_elements_.resize(topology.levels.front().layout.PaddedNodes());
  SetTopology(topology, graph);
  if (spare_share > 0.0) line_smoother_.Reserve(spare_share);
}

void LinkHierarchy::SetTopology(const HierarchyTopology& topology, const NodeGraph& graph) {
  topology_ = &topology;
  if (levels_.size() < topology.level_count) levels_.resize(topology.level_count);
  for (std::size_t at = 0; at < topology.level_count; ++at) levels_[at].SetLayout(topology.levels[at].layout);
  line_smoother_.SetGraph(graph, topology.levels.front().layout);
  is_inverted_ = false;
  const std::size_t unknowns = Coarsest().Size() <= kDirectNodes ? 3 * std::size_t{Coarsest().Size()} : 0;
  factor_.resize(unknowns * unknowns);
  rows_.resize(unknowns * unknowns);
  inverse_.resize(unknowns * unknowns);
}

/// Each chunk of aggregates gathers from its members, one after the other: no two threads write the same number, and
/// sums do not depend on who forms them. A link is gathered by the lower of its two aggregates, and copied to the other.
void LinkHierarchy::Coarsen(Workers& workers, std::size_t at) noexcept {
  const LevelTopology& transfer = topology_->levels[at];
  LinkLevel& level = levels_[at];
  LinkLevel& next = levels_[at + 1];
  MarkNearHeld(level);
  const std::uint32_t slices = next.layout->Slices(), size = CoarseChunkSize(slices);
  workers.Run((slices + size - 1) / size, [&](std::uint32_t chunk) {
    const std::uint32_t first = chunk * size, last = std::min(slices, first + size);
    constexpr std::size_t kBlock = 6 * kSliceNodes;
    std::fill(next.links.begin() + static_cast<std::ptrdiff_t>(kBlock * next.layout->starts[first]),
              next.links.begin() + static_cast<std::ptrdiff_t>(kBlock * next.layout->starts[last]), 0.0f);
    const std::uint32_t end = std::min(next.Size(), last * kSliceNodes);
    for (std::uint32_t a = first * kSliceNodes; a < end; ++a) GatherDiagonal(at, a);
    const float* const is_free = level.is_free.data();
    const std::uint8_t* const near_held = level.near_held.data();
    float* const coarse_links = next.links.data();
    const std::uint32_t* const others = level.layout->others.data();
    for (const CoarsenedLink& link :
         std::span(transfer.coarsened)
             .subspan(transfer.coarsened_starts[chunk],
                      transfer.coarsened_starts[chunk + 1] - transfer.coarsened_starts[chunk])) {
      if (near_held[link.node] != 0 && (is_free[link.node] == 0.0f || is_free[others[link.entry]] == 0.0f))
        continue;
      AddLink<kSliceNodes>(level, link.entry, static_cast<float>(kCoarseLinkScale),
                           coarse_links + OffDiagonalAt(link.coarse_entry));
    }
  });
  workers.Run((slices + size - 1) / size, [&](std::uint32_t chunk) {
    MirrorLinks(topology_->levels[at + 1], next, chunk * size, std::min(slices, (chunk + 1) * size));
  });
}

/// The diagonal excess of an aggregate: that of its members, and their links to held nodes.
void LinkHierarchy::GatherDiagonal(std::size_t at, std::uint32_t aggregate) noexcept {
  const LevelTopology& transfer = topology_->levels[at];
  const LinkLevel& level = levels_[at];
  LinkLevel& next = levels_[at + 1];
  float excess[6] = {}, is_free = 0.0f;
  for (auto m = transfer.member_starts[aggregate]; m < transfer.member_starts[aggregate + 1]; ++m) {
    const std::uint32_t i = transfer.members[m];
    if (level.is_free[i] == 0.0f) continue;
    is_free = 1.0f;
    for (std::size_t v = 0; v < 6; ++v) excess[v] += level.diagonal_excess[DiagonalAt(i) + v * kSliceNodes];
    if (level.near_held[i] == 0) continue;
    for (std::uint32_t h = 0; h < level.layout->RowSteps(i); ++h) {
      const std::size_t entry = level.layout->Entry(i, h);
      if (level.layout->others[entry] == i) break;
      if (level.is_free[level.layout->others[entry]] == 0.0f) AddLink<1>(level, entry, 1.0f, excess);
    }
  }
  next.is_free[aggregate] = is_free;
  for (std::size_t v = 0; v < 6; ++v)
    next.diagonal_excess[DiagonalAt(aggregate) + v * kSliceNodes] = excess[v];
}

void LinkHierarchy::UpdateCoarse(const Kernels& kernels, Workers& workers) noexcept {
  const std::span<const std::uint32_t> element_nodes = levels_.front().elements.Firm().Nodes();
  coarsened_nodes_.assign(element_nodes.begin(), element_nodes.end());
  for (std::size_t at = 0; at + 1 < topology_->level_count; ++at) {
    LinkLevel &level = levels_[at], &next = levels_[at + 1];
    level.elements.SwapDiagonal(level.diagonal_excess);  // they are coarsened apart
    Coarsen(workers, at);
    level.elements.SwapDiagonal(level.diagonal_excess);
    level.elements.Firm().Coarsen(topology_->levels[at].aggregate, next.elements.Firm());
    next.elements.AddDiagonal(next.diagonal_excess);
    const LinkMatrix matrix = next.Matrix();
    ForEachSliceChunk(workers, next.layout->Slices(), [&](std::uint32_t first, std::uint32_t last) {
      kernels.invert_blocks(matrix, next.inverse.data(), first, last);
    });
  }
  if (!inverse_.empty()) InvertCoarsest();
}

/// K = L L^T, then K^-1 = L^-T L^-1, row by row.
void LinkHierarchy::InvertCoarsest() noexcept {
  const LinkLevel& level = Coarsest();
  const std::size_t n = 3 * level.Size();
  std::fill(factor_.begin(), factor_.end(), 0.0);
  const auto add = [&](std::uint32_t i, std::uint32_t j, const Symmetric3& m, double sign) {
    static constexpr std::size_t kAt[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) factor_[(3 * i + a) * n + 3 * j + b] += sign * m[kAt[a][b]];
    }
  };
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    if (level.is_free[i] == 0.0f) {
      add(i, i, {1, 0, 0, 1, 0, 1}, 1.0);
      continue;
    }
    add(i, i, ReadSymmetric(level.diagonal_excess.data() + DiagonalAt(i), kSliceNodes), 1.0);
    for (std::uint32_t step = 0; step < level.layout->RowSteps(i); ++step) {
      const std::size_t entry = level.layout->Entry(i, step);
      const std::uint32_t other = level.layout->others[entry];
      if (other == i) continue;
      const Symmetric3 link = ReadSymmetric(level.Link(entry).data(), 1);
      add(i, i, link, 1.0);
      if (level.is_free[other] != 0.0f) add(i, other, link, -1.0);
    }
  }
  // the elements in full, in the place of what the diagonal has of them
  level.elements.ForEachOwn([&](std::uint32_t node, const Symmetric3& own) { add(node, node, own, -1.0); });
  level.elements.Firm().ForEachBlock(
      [&](std::uint32_t i, std::uint32_t j, bool is_diagonal, const StiffnessBlock& block) {
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t b = 0; b < 3; ++b) {
            factor_[(3 * i + a) * n + 3 * j + b] += block[3 * a + b];
            if (!is_diagonal) factor_[(3 * j + b) * n + 3 * i + a] += block[3 * a + b];
          }
        }
      });
  // L^T in place, row by row; the diagonal as it was is kept beside it
  for (std::size_t j = 0; j < n; ++j) rows_[j] = factor_[j * n + j];
  is_inverted_ = true;
  for (std::size_t j = 0; j < n && is_inverted_; ++j) {
    double* const row = factor_.data() + j * n;
    double pivot = row[j];
    const double whole = rows_[j];
    // what nothing holds stays where it is
    if (!(pivot > 1e-9 * whole)) pivot = whole > 0.0 ? 1e9 * whole : 1.0;
    is_inverted_ = std::isfinite(pivot);
    const double root = std::sqrt(pivot);
    row[j] = root;
    for (std::size_t k = j + 1; k < n; ++k) row[k] /= root;
    for (std::size_t i = j + 1; i < n; ++i) {
      double* const below = factor_.data() + i * n;
      const double share = row[i];
      for (std::size_t k = i; k < n; ++k) below[k] -= share * row[k];
    }
  }
  // L^-1
  std::fill(rows_.begin(), rows_.end(), 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double* const row = rows_.data() + i * n;
    row[i] = 1.0;
    for (std::size_t k = 0; k < i; ++k) {
      const double* const above = rows_.data() + k * n;
      const double share = factor_[k * n + i];
      for (std::size_t c = 0; c <= k; ++c) row[c] -= share * above[c];
    }
    const double scale = 1.0 / factor_[i * n + i];
    for (std::size_t c = 0; c <= i; ++c) row[c] *= scale;
  }
  std::fill(factor_.begin(), factor_.end(), 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double* const row = rows_.data() + k * n;
    for (std::size_t i = 0; i <= k; ++i) {
      double* const to = factor_.data() + i * n;
      for (std::size_t c = 0; c <= k; ++c) to[c] += row[i] * row[c];
    }
  }
  for (std::size_t i = 0; i < n * n; ++i) inverse_[i] = static_cast<float>(factor_[i]);
}

void LinkHierarchy::SolveCoarsest(const Float4* b, Float4* x) const noexcept {
  const std::uint32_t nodes = Coarsest().Size();
  const std::size_t n = 3 * std::size_t{nodes};
  std::array<float, 3 * kDirectNodes> sum{};
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const float here[3] = {b[i].x, b[i].y, b[i].z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const row = inverse_.data() + (3 * i + axis) * n;
      for (std::size_t c = 0; c < n; ++c) sum[c] += here[axis] * row[c];
    }
  }
  for (std::uint32_t i = 0; i < nodes; ++i) x[i] = {sum[3 * i], sum[3 * i + 1], sum[3 * i + 2], 0.0f};
}

const Float4* LinkHierarchy::LessElements(const LinkLevel& level, const Float4* from,
                                          const Float4* b) noexcept {
  if (level.elements.IsEmpty()) return b;
  // a pass subtracts what links and diagonal do; the rest is taken off beforehand
  for (const std::uint32_t node : level.elements.Touched()) less_elements_[node] = {};
  level.elements.CompleteProduct(level.elements.Firm(), from, less_elements_.data());
  std::size_t touched = 0;
  const std::span<const std::uint32_t> nodes = level.elements.Touched();
  for (std::uint32_t i = 0; i < level.x.size(); ++i) {
    Float4& sum = less_elements_[i];
    if (touched < nodes.size() && nodes[touched] == i) {
      sum = {b[i].x - sum.x, b[i].y - sum.y, b[i].z - sum.z, 0.0f};
      ++touched;
    } else {
      sum = b[i];
    }
  }
  return less_elements_.data();
}

/// x = (from +) damped block Jacobi of b - K from, and on the finest level the line smoother on its chains instead.
///
/// \param from  nullptr for zero
void LinkHierarchy::Smooth(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* from,
                           const Float4* b, Float4* x) noexcept {
  const LinkLevel& level = levels_[at];
  const LinkMatrix matrix = level.Matrix();
  if (from != nullptr) b = LessElements(level, from, b);
  const LinkPass pass = from == nullptr ? LinkPass::kStart : LinkPass::kSmooth;
  const bool has_chains = at == 0 && !line_smoother_.Nodes().empty();
  const std::uint32_t slices = level.layout->Slices(), size = SliceChunkSize(slices), first = has_chains;
  workers.Run(first + (slices + size - 1) / size, [&](std::uint32_t chunk) {
    if (chunk < first) return line_smoother_.Solve(level, from, b);
    kernels.multiply(matrix, pass, from, b, kDamping, x, (chunk - first) * size,
                     std::min(slices, (chunk - first + 1) * size));
  });
  if (has_chains) line_smoother_.Add(from, kDamping, x);
}

void LinkHierarchy::Cycle(const Kernels& kernels, Workers& workers, std::size_t at, const Float4* b,
                          Float4* x) noexcept {
  LinkLevel& level = levels_[at];
  const bool is_last = at + 1 == topology_->level_count;
  if (is_last && is_inverted_) return SolveCoarsest(b, x);
  Smooth(kernels, workers, at, nullptr, b, level.x.data());
  if (is_last) {
    for (int sweep = 1; sweep < kCoarsestSweeps; ++sweep) {
      RunPass(kernels, workers, level, LinkPass::kSmooth, level.x.data(),
              LessElements(level, level.x.data(), b), kDamping, x);
      std::copy(x, x + level.x.size(), level.x.begin());
    }
    return;
  }
  RunPass(kernels, workers, level, LinkPass::kResidual, level.x.data(),
          LessElements(level, level.x.data(), b), 0.0f, level.r.data());
  LinkLevel& next = levels_[at + 1];
  const LevelTopology& transfer = topology_->levels[at];
  ForEachSliceChunk(workers, next.layout->Slices(), [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t a = first * kSliceNodes; a < std::min(next.Size(), last * kSliceNodes); ++a) {
      Float4 sum;
      for (auto m = transfer.member_starts[a]; m < transfer.member_starts[a + 1]; ++m) {
        const Float4& r = level.r[transfer.members[m]];
        sum.x += r.x, sum.y += r.y, sum.z += r.z, sum.w += r.w;
      }
      next.b[a] = sum;
    }
  });
  Cycle(kernels, workers, at + 1, next.b.data(), next.r.data());
  ForEachNodeChunk(workers, level.Size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    for (std::uint32_t i = first; i < last; ++i) {
      const std::uint32_t aggregate = transfer.aggregate[i];
      if (aggregate == Aggregation::kNone) continue;
      const Float4& coarse = next.r[aggregate];
      const float is_free = level.is_free[i];
      Float4& here = level.x[i];
      here.x += is_free * coarse.x, here.y += is_free * coarse.y, here.z += is_free * coarse.z,
          here.w += is_free * coarse.w;
    }
  });
  Smooth(kernels, workers, at, level.x.data(), b, x);
}

void LinkHierarchy::Apply(const Kernels& kernels, Workers& workers, const Float4* b, Float4* x) noexcept {
  Cycle(kernels, workers, 0, b, x);
}

}  // namespace trocar::tissue
