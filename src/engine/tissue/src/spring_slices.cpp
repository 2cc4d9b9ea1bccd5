// SPDX-License-Identifier: Apache-2.0
#include "spring_slices.h"

#include <algorithm>
#include <cmath>

#include "node_vectors.h"
#include "trocar/base/spare_capacity.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Slices a thread takes at a time; fixed.
constexpr std::uint32_t kChunkSlices = 64;
/// Iterations that follow each other through the mesh: their springs must stay in a processor's second cache.
constexpr std::size_t kFollowing = 4;
/// Slices by which each goes on before the next one follows.
constexpr std::uint32_t kStride = 32;
constexpr std::size_t kSpringFloats = 5 * kSliceNodes;

/// Steps whose neighbours can be looked up, of all, from which on lookups pay for storing twice what the other
/// steps read [-].
constexpr double kLookupShare = 0.75;

/// The lookup of one step of the slice that begins at node `first`.
SliceLookup FindLookup(const std::uint32_t* others, std::uint32_t first) {
  SliceLookup lookup = {};
  std::uint32_t count = 0;
  for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) {
    if (others[lane] == first + lane) continue;  // padding reads anything
    const std::uint32_t slice = others[lane] / kSliceNodes;
    std::uint32_t at = 0;
    while (at < count && lookup.slices[at] != slice) ++at;
    if (at == kLookupSlices) return {};
    if (at == count) lookup.slices[count++] = slice;
    lookup.places[lane] = static_cast<std::uint8_t>(at * kSliceNodes + others[lane] % kSliceNodes);
  }
  lookup.pairs = std::max(1u, (count + 1) / 2);
  return lookup;
}

}  // namespace

void SpringSlices::SetModel(const OrderedModel& model) {
  layout_ = &model.layout;
  springs_.assign(layout_->Steps() * kSpringFloats, 0.0f);
  nodes_.assign(layout_->PaddedNodes() * 5, 0.0f);
  u_.assign(layout_->PaddedNodes(), {});
  previous_ = u_;
  u_by_slice_.assign(layout_->PaddedNodes() * 3, 0.0f);
  previous_by_slice_ = u_by_slice_;
  SetLookups();
  reach_ = 0;
  for (std::uint32_t slice = 0; slice < layout_->Slices(); ++slice) {
    for (std::size_t entry = std::size_t{layout_->starts[slice]} * kSliceNodes;
         entry < std::size_t{layout_->starts[slice + 1]} * kSliceNodes; ++entry) {
      const std::uint32_t other = layout_->others[entry] / kSliceNodes;
      reach_ = std::max(reach_, other > slice ? other - slice : slice - other);
    }
  }
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (std::uint32_t step = 0; step < layout_->RowSteps(i); ++step) {
      const std::size_t entry = layout_->Entry(i, step);
      float* const spring = springs_.data() + entry / kSliceNodes * kSpringFloats + entry % kSliceNodes;
      const Vec3 offset = model.rest[layout_->others[entry]] - model.rest[i];
      for (int axis = 0; axis < 3; ++axis) spring[axis * kSliceNodes] = static_cast<float>(offset[axis]);
    }
  }
}

void SpringSlices::SetLookups() {
  lookups_.clear();
  is_scattered_.assign(layout_->Slices(), 0);
  std::size_t found = 0;
  for (std::uint32_t slice = 0; slice < layout_->Slices(); ++slice) {
    for (std::size_t step = layout_->starts[slice]; step < layout_->starts[slice + 1]; ++step) {
      const std::uint32_t* const others = layout_->others.data() + step * kSliceNodes;
      lookups_.push_back(FindLookup(others, slice * kSliceNodes));
      if (lookups_.back().pairs > 0) {
        ++found;
        continue;
      }
      for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) is_scattered_[others[lane] / kSliceNodes] = 1;
    }
  }
  has_lookups_ = static_cast<double>(found) >= kLookupShare * static_cast<double>(lookups_.size());
  is_by_slice_ = false;
}

void SpringSlices::Reserve(const OrderedModel& like, double share) {
  const std::size_t steps = base::AddSpare(like.layout.Steps(), share);
  lookups_.reserve(steps);
  springs_.reserve(steps * kSpringFloats);
}

