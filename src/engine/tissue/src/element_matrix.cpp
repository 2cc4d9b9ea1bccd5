// SPDX-License-Identifier: Apache-2.0
#include "element_matrix.h"

#include <algorithm>
#include <utility>

#include "aggregation.h"

namespace trocar::tissue {
namespace {

/// What is left of an element's stiffness when one aggregate has all of its nodes, over the sum of its parts [-]: below, rounding.
constexpr double kNothingLeft = 1e-9;

/// Place of the first of a node's six values.
std::size_t DiagonalAt(std::uint32_t node) {
  return std::size_t{node / kSliceNodes} * 6 * kSliceNodes + node % kSliceNodes;
}

StiffnessBlock Transposed(const StiffnessBlock& block) noexcept {
  return {block[0], block[3], block[6], block[1], block[4], block[7], block[2], block[5], block[8]};
}

void AddTo(StiffnessBlock& to, const StiffnessBlock& block) noexcept {
  for (std::size_t v = 0; v < block.size(); ++v) to[v] += block[v];
}

struct Vector {
  double x = 0, y = 0, z = 0;
};

}  // namespace

void ElementMatrix::Reserve() {
  elements_.reserve(ElementArrays::kElementCapacity);
  nodes_.reserve(ElementArrays::kNodeCapacity);
  blocks_.reserve(ElementArrays::kBlockCapacity);
}

void ElementMatrix::Clear() noexcept {
  elements_.clear(), nodes_.clear(), blocks_.clear();
}

void ElementMatrix::Coarsen(std::span<const std::uint32_t> aggregate, ElementMatrix& coarse) const noexcept {
  coarse.Clear();
  for (const Element& element : elements_) {
    const auto first_node = static_cast<std::uint32_t>(coarse.nodes_.size());
    const auto first_block = static_cast<std::uint32_t>(coarse.blocks_.size());
    // the place of each node's aggregate among those of the element
    std::array<std::uint32_t, kMaxElementNodes> place;
    for (std::uint32_t i = 0; i < element.count; ++i) {
      const std::uint32_t to = aggregate[nodes_[element.first_node + i]];
      const auto begin = coarse.nodes_.begin() + first_node;
      const auto known = std::find(begin, coarse.nodes_.end(), to);
      place[i] = to == Aggregation::kNone ? Aggregation::kNone : static_cast<std::uint32_t>(known - begin);
      if (to != Aggregation::kNone && known == coarse.nodes_.end()) coarse.nodes_.push_back(to);
    }
    const auto count = static_cast<std::uint32_t>(coarse.nodes_.size()) - first_node;
    if (count == 0) continue;
    coarse.blocks_.insert(coarse.blocks_.end(), std::size_t{count} * (count + 1) / 2, StiffnessBlock{});
    const auto block_at = [&](std::uint32_t i, std::uint32_t j) -> StiffnessBlock& {
      return coarse.blocks_[first_block + i * count - i * (i + 1) / 2 + j];
    };
    double whole = 0;
    std::uint32_t at = element.first_block;
    for (std::uint32_t i = 0; i < element.count; ++i) {
      for (std::uint32_t j = i; j < element.count; ++j, ++at) {
        const StiffnessBlock& block = blocks_[at];
        if (i == j) whole += CalcTrace(block);
        const std::uint32_t a = place[i], b = place[j];
        if (a == Aggregation::kNone || b == Aggregation::kNone) continue;
        if (a == b) {
          AddTo(block_at(a, a), block);
          if (i != j) AddTo(block_at(a, a), Transposed(block));
        } else if (a < b) {
          AddTo(block_at(a, b), block);
        } else {
          AddTo(block_at(b, a), Transposed(block));
        }
      }
    }
    if (count == 1 && !(CalcTrace(block_at(0, 0)) > kNothingLeft * whole)) {
      coarse.nodes_.resize(first_node);
      coarse.blocks_.resize(first_block);
      continue;
    }
    coarse.elements_.push_back({first_node, first_block, count});
  }
}

void ElementMatrix::AddProduct(const Float4* x, Float4* out) const noexcept {
  for (const Element& element : elements_) {
    std::array<Vector, kMaxElementNodes> from, to{};
    for (std::uint32_t i = 0; i < element.count; ++i) {
      const Float4& v = x[nodes_[element.first_node + i]];
      from[i] = {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    }
    std::uint32_t at = element.first_block;
    for (std::uint32_t i = 0; i < element.count; ++i) {
      for (std::uint32_t j = i; j < element.count; ++j, ++at) {
        const StiffnessBlock& m = blocks_[at];
        const Vector& v = from[j];
        to[i].x += m[0] * v.x + m[1] * v.y + m[2] * v.z;
        to[i].y += m[3] * v.x + m[4] * v.y + m[5] * v.z;
        to[i].z += m[6] * v.x + m[7] * v.y + m[8] * v.z;
        if (i == j) continue;
        const Vector& u = from[i];
        to[j].x += m[0] * u.x + m[3] * u.y + m[6] * u.z;
        to[j].y += m[1] * u.x + m[4] * u.y + m[7] * u.z;
        to[j].z += m[2] * u.x + m[5] * u.y + m[8] * u.z;
      }
    }
    for (std::uint32_t i = 0; i < element.count; ++i) {
      Float4& sum = out[nodes_[element.first_node + i]];
      sum.x += static_cast<float>(to[i].x), sum.y += static_cast<float>(to[i].y);
      sum.z += static_cast<float>(to[i].z);
    }
  }
}

void LevelElements::Reserve() {
  firm_.Reserve();
  touched_.reserve(ElementArrays::kNodeCapacity);
  own_.reserve(ElementArrays::kNodeCapacity);
  replaced_.reserve(ElementArrays::kNodeCapacity);
}

void LevelElements::Clear() noexcept {
  firm_.Clear();
  touched_.clear(), own_.clear(), replaced_.clear();
}

void LevelElements::AddDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept {
  touched_.assign(firm_.Nodes().begin(), firm_.Nodes().end());
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  own_.assign(touched_.size(), {});
  firm_.ForEachBound([&](std::uint32_t node, const std::array<double, 6>& share) {
    const auto at = std::lower_bound(touched_.begin(), touched_.end(), node) - touched_.begin();
    for (std::size_t v = 0; v < 6; ++v) own_[static_cast<std::size_t>(at)][v] += share[v];
  });
  replaced_.resize(touched_.size());
  for (std::size_t t = 0; t < touched_.size(); ++t) {
    for (std::size_t v = 0; v < 6; ++v) {
      float& value = diagonal_excess[DiagonalAt(touched_[t]) + v * kSliceNodes];
      replaced_[t][v] = value;
      value = static_cast<float>(static_cast<double>(value) + own_[t][v]);
      // what the diagonal has of them, rounding included
      own_[t][v] = static_cast<double>(value) - static_cast<double>(replaced_[t][v]);
    }
  }
}

void LevelElements::RemoveDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept {
  SwapDiagonal(diagonal_excess);
  Clear();
}

void LevelElements::SwapDiagonal(math::AlignedVector<float>& diagonal_excess) noexcept {
  for (std::size_t t = 0; t < touched_.size(); ++t) {
    for (std::size_t v = 0; v < 6; ++v)
      std::swap(diagonal_excess[DiagonalAt(touched_[t]) + v * kSliceNodes], replaced_[t][v]);
  }
}

void LevelElements::CompleteProduct(const ElementMatrix& matrix, const Float4* x,
                                    Float4* out) const noexcept {
  matrix.AddProduct(x, out);
  for (std::size_t t = 0; t < touched_.size(); ++t) {
    const Float4& v = x[touched_[t]];
    const double vx = static_cast<double>(v.x), vy = static_cast<double>(v.y), vz = static_cast<double>(v.z);
    const std::array<double, 6>& m = own_[t];
    Float4& sum = out[touched_[t]];
    sum.x -= static_cast<float>(m[0] * vx + m[1] * vy + m[2] * vz);
    sum.y -= static_cast<float>(m[1] * vx + m[3] * vy + m[4] * vz);
    sum.z -= static_cast<float>(m[2] * vx + m[4] * vy + m[5] * vz);
  }
}

}  // namespace trocar::tissue
