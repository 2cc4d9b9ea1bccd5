// SPDX-License-Identifier: Apache-2.0
#include "link_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trocar::tissue {
namespace {

/// Slices a thread takes at a time; fixed, so that results do not depend on the number of threads.
constexpr std::uint32_t kChunkSlices = 64;
/// A level this small is solved directly.
constexpr std::uint32_t kDirectNodes = 24;
/// Passes of pairwise joining for one level: up to 2^n nodes in an aggregate.
constexpr int kPairings = 2;
/// On coarse links [-]: an aggregate is about two nodes wide, over which a step is twice as steep as a slope.
constexpr double kCoarseLinkScale = 0.5;
/// Of block Jacobi [-]; eigenvalues of D^-1 K reach 2.
constexpr float kDamping = 0.65f;
/// Sweeps on a coarsest level that is too large for a direct solution: links are gone, so one would do.
constexpr int kCoarsestSweeps = 4;

/// Joins each node with the unjoined neighbour that it is most stiffly linked to.
/// \return (n) number of each node's aggregate, in order of first appearance
std::vector<std::uint32_t> JoinPairs(const NodeGraph& graph, std::span<const double> stiffness,
                                     std::uint32_t& count) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> aggregate(graph.Size(), kNone);
  count = 0;
  for (std::uint32_t i = 0; i < graph.Size(); ++i) {
    if (aggregate[i] != kNone) continue;
    aggregate[i] = count;
    std::uint32_t best = kNone;
    double most = 0;
    for (auto h = graph.starts[i]; h < graph.starts[i + 1]; ++h) {
      if (aggregate[graph.others[h]] == kNone && stiffness[h] > most)
        most = stiffness[h], best = graph.others[h];
    }
    if (best != kNone) aggregate[best] = count;
    ++count;
  }
  return aggregate;
}

/// Graph of the aggregates, with the sums of their links; rows in ascending order.
void MakeQuotient(const NodeGraph& graph, std::span<const double> stiffness,
                  std::span<const std::uint32_t> aggregate, std::uint32_t count, NodeGraph& quotient,
                  std::vector<double>& sums) {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> rows(count);
  for (std::uint32_t i = 0; i < graph.Size(); ++i) {
    for (auto h = graph.starts[i]; h < graph.starts[i + 1]; ++h) {
      const std::uint32_t other = aggregate[graph.others[h]];
      if (other != aggregate[i]) rows[aggregate[i]].emplace_back(other, stiffness[h]);
    }
  }
  quotient = {};
  sums.clear();
  quotient.starts.push_back(0);
  for (auto& row : rows) {
    std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0 && row[i].first == row[i - 1].first) {
        sums.back() += row[i].second;
      } else {
        quotient.others.push_back(row[i].first);
        sums.push_back(row[i].second);
      }
    }
    quotient.starts.push_back(static_cast<std::uint32_t>(quotient.others.size()));
  }
}

LinkLevel MakeLevel(const NodeGraph& graph) {
  LinkLevel level;
  level.layout = MakeSliceLayout(graph);
  const std::size_t padded = level.layout.PaddedNodes();
  level.links.resize(6 * level.layout.Steps() * kSliceNodes);
  level.ground.resize(6 * padded);
  level.inverse.resize(6 * padded);
  level.is_free.resize(padded);
  level.x.resize(padded), level.b.resize(padded), level.r.resize(padded);
  return level;
}

/// Place of the first of a node's six ground values.
std::size_t GroundAt(std::uint32_t i) {
  return std::size_t{i / kSliceNodes} * 6 * kSliceNodes + i % kSliceNodes;
}
/// Place of the first of an entry's six link values.
std::size_t LinkAt(std::size_t entry) {
  return entry / kSliceNodes * 6 * kSliceNodes + entry % kSliceNodes;
}

Symmetric3 ReadSymmetric(const std::vector<float>& values, std::size_t at) {
  Symmetric3 m;
  for (std::size_t i = 0; i < 6; ++i) m[i] = static_cast<double>(values[at + i * kSliceNodes]);
  return m;
}
void WriteSymmetric(const Symmetric3& m, std::vector<float>& values, std::size_t at) {
  for (std::size_t i = 0; i < 6; ++i) values[at + i * kSliceNodes] = static_cast<float>(m[i]);
}
void AddTo(const Symmetric3& m, double scale, std::vector<float>& values, std::size_t at) {
  for (std::size_t i = 0; i < 6; ++i) values[at + i * kSliceNodes] += static_cast<float>(scale * m[i]);
}

/// A spring's 3 x 3 matrix is (k - b) I + b u u^T; where it is compressed, b > k. Gives it k u u^T then.
void RemoveCompression(Symmetric3& link, double k) {
  const double across = 0.5 * (link[0] + link[3] + link[5] - k);
  if (across < 0.0) AddIsotropic(link, -across);
}

}  // namespace

LinkMatrix LinkLevel::Matrix() const {
  return {layout.Table(), links.data(), ground.data(), inverse.data(), is_free.data()};
}

