// SPDX-License-Identifier: Apache-2.0
#include "projected_preconditioner.h"

#include <algorithm>

#include "trocar/base/assert.h"
#include "trocar/math/small_solver.h"

namespace trocar::tissue {

using math::AlignedVector;

void ProjectedPreconditioner::SetModel(const OrderedModel& model) noexcept {
  TROCAR_ASSERT(model.layout.PaddedNodes() == model_->layout.PaddedNodes());
  model_ = &model;
  Invalidate();
}

void ProjectedPreconditioner::Prepare(std::size_t constraints) {
  TROCAR_ASSERT(constraints <= kMaxConstraints);
  const std::size_t padded = model_->layout.PaddedNodes();
  for (Constraint& c : std::span(storage_).first(constraints))
    c.gradient.resize(padded), c.preconditioned_gradient.resize(padded);
}

void ProjectedPreconditioner::SetActive(const ConstraintSet* set) noexcept {
  const std::size_t count_before = active_.size();
  std::size_t count = 0;
  for (std::size_t index = 0; set != nullptr && index < set->Nodes().size(); ++index) {
    if (!set->IsActive(index)) continue;
    Constraint& c = storage_[count++];
    has_preconditioned_ = has_preconditioned_ && c.index == index;
    c.index = index;
  }
  active_ = std::span(storage_).first(count);
  has_preconditioned_ = has_preconditioned_ && count == count_before;
  multipliers_.fill(0.0);
}

void ProjectedPreconditioner::TakeGradient(std::size_t active, const ConstraintSet& set,
                                           const OrderedLoad& load) noexcept {
  Constraint& c = active_[active];
  std::fill(c.gradient.begin(), c.gradient.end(), Float4{});
  const ConstraintSet::NodeRange nodes = set.Nodes()[c.index];
  const auto gradient = set.Gradient().subspan(nodes.first_node, nodes.node_count);
  for (std::uint32_t k = 0; k < nodes.node_count; ++k) {
    const std::uint32_t i = model_->new_of_old[nodes.first_node + k];
    if (load.is_free[i]) c.gradient[i] = ToFloat(gradient[k]);
  }
}

void ProjectedPreconditioner::PreconditionGradients(const Kernels& kernels, Workers& workers) noexcept {
  if (!has_preconditioned_) {
    for (Constraint& c : active_)
      hierarchy_->Apply(kernels, workers, c.gradient.data(), c.preconditioned_gradient.data());
    has_preconditioned_ = true;
  }
  for (std::size_t row = 0; row < active_.size(); ++row)
    gram_[row] = CalcDots(kernels, workers, &Constraint::preconditioned_gradient, active_[row].gradient);
}

ProjectedPreconditioner::SmallVector ProjectedPreconditioner::CalcDots(
    const Kernels& kernels, Workers& workers, AlignedVector<Float4> Constraint::*part,
    const AlignedVector<Float4>& v) const noexcept {
  std::array<SmallVector, Workers::kMaxChunks> parts;
  const std::uint32_t chunks =
      ForEachNodeChunk(workers, v.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t chunk) {
        for (std::size_t c = 0; c < active_.size(); ++c)
          parts[chunk][c] = kernels.vectors.dot((active_[c].*part).data(), v.data(), first, last);
      });
  SmallVector sums{};
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
    for (std::size_t c = 0; c < active_.size(); ++c) sums[c] += parts[chunk][c];
  }
  return sums;
}

void ProjectedPreconditioner::Subtract(const Kernels& kernels, const SmallVector& shares,
                                       AlignedVector<Float4> Constraint::*part, AlignedVector<Float4>& from,
                                       std::uint32_t first, std::uint32_t last) const noexcept {
  for (std::size_t c = 0; c < active_.size(); ++c) {
    kernels.vectors.add_scaled(static_cast<float>(-shares[c]), (active_[c].*part).data(), from.data(), first,
                               last);
  }
}

void ProjectedPreconditioner::ProjectResidual(const Kernels& kernels, Workers& workers,
                                              AlignedVector<Float4>& r) noexcept {
  if (active_.empty()) return;
  SmallMatrix transposed = gram_;
  for (std::size_t row = 0; row < active_.size(); ++row) {
    for (std::size_t column = 0; column < active_.size(); ++column)
      transposed[row][column] = gram_[column][row];
  }
  SmallVector share{};
  math::SolveSmall<math::Pivots::kNone>(
      transposed, CalcDots(kernels, workers, &Constraint::preconditioned_gradient, r), active_.size(), share);
  ForEachNodeChunk(workers, r.size(), [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
    Subtract(kernels, share, &Constraint::gradient, r, first, last);
  });
  for (std::size_t c = 0; c < active_.size(); ++c) multipliers_[c] += share[c];
}

DotAndLongest ProjectedPreconditioner::Apply(const Kernels& kernels, Workers& workers,
                                             AlignedVector<Float4>& r, AlignedVector<Float4>& z) noexcept {
  ProjectResidual(kernels, workers, r);
  hierarchy_->Apply(kernels, workers, r.data(), z.data());
  if (active_.empty()) return CalcDotAndLongest(kernels, workers, r, z);
  SmallVector share{};
  math::SolveSmall<math::Pivots::kNone>(gram_, CalcDots(kernels, workers, &Constraint::gradient, z),
                                        active_.size(), share);
  return CalcDotAndLongest(kernels, workers, r, z, [&](std::uint32_t first, std::uint32_t last) {
    Subtract(kernels, share, &Constraint::preconditioned_gradient, z, first, last);
  });
}

}  // namespace trocar::tissue
