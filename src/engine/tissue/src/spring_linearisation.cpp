// SPDX-License-Identifier: Apache-2.0
#include "spring_linearisation.h"

#include <algorithm>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/spare_capacity.h"
#include "trocar/tissue/spring_law.h"

namespace trocar::tissue {

void SpringLinearisation::SetModel(const TissueModel& model, const SolverModel& made) {
  if (model_ == nullptr) {
    const std::size_t springs = model.SpringCount(), entries = made.ordered.layout.Steps() * kSliceNodes;
    base::ReserveWithSpare(springs, spare_share_, factor_, is_changed_, elastic_);
    base::ReserveWithSpare(entries, spare_share_, ordered_.stiffness, ordered_.rest_length);
    unconstrained_.reserve(model.Size());
  }
  model_ = &model;
  made_ = &made;
  SetOrderedSprings(model, made.ordered, ordered_);
  if (nodewise_ != nullptr) {
    nodewise_->model = model;
    SetSlicedSprings(model, nodewise_->sliced);
  }
  factor_.assign(model.SpringCount(), 1.0);
  is_changed_.assign(model.SpringCount(), 0);
  changed_count_ = 0;
  unconstrained_.clear();
  elastic_.clear();
  for (std::uint32_t spring = 0; spring < model.SpringCount(); ++spring) {
    if (model.laws[model.spring_law[spring]].stiffening > 0.0) elastic_.push_back(spring);
  }
}

const LinearisedModel& SpringLinearisation::Nodewise() {
  if (nodewise_ != nullptr) return *nodewise_;
  nodewise_ = std::make_unique<LinearisedModel>();
  auto& [model, sliced] = *nodewise_;
  const std::size_t springs = model_->SpringCount();
  base::ReserveWithSpare(2 * springs, spare_share_, model.half_springs, sliced.others, sliced.stiffness,
                         sliced.stiffness_times_rest);
  base::ReserveWithSpare(springs, spare_share_, model.spring_law);
  model = *model_;
  SetSlicedSprings(*model_, sliced);
  for (std::uint32_t spring = 0; spring < springs; ++spring) {
    const std::size_t entry = made_->ordered.spring_entries[made_->ends[spring].half_a];
    if (is_changed_[spring]) SetNodewise(spring, ordered_.stiffness[entry], ordered_.rest_length[entry]);
  }
  return *nodewise_;
}

bool SpringLinearisation::UpdateFactors(const TissueState& state) noexcept {
  TROCAR_ASSERT(state.spring_factor.size() == factor_.size());
  bool has_changed = false, is_valid = true;
  for (std::uint32_t spring = 0; spring < factor_.size(); ++spring) {
    const double factor = state.spring_factor[spring];
    if (factor == factor_[spring]) continue;
    if (!(factor >= 0.0 && std::isfinite(factor))) {
      is_valid = false;
      continue;
    }
    factor_[spring] = factor;
    has_changed = true;
    const auto& half = model_->half_springs[made_->ends[spring].half_a];
    SetTangent(spring, factor * half.stiffness, half.rest_length);
  }
  if (has_changed) FindUnconstrained();
  return is_valid;
}

void SpringLinearisation::FindUnconstrained() noexcept {
  unconstrained_.clear();
  for (std::uint32_t i = 0; i < model_->Size(); ++i) {
    bool had_spring = false, has_spring = false;
    for (auto h = model_->spring_starts[i]; h < model_->spring_starts[i + 1]; ++h) {
      const auto& half = model_->half_springs[h];
      had_spring = had_spring || half.stiffness > 0.0;
      has_spring = has_spring || factor_[half.spring] * half.stiffness > 0.0;
    }
    if (had_spring && !has_spring && model_->shape_stiffness[i] == 0.0) unconstrained_.push_back(i);
  }
}

double SpringLinearisation::UpdateTangents(const TissueState& state) noexcept {
  double error = 0, largest = 0;
  for (const std::uint32_t spring : elastic_) {
    const SpringEnds& ends = made_->ends[spring];
    const auto& half = model_->half_springs[ends.half_a];
    const std::size_t entry = made_->ordered.spring_entries[ends.half_a];
    const double stiffness_before = ordered_.stiffness[entry], rest_before = ordered_.rest_length[entry];
    const double length = math::Distance(state.position[ends.a], state.position[ends.b]);
    const TangentSpring next = CalcTangentSpring(model_->laws[model_->spring_law[spring]], factor_[spring],
                                                 half.stiffness, half.rest_length, length);
    const double tension = next.stiffness * (length - next.rest_length);
    error = math::Max(error, std::fabs(tension - stiffness_before * (length - rest_before)));
    largest = math::Max(largest, std::fabs(tension));
    if (next.stiffness != stiffness_before || next.rest_length != rest_before)
      SetTangent(spring, next.stiffness, next.rest_length);
  }
  return error > 0.0 ? error / largest : 0.0;
}

void SpringLinearisation::SetTangent(std::uint32_t spring, double stiffness, double rest_length) noexcept {
  const SpringEnds& ends = made_->ends[spring];
  const auto& own = model_->half_springs[ends.half_a];
  const bool is_changed = stiffness != own.stiffness || rest_length != own.rest_length;
  changed_count_ += is_changed;
  changed_count_ -= is_changed_[spring];
  is_changed_[spring] = is_changed;
  for (const std::uint32_t h : {ends.half_a, ends.half_b}) {
    const std::size_t entry = made_->ordered.spring_entries[h];
    ordered_.stiffness[entry] = stiffness;
    ordered_.rest_length[entry] = rest_length;
  }
  if (nodewise_ != nullptr) SetNodewise(spring, stiffness, rest_length);
}

void SpringLinearisation::SetNodewise(std::uint32_t spring, double stiffness, double rest_length) noexcept {
  const SpringEnds& ends = made_->ends[spring];
  auto& [model, sliced] = *nodewise_;
  for (const auto& [node, h] : {std::pair{ends.a, ends.half_a}, std::pair{ends.b, ends.half_b}}) {
    model.half_springs[h].stiffness = stiffness;
    model.half_springs[h].rest_length = rest_length;
    const std::size_t step = std::size_t{sliced.starts[node / kLanes]} + h - model.spring_starts[node];
    const std::size_t place = step * kLanes + node % kLanes;
    sliced.stiffness[place] = stiffness;
    sliced.stiffness_times_rest[place] = stiffness * rest_length;
  }
}

void SpringLinearisation::Add(const SolveReport& outer_iteration, SolveReport& sum) noexcept {
  SolveReport next = outer_iteration;
  next.outer_iterations = sum.outer_iterations + 1;
  next.iterations += sum.iterations;
  next.coarse_levels = std::max(next.coarse_levels, sum.coarse_levels);
  next.linear_iterations += sum.linear_iterations;
  next.negative_curvatures += sum.negative_curvatures;
  next.local_solves += sum.local_solves;
  next.restarts += sum.restarts;
  sum = next;
}

}  // namespace trocar::tissue