void RunPass(const Kernels& kernels, Workers& workers, const LinkLevel& level, LinkPass pass, const Float4* x,
             const Float4* b, float factor, Float4* out) noexcept {
  const std::uint32_t slices = level.layout.Slices();
  const std::uint32_t chunk_slices = std::max(kChunkSlices, slices / Workers::kMaxChunks + 1);
  const LinkMatrix matrix = level.Matrix();
  workers.Run((slices + chunk_slices - 1) / chunk_slices, [&](std::uint32_t chunk) {
    kernels.multiply(matrix, pass, x, b, factor, out, chunk * chunk_slices,
                     std::min(slices, (chunk + 1) * chunk_slices));
  });
}

LinkHierarchy::LinkHierarchy(const NodeGraph& graph, std::span<const double> stiffness) {
  NodeGraph fine = graph;
  std::vector<double> weights(stiffness.begin(), stiffness.end());
  levels_.push_back(MakeLevel(fine));
  while (fine.Size() > kDirectNodes) {
    std::vector<std::uint32_t> aggregate(fine.Size());
    std::iota(aggregate.begin(), aggregate.end(), 0u);
    NodeGraph coarse = fine;
    std::vector<double> sums = weights;
    for (int pairing = 0; pairing < kPairings; ++pairing) {
      std::uint32_t count = 0;
      const auto pairs = JoinPairs(coarse, sums, count);
      NodeGraph quotient;
      std::vector<double> quotient_sums;
      MakeQuotient(coarse, sums, pairs, count, quotient, quotient_sums);
      for (std::uint32_t& a : aggregate) a = pairs[a];
      coarse = std::move(quotient);
      sums = std::move(quotient_sums);
    }
    if (10 * coarse.Size() > 9 * fine.Size()) break;  // hardly a link left
    levels_.push_back(MakeLevel(coarse));
    LinkLevel& level = levels_[levels_.size() - 2];
    const SliceLayout& next = levels_.back().layout;
    level.coarse_entry.assign(level.layout.Steps() * kSliceNodes, LinkLevel::kNoEntry);
    for (std::uint32_t i = 0; i < fine.Size(); ++i) {
      const std::uint32_t from = aggregate[i];
      for (auto h = fine.starts[i]; h < fine.starts[i + 1]; ++h) {
        const std::uint32_t to = aggregate[fine.others[h]];
        if (to == from) continue;
        const auto row = coarse.others.begin() + coarse.starts[from];
        const auto place = std::lower_bound(row, coarse.others.begin() + coarse.starts[from + 1], to) - row;
        level.coarse_entry[level.layout.Entry(i, h - fine.starts[i])] =
            static_cast<std::uint32_t>(next.Entry(from, static_cast<std::uint32_t>(place)));
      }
    }
    level.aggregate = std::move(aggregate);
    fine = std::move(coarse);
    weights = std::move(sums);
  }
  if (levels_.back().Size() <= kDirectNodes) {
    const std::size_t unknowns = 3 * levels_.back().Size();
    factor_.resize(unknowns * unknowns);
    right_.resize(unknowns);
  }
}

void LinkHierarchy::UpdateCoarse(std::size_t at, std::span<const float> stiffness) noexcept {
  LinkLevel& level = levels_[at];
  LinkLevel* const next = at + 1 < levels_.size() ? &levels_[at + 1] : nullptr;
  if (next != nullptr) {
    std::fill(next->links.begin(), next->links.end(), 0.0f);
    std::fill(next->ground.begin(), next->ground.end(), 0.0f);
    std::fill(next->is_free.begin(), next->is_free.end(), 0.0f);
  }
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    if (level.is_free[i] == 0.0f) {
      WriteSymmetric({}, level.inverse, GroundAt(i));
      continue;
    }
    Symmetric3 block = ReadSymmetric(level.ground, GroundAt(i));
    if (next != nullptr) {
      next->is_free[level.aggregate[i]] = 1.0f;
      AddTo(block, 1.0, next->ground, GroundAt(level.aggregate[i]));
    }
    const std::size_t first = level.layout.Entry(i, 0),
                      last = first + std::size_t{level.layout.RowSteps(i)} * kSliceNodes;
    const float* from = level.links.data() + LinkAt(first);
    for (std::size_t entry = first; entry < last; entry += kSliceNodes, from += 6 * kSliceNodes) {
      const std::uint32_t other = level.layout.others[entry];
      if (other == i) break;
      Symmetric3 link;
      for (std::size_t v = 0; v < 6; ++v) link[v] = static_cast<double>(from[v * kSliceNodes]);
      if (at == 0) RemoveCompression(link, static_cast<double>(stiffness[entry]));
      for (std::size_t v = 0; v < 6; ++v) block[v] += link[v];
      if (next == nullptr) continue;
      if (level.is_free[other] == 0.0f) {
        AddTo(link, 1.0, next->ground, GroundAt(level.aggregate[i]));
      } else if (const std::uint32_t coarse = level.coarse_entry[entry]; coarse != LinkLevel::kNoEntry) {
        AddTo(link, kCoarseLinkScale, next->links, LinkAt(coarse));
      }
    }
    WriteSymmetric(Invert(block), level.inverse, GroundAt(i));
  }
}

