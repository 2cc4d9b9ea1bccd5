// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/linear_response.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/math/symmetric3.h"
#include "trocar/tissue/spring_law.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

using math::AddDirection;
using math::AddIsotropic;
using math::Invert;
using math::Symmetric3;

double SumOfProducts(std::span<const Vec3> a, std::span<const Vec3> b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += math::Dot(a[i], b[i]);
  return sum;
}

}  // namespace

void LinearResponse::SetModel(const TissueModel& model) {
  const std::size_t n = model.Size();
  model_ = &model;
  springs_.resize(model.half_springs.size());
  strands_.resize(model.half_strands.size());
  own_.resize(n), is_free_.resize(n), spring_block_.resize(n), inverse_.resize(n);
  for (auto* vector : {&residual_, &preconditioned_, &direction_, &product_}) vector->resize(n);
}

void LinearResponse::SetStiffness(const TissueState& state, const TissueLoad& load) noexcept {
  const TissueModel& model = *model_;
  TROCAR_ASSERT(state.position.size() == model.Size());
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    Symmetric3 block{};
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      const Vec3 along = state.position[half.other] - state.position[i];
      const double length = math::Norm(along);
      const TangentSpring line =
          CalcTangentSpring(model.laws[model.spring_law[half.spring]], state.spring_factor[half.spring],
                            half.stiffness, half.rest_length, length);
      const double stiffness = load.stiffness_scale * line.stiffness;
      const double across = length > 0.0 ? math::Max(0.0, 1.0 - line.rest_length / length) : 1.0;
      Link& link = springs_[h];
      link.isotropic = stiffness * across;
      link.along = length > 0.0 ? (std::sqrt(stiffness * (1.0 - across)) / length) * along : Vec3{};
      AddDirection(block, link.along, 1.0);
      AddIsotropic(block, link.isotropic);
    }
    spring_block_[i] = block;
    own_[i] = load.shape_scale * model.shape_stiffness[i];
    is_free_[i] = state.condition[i] != NodeCondition::kPrescribed;
    SetOwnBlock(i, state, load);
  }
}

/// Takes the node's strands, and with them all that holds it.
void LinearResponse::SetOwnBlock(std::uint32_t node, const TissueState& state,
                                 const TissueLoad& load) noexcept {
  const TissueModel& model = *model_;
  Symmetric3 block = spring_block_[node];
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
    const auto& half = model.half_strands[h];
    strands_[h] = state.strand_is_intact[half.strand] ? load.stiffness_scale * half.stiffness : 0.0;
    AddIsotropic(block, strands_[h]);
  }
  AddIsotropic(block, own_[node]);
  inverse_[node] = is_free_[node] ? Invert(block) : Symmetric3{};
}

void LinearResponse::FollowStrands(const TissueState& state, const TissueLoad& load) noexcept {
  const TissueModel& model = *model_;
  TROCAR_ASSERT(state.position.size() == model.Size());
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    if (model.strand_starts[i] < model.strand_starts[i + 1]) SetOwnBlock(i, state, load);
  }
}

void LinearResponse::Apply(std::span<const Vec3> u, std::span<Vec3> product) const noexcept {
  const TissueModel& model = *model_;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    Vec3 sum = own_[i] * u[i];
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const Vec3 apart = u[i] - u[model.half_springs[h].other];
      sum += springs_[h].isotropic * apart + math::Dot(springs_[h].along, apart) * springs_[h].along;
    }
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      sum += strands_[h] * (u[i] - u[model.half_strands[h].other]);
    }
    product[i] = is_free_[i] ? sum : Vec3{};
  }
}

LinearReport LinearResponse::Solve(std::span<const Vec3> force, int max_iterations, double tolerance,
                                   std::span<Vec3> response) noexcept {
  const std::size_t n = model_->Size();
  TROCAR_ASSERT(force.size() == n && response.size() == n);
  double force2 = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_free_[i]) response[i] = {};
    force2 += is_free_[i] ? math::SquaredNorm(force[i]) : 0.0;
  }
  LinearReport report;
  if (!(force2 > 0.0)) {
    std::fill(response.begin(), response.end(), Vec3{});
    return report;
  }
  Apply(response, product_);
  for (std::size_t i = 0; i < n; ++i) residual_[i] = is_free_[i] ? force[i] - product_[i] : Vec3{};
  // what is left of an earlier solve, were it a NaN, would survive the factor zero
  std::fill(direction_.begin(), direction_.end(), Vec3{});
  double before = 0;
  for (report.iterations = 0;; ++report.iterations) {
    report.residual = std::sqrt(SumOfProducts(residual_, residual_) / force2);
    if (report.residual <= tolerance || report.iterations == max_iterations) return report;
    for (std::size_t i = 0; i < n; ++i) preconditioned_[i] = Multiply(inverse_[i], residual_[i]);
    const double now = SumOfProducts(residual_, preconditioned_);
    const double beta = report.iterations == 0 ? 0.0 : now / before;
    for (std::size_t i = 0; i < n; ++i) direction_[i] = preconditioned_[i] + beta * direction_[i];
    Apply(direction_, product_);
    const double curvature = SumOfProducts(direction_, product_);
    if (!(curvature > 0.0)) return report;
    const double step = now / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      response[i] += step * direction_[i];
      residual_[i] -= step * product_[i];
    }
    before = now;
  }
}

}  // namespace trocar::tissue
