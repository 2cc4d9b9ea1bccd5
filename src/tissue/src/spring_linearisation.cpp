// SPDX-License-Identifier: Apache-2.0
#include "spring_linearisation.h"

#include <algorithm>

#include "capacity.h"
#include "trocar/core/assert.h"
#include "trocar/tissue/spring_law.h"

namespace trocar::tissue {

SpringLinearisation::SpringLinearisation(const TissueModel& model, SlicedSprings& sliced,
                                         OrderedModel& ordered)
    : sliced_(&sliced), ordered_(&ordered) {
  SetModel(model);
}

void SpringLinearisation::SetModel(const TissueModel& model) {
  model_ = &model;
  linearised_ = model;
  ends_.assign(model.SpringCount(), {});
  factor_.assign(model.SpringCount(), 1.0);
  is_changed_.assign(model.SpringCount(), 0);
  changed_count_ = 0;
  unconstrained_.clear();
  elastic_.clear();
  const SlicedSprings& sliced = *sliced_;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    const std::size_t first = std::size_t{sliced.starts[i / kLanes]} * kLanes + i % kLanes;
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      const std::size_t place = first + std::size_t{h - model.spring_starts[i]} * kLanes;
      Ends& ends = ends_[half.spring];
      if (i < half.other) {
        ends.a = i, ends.half_a = h, ends.sliced_a = place;
      } else {
        ends.b = i, ends.half_b = h, ends.sliced_b = place;
      }
    }
  }
  unconstrained_.reserve(model.Size());
  for (std::uint32_t spring = 0; spring < model.SpringCount(); ++spring) {
    if (model.laws[model.spring_law[spring]].stiffening > 0.0) elastic_.push_back(spring);
  }
}

void SpringLinearisation::Reserve(double share) {
  ReserveMore(share, linearised_.half_springs, linearised_.half_strands, linearised_.spring_law, ends_,
              factor_, is_changed_, elastic_);
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
    const auto& half = model_->half_springs[ends_[spring].half_a];
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
    const Ends& ends = ends_[spring];
    const auto& half = model_->half_springs[ends.half_a];
    const auto& before = linearised_.half_springs[ends.half_a];
    const double length = math::Distance(state.position[ends.a], state.position[ends.b]);
    const TangentSpring next = CalcTangentSpring(model_->laws[model_->spring_law[spring]], factor_[spring],
                                                 half.stiffness, half.rest_length, length);
    const double tension = next.stiffness * (length - next.rest_length);
    error = std::fmax(error, std::fabs(tension - before.stiffness * (length - before.rest_length)));
    largest = std::fmax(largest, std::fabs(tension));
    if (next.stiffness != before.stiffness || next.rest_length != before.rest_length)
      SetTangent(spring, next.stiffness, next.rest_length);
  }
  return error > 0.0 ? error / largest : 0.0;
}

void SpringLinearisation::SetTangent(std::uint32_t spring, double stiffness, double rest_length) noexcept {
  const Ends& ends = ends_[spring];
  const auto& own = model_->half_springs[ends.half_a];
  const bool is_changed = stiffness != own.stiffness || rest_length != own.rest_length;
  changed_count_ += is_changed;
  changed_count_ -= is_changed_[spring];
  is_changed_[spring] = is_changed;
  for (const std::uint32_t h : {ends.half_a, ends.half_b}) {
    linearised_.half_springs[h].stiffness = stiffness;
    linearised_.half_springs[h].rest_length = rest_length;
    ordered_->stiffness[ordered_->spring_entries[h]] = stiffness;
    ordered_->rest_length[ordered_->spring_entries[h]] = rest_length;
  }
  for (const std::size_t place : {ends.sliced_a, ends.sliced_b}) {
    sliced_->stiffness[place] = stiffness;
    sliced_->stiffness_times_rest[place] = stiffness * rest_length;
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