void LinkHierarchy::Update(std::span<const float> stiffness) noexcept {
  for (std::size_t at = 0; at < levels_.size(); ++at) UpdateCoarse(at, stiffness);
  if (!factor_.empty()) Factorise();
}

void LinkHierarchy::Factorise() noexcept {
  const LinkLevel& level = levels_.back();
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
    add(i, i, ReadSymmetric(level.ground, GroundAt(i)), 1.0);
    for (std::uint32_t step = 0; step < level.layout.RowSteps(i); ++step) {
      const std::size_t entry = level.layout.Entry(i, step);
      const std::uint32_t other = level.layout.others[entry];
      if (other == i) continue;
      const Symmetric3 link = ReadSymmetric(level.links, LinkAt(entry));
      add(i, i, link, 1.0);
      if (level.is_free[other] != 0.0f) add(i, other, link, -1.0);
    }
  }
  is_factorised_ = true;
  for (std::size_t j = 0; j < n && is_factorised_; ++j) {
    double pivot = factor_[j * n + j];
    const double whole = pivot;
    for (std::size_t k = 0; k < j; ++k) pivot -= factor_[j * n + k] * factor_[j * n + k];
    // what nothing holds stays where it is
    if (!(pivot > 1e-9 * whole)) pivot = whole > 0.0 ? 1e9 * whole : 1.0;
    is_factorised_ = std::isfinite(pivot);
    const double root = std::sqrt(pivot);
    factor_[j * n + j] = root;
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = factor_[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= factor_[i * n + k] * factor_[j * n + k];
      factor_[i * n + j] = sum / root;
    }
  }
}

void LinkHierarchy::SolveCoarsest() noexcept {
  LinkLevel& level = levels_.back();
  const std::size_t n = right_.size();
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    const Float4& b = level.b[i];
    right_[3 * i] = static_cast<double>(b.x), right_[3 * i + 1] = static_cast<double>(b.y);
    right_[3 * i + 2] = static_cast<double>(b.z);
  }
  for (std::size_t i = 0; i < n; ++i) {
    double sum = right_[i];
    for (std::size_t k = 0; k < i; ++k) sum -= factor_[i * n + k] * right_[k];
    right_[i] = sum / factor_[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    double sum = right_[i];
    for (std::size_t k = i + 1; k < n; ++k) sum -= factor_[k * n + i] * right_[k];
    right_[i] = sum / factor_[i * n + i];
  }
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    level.x[i] = {static_cast<float>(right_[3 * i]), static_cast<float>(right_[3 * i + 1]),
                  static_cast<float>(right_[3 * i + 2]), 0.0f};
  }
}

void LinkHierarchy::Cycle(const Kernels& kernels, Workers& workers, std::size_t at) noexcept {
  LinkLevel& level = levels_[at];
  if (at + 1 == levels_.size() && is_factorised_) return SolveCoarsest();
  RunPass(kernels, workers, level, LinkPass::kStart, nullptr, level.b.data(), kDamping, level.x.data());
  if (at + 1 == levels_.size()) {
    for (int sweep = 1; sweep < kCoarsestSweeps; ++sweep) {
      RunPass(kernels, workers, level, LinkPass::kSmooth, level.x.data(), level.b.data(), kDamping,
              level.r.data());
      std::swap(level.x, level.r);
    }
    return;
  }
  RunPass(kernels, workers, level, LinkPass::kResidual, level.x.data(), level.b.data(), 0.0f, level.r.data());
  LinkLevel& next = levels_[at + 1];
  std::fill(next.b.begin(), next.b.end(), Float4{});
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    Float4& sum = next.b[level.aggregate[i]];
    sum.x += level.r[i].x, sum.y += level.r[i].y, sum.z += level.r[i].z;
  }
  Cycle(kernels, workers, at + 1);
  for (std::uint32_t i = 0; i < level.Size(); ++i) {
    const Float4& coarse = next.x[level.aggregate[i]];
    const float is_free = level.is_free[i];
    level.x[i].x += is_free * coarse.x, level.x[i].y += is_free * coarse.y,
        level.x[i].z += is_free * coarse.z;
  }
  RunPass(kernels, workers, level, LinkPass::kSmooth, level.x.data(), level.b.data(), kDamping,
          level.r.data());
  std::swap(level.x, level.r);
}

void LinkHierarchy::Apply(const Kernels& kernels, Workers& workers, const Float4* b, Float4* x) noexcept {
  LinkLevel& finest = levels_.front();
  std::copy(b, b + finest.b.size(), finest.b.begin());
  Cycle(kernels, workers, 0);
  std::copy(finest.x.begin(), finest.x.end(), x);
}

}  // namespace trocar::tissue