void SpringSlices::SetLoad(const OrderedModel& model, const OrderedSprings& springs, const OrderedLoad& load,
                           std::span<const std::uint8_t> strand_is_intact) noexcept {
  lowest_ = 1.0;
  smallest_shape_ = INFINITY;
  const auto spring_at = [&](std::size_t entry) {
    return springs_.data() + entry / kSliceNodes * kSpringFloats + entry % kSliceNodes;
  };
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (std::uint32_t step = 0; step < layout_->RowSteps(i); ++step) {
      const std::size_t entry = layout_->Entry(i, step);
      if (layout_->others[entry] == i) break;
      const double k = load.stiffness_scale * springs.stiffness[entry];
      float* const spring = spring_at(entry);
      spring[3 * kSliceNodes] = static_cast<float>(k);
      spring[4 * kSliceNodes] = static_cast<float>(k * springs.rest_length[entry]);
    }
  }
  for (const auto& strand : model.strands) {
    // A strand keeps its offset: a spring of no rest length about its rest offset. That its force is
    // k (rest + extent) then, not k extent, is put right in the load.
    spring_at(strand.entry)[3 * kSliceNodes] =
        strand_is_intact[strand.strand] ? static_cast<float>(load.stiffness_scale * strand.stiffness) : 0.0f;
  }
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    double sum = 0;
    for (std::uint32_t step = 0; step < layout_->RowSteps(i); ++step) {
      const std::size_t entry = layout_->Entry(i, step);
      if (layout_->others[entry] == i) break;
      sum += static_cast<double>(spring_at(entry)[3 * kSliceNodes]);
    }
    const double shape = load.shape_scale * model.shape[i], bound = 2.0 * sum + shape;
    float* const node = nodes_.data() + std::size_t{i / kSliceNodes} * 5 * kSliceNodes + i % kSliceNodes;
    for (int axis = 0; axis < 3; ++axis)
      node[axis * kSliceNodes] = static_cast<float>(load.constant[i][axis]);
    node[3 * kSliceNodes] = static_cast<float>(shape);
    const bool is_free = load.is_free[i] != 0 && bound > 0.0;
    node[4 * kSliceNodes] = is_free ? static_cast<float>(1.0 / bound) : 0.0f;
    if (!is_free) continue;
    lowest_ = std::min(lowest_, shape / bound);
    smallest_shape_ = std::min(smallest_shape_, shape);
  }
  for (const auto& strand : model.strands) {
    const double k = strand_is_intact[strand.strand] ? load.stiffness_scale * strand.stiffness : 0.0;
    AddForce(strand.node, -k * (model.rest[strand.other] - model.rest[strand.node]));
  }
}

void SpringSlices::AddForce(std::uint32_t node, const Vec3& force) noexcept {
  float* const values =
      nodes_.data() + std::size_t{node / kSliceNodes} * 5 * kSliceNodes + node % kSliceNodes;
  for (int axis = 0; axis < 3; ++axis) values[axis * kSliceNodes] += static_cast<float>(force[axis]);
}

void SpringSlices::SetDisplacement(std::uint32_t node, const Vec3& u) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = BySlice(node) + axis * kSliceNodes;
    u_by_slice_[at] = previous_by_slice_[at] = static_cast<float>(u[axis]);
  }
  u_[node] =
      previous_[node] = {static_cast<float>(u.x), static_cast<float>(u.y), static_cast<float>(u.z), 0.0f};
}

SliceStep SpringSlices::MakeStep(const Kernels& kernels, float omega, float damping, bool is_first,
                                 bool is_measured) noexcept {
  is_by_slice_ = has_lookups_ && kernels.looks_up;
  return {.table = layout_->Table(),
          .springs = springs_.data(),
          .nodes = nodes_.data(),
          .u = u_.data(),
          .previous = previous_.data(),
          .lookups = is_by_slice_ ? lookups_.data() : nullptr,
          .is_scattered = is_scattered_.data(),
          .u_by_slice = u_by_slice_.data(),
          .previous_by_slice = previous_by_slice_.data(),
          .omega = omega,
          .damping = damping,
          .is_first = is_first,
          .is_measured = is_measured};
}

void SpringSlices::SwapDisplacements() noexcept {
  std::swap(u_, previous_);
  std::swap(u_by_slice_, previous_by_slice_);
}

