// SPDX-License-Identifier: Apache-2.0
#include "line_smoother.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "link_hierarchy.h"
#include "trocar/base/to_integer.h"

namespace trocar::tissue {
namespace {

/// A node of a chain has at most so many neighbours: two on either side, and one where it hangs on something. Most
/// nodes of a surface have six.
constexpr std::uint32_t kMostNeighbours = 5;
/// A chain's matrix is at most so many nodes wide: more is a surface.
constexpr std::uint32_t kWidest = 12;

/// Numbers of a row of its factor.
constexpr std::size_t kMostRow = 3 * (kWidest + 1);

/// Pivots below this part of the diagonal are not positive for sure [-].
constexpr double kLeastPivot = 1e-7;

std::size_t DiagonalAt(std::uint32_t i) {
  return std::size_t{i / kSliceNodes} * 6 * kSliceNodes + i % kSliceNodes;
}
/// Place of (row, column) among xx, xy, xz, yy, yz, zz.
constexpr std::size_t kAt[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

}  // namespace

/// Breadth-first order of the candidates that `root` is connected with, from the one found last, in chain_.
void LineSmoother::OrderChain(const NodeGraph& graph, std::uint32_t root, std::uint32_t round) {
  for (const std::uint32_t pass : {round, round + 1}) {
    chain_.assign(1, root);
    marks_[root] = pass;
    for (std::size_t at = 0; at < chain_.size(); ++at) {
      for (auto h = graph.starts[chain_[at]]; h < graph.starts[chain_[at] + 1]; ++h) {
        const std::uint32_t other = graph.others[h];
        if (!is_candidate_[other] || marks_[other] == pass) continue;
        marks_[other] = pass;
        chain_.push_back(other);
      }
    }
    root = chain_.back();  // an end of the chain
  }
}

void LineSmoother::SetGraph(const NodeGraph& graph, const SliceLayout& layout) {
  const std::uint32_t n = graph.Size();
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  nodes_.clear(), links_.clear(), first_.clear(), row_starts_.clear();
  is_factorised_ = false;
  is_candidate_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t neighbours = graph.starts[i + 1] - graph.starts[i];
    is_candidate_[i] = neighbours > 0 && neighbours <= kMostNeighbours;
  }
  place_.assign(n, kNone), marks_.assign(n, 0);
  chain_.reserve(n);
  for (std::uint32_t root = 0; root < n; ++root) {
    if (!is_candidate_[root]) continue;
    OrderChain(graph, root, 2 * root + 1);
    for (const std::uint32_t i : chain_) is_candidate_[i] = 0;
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t k = 0; k < chain_.size(); ++k) place_[chain_[k]] = first + k;
    std::uint32_t widest = 0;
    for (const std::uint32_t i : chain_) {
      for (auto h = graph.starts[i]; h < graph.starts[i + 1]; ++h) {
        const std::uint32_t other = place_[graph.others[h]];
        if (other != kNone && other < place_[i]) widest = std::max(widest, place_[i] - other);
      }
    }
    if (chain_.size() == 1 || widest > kWidest) {
      for (const std::uint32_t i : chain_) place_[i] = kNone;
    } else {
      nodes_.insert(nodes_.end(), chain_.begin(), chain_.end());
    }
  }
  row_starts_.push_back(0);
  for (std::uint32_t row = 0; row < nodes_.size(); ++row) {
    const std::uint32_t i = nodes_[row];
    std::uint32_t first = row;
    for (auto h = graph.starts[i]; h < graph.starts[i + 1]; ++h) {
      const std::uint32_t column = place_[graph.others[h]];
      if (column == kNone || column >= row) continue;
      first = std::min(first, column);
      links_.push_back({row, column, static_cast<std::uint32_t>(layout.Entry(i, h - graph.starts[i]))});
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      first_.push_back(3 * first);
      row_starts_.push_back(row_starts_.back() + 3 * (row - first) + axis + 1);
    }
  }
  column_starts_.assign(1, 0);
  for (std::size_t column = 0; column < first_.size(); ++column) {
    std::size_t last = std::min(column + kMostRow, first_.size());
    while (first_[last - 1] > column) --last;
    column_starts_.push_back(column_starts_.back() + last - column - 1);
  }
  columns_.assign(column_starts_.back(), 0.0f);
  factor_.resize(row_starts_.back());
  lower_.resize(row_starts_.back());
  whole_.resize(first_.size());
  values_.resize(3 * nodes_.size());
}

void LineSmoother::Reserve(double share) {
  // a cut leaves nodes with few neighbours: of so many nodes some join chains, as wide as chains may be
  const std::size_t nodes =
      nodes_.size() + base::TruncateTo<std::size_t>(share * static_cast<double>(marks_.size()));
  nodes_.reserve(nodes);
  links_.reserve(kMostNeighbours * nodes);
  first_.reserve(3 * nodes), row_starts_.reserve(3 * nodes + 1), values_.reserve(3 * nodes),
      whole_.reserve(3 * nodes);
  factor_.reserve(3 * kMostRow * nodes), lower_.reserve(3 * kMostRow * nodes);
  columns_.reserve(3 * kMostRow * nodes), column_starts_.reserve(3 * nodes + 1);
}

