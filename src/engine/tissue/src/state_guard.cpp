// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/state_guard.h"

#include <algorithm>

#include "trocar/math/state_fields.h"

namespace trocar::tissue {

StateGuard::StateGuard(const TissueModel& model, double max_displacement)
    : model_(&model), max_displacement_(max_displacement), good_(model.rest) {}

GuardVerdict StateGuard::Check(TissueState& state, bool is_solve_finite) noexcept {
  bool is_good = !IsFrozen() && is_solve_finite;
  const double limit2 = max_displacement_ * max_displacement_;
  for (std::size_t i = 0; is_good && i < good_.size(); ++i) {
    // a NaN fails every comparison, so it is caught here too
    is_good = math::SquaredDistance(state.position[i], model_->rest[i]) <= limit2;
  }
  if (is_good) {
    std::copy(state.position.begin(), state.position.end(), good_.begin());
    bad_in_a_row_ = 0;
    return GuardVerdict::kGood;
  }
  std::copy(good_.begin(), good_.end(), state.position.begin());
  bad_in_a_row_ = std::min(bad_in_a_row_ + 1, kMaxRetries);
  return IsFrozen() ? GuardVerdict::kFrozen : GuardVerdict::kRestored;
}

void StateGuard::UpdateTopology(const TissueModel& model, const TissueState& state) noexcept {
  model_ = &model;
  std::copy(state.position.begin(), state.position.end(), good_.begin());
}

void StateGuard::Release(const TissueState& state) noexcept {
  std::copy(state.position.begin(), state.position.end(), good_.begin());
  bad_in_a_row_ = 0;
}

void StateGuard::VisitState(base::StateArchive& archive) {
  archive.FixedField("good", good_);
  archive.Field("bad_in_a_row", bad_in_a_row_);
  if (archive.IsRestoring() && !(bad_in_a_row_ >= 0 && bad_in_a_row_ <= kMaxRetries))
    archive.Fail("has a count of bad states that no guard reaches");
}

}  // namespace trocar::tissue