double SpringSlices::Step(const Kernels& kernels, Workers& workers, float omega, float damping, bool is_first,
                          bool is_measured) noexcept {
  const std::uint32_t slices = layout_->Slices();
  const std::uint32_t chunk_slices = std::max(kChunkSlices, slices / Workers::kMaxChunks + 1);
  const std::uint32_t chunks = (slices + chunk_slices - 1) / chunk_slices;
  std::array<float, Workers::kMaxChunks> largest2;
  const SliceStep step = MakeStep(kernels, omega, damping, is_first, is_measured);
  workers.Run(chunks, [&](std::uint32_t chunk) {
    largest2[chunk] =
        kernels.step_slices(step, chunk * chunk_slices, std::min(slices, (chunk + 1) * chunk_slices));
  });
  SwapDisplacements();
  float largest = 0;
  for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) largest = LargerOrNan(largest, largest2[chunk]);
  return std::sqrt(static_cast<double>(largest));
}

std::uint32_t SpringSlices::CountRanges(int threads) const {
  // at each edge a range leaves out kFollowing - 1 reaches at the most: at least half is left to be done together
  const auto most = static_cast<std::uint32_t>(layout_->Slices() / (4 * kFollowing * (reach_ + 1)));
  return std::min(static_cast<std::uint32_t>(threads), most);
}

double SpringSlices::Iterate(const Kernels& kernels, Workers& workers, std::span<const float> omegas,
                             float damping, bool is_first, bool is_measured) noexcept {
  const std::uint32_t ranges = CountRanges(workers.Threads());
  double residual = 0;
  for (std::size_t done = 0; done < omegas.size();) {
    const std::size_t some = ranges == 0 ? 1 : std::min(kFollowing, omegas.size() - done);
    std::array<SliceStep, kFollowing> steps;
    const bool is_last = done + some == omegas.size();
    if (some == 1) {
      residual = Step(kernels, workers, omegas[done], damping, is_first && done == 0, is_measured && is_last);
    } else {
      for (std::size_t k = 0; k < some; ++k) {
        steps[k] = MakeStep(kernels, omegas[done + k], damping, is_first && done + k == 0,
                            is_measured && is_last && k + 1 == some);
        SwapDisplacements();
      }
      residual = FollowEachOther(kernels, workers, std::span(steps).first(some), ranges);
    }
    done += some;
  }
  return residual;
}

/// Every iteration but the first stays so far behind the one before that all neighbours of its nodes are done, and at a
/// range's edges leaves out what needs the next range; that is caught up on when all ranges are done. An iteration
/// writes over the displacements of two before, which nobody needs by then.
double SpringSlices::FollowEachOther(const Kernels& kernels, Workers& workers,
                                     std::span<const SliceStep> steps, std::uint32_t ranges) noexcept {
  const std::uint32_t slices = layout_->Slices();
  const auto edge_of = [&](std::uint32_t range) { return slices / ranges * range; };
  std::array<float, 2 * Workers::kMaxChunks> largest2{};
  workers.Run(ranges, [&](std::uint32_t range) {
    const std::uint32_t begin = edge_of(range), end = range + 1 == ranges ? slices : edge_of(range + 1);
    std::array<std::uint32_t, kFollowing> done;  // slices before this are
    for (std::uint32_t k = 0; k < steps.size(); ++k) done[k] = begin == 0 ? 0 : begin + k * reach_;
    float largest = 0;
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (std::uint32_t k = 0; k < steps.size(); ++k) {
        const bool is_at_end = k == 0 || done[k - 1] == slices;
        const std::uint32_t before = k == 0 ? std::min(end, done[0] + kStride) : done[k - 1];
        const std::uint32_t until = is_at_end ? before : before - std::min(before, reach_);
        if (until <= done[k]) continue;
        largest = LargerOrNan(largest, kernels.step_slices(steps[k], done[k], until));
        done[k] = until;
        goes_on = true;
      }
    }
    largest2[range] = largest;
  });
  if (ranges > 1) {
    workers.Run(ranges - 1, [&](std::uint32_t range) {
      const std::uint32_t edge = edge_of(range + 1);
      float largest = 0;
      for (std::uint32_t k = 1; k < steps.size(); ++k)
        largest = LargerOrNan(largest, kernels.step_slices(steps[k], edge - k * reach_, edge + k * reach_));
      largest2[ranges + range] = largest;
    });
  }
  float largest = 0;
  for (const float part : largest2) largest = LargerOrNan(largest, part);
  return std::sqrt(static_cast<double>(largest));
}

double SpringSlices::LargestDisplacement() const noexcept {
  double largest2 = 0;
  for (std::uint32_t i = 0; i < layout_->node_count; ++i) {
    largest2 = std::max(largest2, math::SquaredNorm(GetDisplacement(i)));
  }
  return std::sqrt(largest2);
}

}  // namespace trocar::tissue