/// False where the matrix is not positive definite.
bool LineSmoother::FactoriseOnce(const LinkLevel& level, bool is_firm) noexcept {
  std::fill(factor_.begin(), factor_.end(), 0.0);
  for (std::size_t row = 0; row < nodes_.size(); ++row) {
    const std::uint32_t i = nodes_[row];
    std::array<double, 6> block = {1, 0, 0, 1, 0, 1};
    if (level.is_free[i] != 0.0f) {
      for (std::size_t v = 0; v < 6; ++v)
        block[v] = static_cast<double>(level.diagonal_excess[DiagonalAt(i) + v * kSliceNodes]);
      for (std::uint32_t step = 0; step < level.layout->RowSteps(i); ++step) {
        const std::size_t entry = level.layout->Entry(i, step);
        if (level.layout->others[entry] == i) break;
        const std::array<float, 6> link = level.Link(entry, is_firm);
        for (std::size_t v = 0; v < 6; ++v) block[v] += static_cast<double>(link[v]);
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) At(3 * row + a, 3 * row + b) = block[kAt[a][b]];
    }
  }
  for (const Link& link : links_) {
    if (level.is_free[nodes_[link.row]] == 0.0f || level.is_free[nodes_[link.column]] == 0.0f) continue;
    const std::array<float, 6> block = level.Link(link.entry, is_firm);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b)
        At(3 * link.row + a, 3 * link.column + b) -= static_cast<double>(block[kAt[a][b]]);
    }
  }
  for (std::size_t row = 0; row < first_.size(); ++row) whole_[row] = factor_[row_starts_[row + 1] - 1];
  // each column is taken from all that is right of it and below: sums do not wait for each other
  std::array<double, kMostRow> column;
  for (std::size_t j = 0; j < first_.size(); ++j) {
    double& pivot = factor_[row_starts_[j + 1] - 1];
    if (!(pivot > kLeastPivot * whole_[j]) || !std::isfinite(pivot)) return false;
    pivot = std::sqrt(pivot);
    const std::size_t last = std::min(j + kMostRow, first_.size());
    for (std::size_t i = j + 1; i < last; ++i) {
      column[i - j] = 0.0;
      if (first_[i] > j) continue;
      double* const row = factor_.data() + row_starts_[i];
      const double share = column[i - j] = row[j - first_[i]] /= pivot;
      double* const to = row + (j + 1 - first_[i]);
      for (std::size_t k = 0; k < i - j; ++k) to[k] -= share * column[k + 1];
    }
  }
  return true;
}

void LineSmoother::Factorise(const LinkLevel& level) noexcept {
  is_factorised_ = FactoriseOnce(level, false) || FactoriseOnce(level, true);
  if (!is_factorised_) return;
  for (std::size_t row = 0; row < first_.size(); ++row) {
    const std::size_t diagonal = row_starts_[row + 1] - 1;
    for (std::size_t at = row_starts_[row]; at < diagonal; ++at) lower_[at] = static_cast<float>(factor_[at]);
    lower_[diagonal] = static_cast<float>(1.0 / factor_[diagonal]);
    for (std::size_t column = first_[row]; column < row; ++column)
      columns_[column_starts_[column] + row - column - 1] = lower_[row_starts_[row] + column - first_[row]];
  }
}

void LineSmoother::Solve(const LinkLevel& level, const Float4* from, const Float4* b) noexcept {
  if (!is_factorised_) return;
  for (std::size_t row = 0; row < nodes_.size(); ++row) {
    const std::uint32_t i = nodes_[row];
    std::array<float, 3> r = {b[i].x, b[i].y, b[i].z};
    if (from != nullptr) {
      const auto subtract = [&](const float* m, std::size_t stride, float dx, float dy, float dz) {
        r[0] -= m[0] * dx + m[stride] * dy + m[2 * stride] * dz;
        r[1] -= m[stride] * dx + m[3 * stride] * dy + m[4 * stride] * dz;
        r[2] -= m[2 * stride] * dx + m[4 * stride] * dy + m[5 * stride] * dz;
      };
      const Float4& here = from[i];
      subtract(level.diagonal_excess.data() + DiagonalAt(i), kSliceNodes, here.x, here.y, here.z);
      for (std::uint32_t step = 0; step < level.layout->RowSteps(i); ++step) {
        const std::size_t entry = level.layout->Entry(i, step);
        const std::uint32_t other = level.layout->others[entry];
        if (other == i) break;
        const Float4& there = from[other];
        subtract(level.Link(entry).data(), 1, here.x - there.x, here.y - there.y, here.z - there.z);
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) values_[3 * row + axis] = level.is_free[i] * r[axis];
  }
  for (std::size_t column = 0; column < first_.size(); ++column) {
    const float* const below = columns_.data() + column_starts_[column];
    const std::size_t count = column_starts_[column + 1] - column_starts_[column];
    float* const to = values_.data() + column + 1;
    const float value = values_[column] *= lower_[row_starts_[column + 1] - 1];
    for (std::size_t k = 0; k < count; ++k) to[k] -= below[k] * value;
  }
  for (std::size_t row = first_.size(); row-- > 0;) {
    const float* const here = lower_.data() + row_starts_[row];
    const std::size_t first = first_[row];
    const float value = values_[row] *= here[row - first];
    for (std::size_t column = first; column < row; ++column) values_[column] -= here[column - first] * value;
  }
}

void LineSmoother::Add(const Float4* from, float factor, Float4* x) const noexcept {
  if (!is_factorised_) return;
  for (std::size_t row = 0; row < nodes_.size(); ++row) {
    const std::uint32_t i = nodes_[row];
    const Float4 start = from == nullptr ? Float4{} : from[i];
    x[i] = {start.x + factor * values_[3 * row], start.y + factor * values_[3 * row + 1],
            start.z + factor * values_[3 * row + 2], 0.0f};
  }
}

}  // namespace trocar::tissue
