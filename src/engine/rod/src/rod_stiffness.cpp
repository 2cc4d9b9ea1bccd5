// SPDX-License-Identifier: Apache-2.0
#include "rod_stiffness.h"

#include <algorithm>
#include <cmath>

namespace trocar::rod {

using math::Vec3;

namespace {

/// Where the stiffness is not positive definite, so much of its largest diagonal entry is added to the diagonal at first [-], then
/// kMoreShift times more until it is.
constexpr double kFirstShift = 1e-11;
constexpr double kMoreShift = 10.0;
constexpr int kMaxShifts = 13;

}  // namespace

RodStiffness::RodStiffness(std::size_t nodes) : unknowns_(kNodeUnknowns * nodes) {
  band_.resize(unknowns_ * kBandWidth), factor_.resize(unknowns_ * kBandWidth);
  pulls_.reserve(kMaxPulls);
  responses_.resize(kMaxPulls * unknowns_);
  small_.resize(kMaxPulls * kMaxPulls), shares_.resize(kMaxPulls);
}

void RodStiffness::Clear() noexcept {
  std::fill(band_.begin(), band_.end(), 0.0);
  pulls_.clear();
}

void RodStiffness::AddPull(const RodPoint& a, const RodPoint& b, const Vec3& along,
                           double stiffness) noexcept {
  if (pulls_.size() < kMaxPulls && stiffness > 0.0) pulls_.push_back({a, b, along, stiffness});
}

/// The row and column of what is fixed become the identity's.
void RodStiffness::HoldFixed(std::span<const std::uint8_t> is_fixed) noexcept {
  for (std::size_t row = 0; row < unknowns_; ++row) {
    for (std::size_t column = row - std::min(row, kBandWidth - 1); column < row; ++column) {
      if (is_fixed[row] || is_fixed[column]) At(row, column) = 0.0;
    }
    if (is_fixed[row]) At(row, row) = 1.0;
  }
}

bool RodStiffness::Factor(std::span<const std::uint8_t> is_fixed, double unit_length) noexcept {
  HoldFixed(is_fixed);
  double largest = 0;
  for (std::size_t row = 0; row < unknowns_; ++row) {
    if (!is_fixed[row]) largest = math::Max(largest, At(row, row));
  }
  if (!(largest > 0.0)) largest = 1.0;
  double shift = 0;
  int tries = 0;
  for (; tries <= kMaxShifts; ++tries) {
    factor_ = band_;
    for (std::size_t row = 0; row < unknowns_; ++row) {
      const bool is_angle = row % kNodeUnknowns == 3;
      if (!is_fixed[row]) factor_[BandAt(row, row)] += is_angle ? shift * unit_length * unit_length : shift;
    }
    if (FactorBand(factor_)) break;
    shift = tries == 0 ? kFirstShift * largest : kMoreShift * shift;
  }
  FactorPulls(is_fixed);
  return tries == 0;
}

double RodStiffness::Project(const Pull& pull, std::span<const double> x) noexcept {
  const auto at = [x](const RodPoint& point, std::size_t axis) {
    return (1.0 - point.at) * x[PositionAt(point.segment) + axis] +
           point.at * x[PositionAt(point.segment + 1) + axis];
  };
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += pull.along[static_cast<int>(axis)] * (at(pull.a, axis) - at(pull.b, axis));
  return sum;
}

/// Sherman, Morrison and Woodbury: (B + U K U^T)^-1 by the small matrix K^-1 + U^T B^-1 U, here as its Cholesky factor.
void RodStiffness::FactorPulls(std::span<const std::uint8_t> is_fixed) noexcept {
  for (std::size_t j = 0; j < pulls_.size(); ++j) {
    const std::span<double> x = Response(j);
    std::fill(x.begin(), x.end(), 0.0);
    for (const auto& [point, sense] : {std::pair{pulls_[j].a, 1.0}, std::pair{pulls_[j].b, -1.0}}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double along = sense * pulls_[j].along[static_cast<int>(axis)];
        x[PositionAt(point.segment) + axis] += (1.0 - point.at) * along;
        x[PositionAt(point.segment + 1) + axis] += point.at * along;
      }
    }
    for (std::size_t i = 0; i < unknowns_; ++i) {
      if (is_fixed[i]) x[i] = 0.0;
    }
    SolveBand(factor_, x);
  }
  for (std::size_t i = 0; i < pulls_.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = Project(pulls_[i], Response(j)) + (i == j ? 1.0 / pulls_[i].stiffness : 0.0);
      for (std::size_t k = 0; k < j; ++k) sum -= small_[i * kMaxPulls + k] * small_[j * kMaxPulls + k];
      // what rounding leaves of a positive number
      const double least = 1e-3 / pulls_[i].stiffness;
      small_[i * kMaxPulls + j] = i == j ? std::sqrt(math::Max(sum, least)) : sum / small_[j * kMaxPulls + j];
    }
  }
}

void RodStiffness::Solve(std::span<double> x) noexcept {
  SolveBand(factor_, x);
  const std::size_t count = pulls_.size();
  for (std::size_t i = 0; i < count; ++i) {
    double sum = Project(pulls_[i], x);
    for (std::size_t k = 0; k < i; ++k) sum -= small_[i * kMaxPulls + k] * shares_[k];
    shares_[i] = sum / small_[i * kMaxPulls + i];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = i + 1; k < count; ++k) shares_[i] -= small_[k * kMaxPulls + i] * shares_[k];
    shares_[i] /= small_[i * kMaxPulls + i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const double> response = Response(i);
    for (std::size_t row = 0; row < unknowns_; ++row) x[row] -= shares_[i] * response[row];
  }
}

}  // namespace trocar::rod
