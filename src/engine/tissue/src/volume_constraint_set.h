// SPDX-License-Identifier: Apache-2.0
/// \file volume_constraint_set.h  The volumes of closed organs as constraints of a solver.
#pragma once

#include "trocar/tissue/conservation.h"

namespace trocar::tissue {

/// One constraint for each organ, dV/dx its gradient, and its pressure the multiplier.
class VolumeConstraintSet final : public ConstraintSet {
 public:
  /// \param conservation, state  must outlive this
  VolumeConstraintSet(Conservation& conservation, ConservationState& state) noexcept
      : conservation_(&conservation), state_(&state) {}

  void Project(TissueState& tissue, std::span<math::Vec3> previous) noexcept override {
    conservation_->KeepVolumes(tissue, previous, *state_);
  }
  int Interval() const noexcept override { return kProjectionInterval; }
  std::span<const NodeRange> Nodes() const noexcept override { return conservation_->OrganNodes(); }
  std::span<const math::Vec3> Gradient() const noexcept override { return conservation_->VolumeGradient(); }
  bool IsActive(std::size_t organ) const noexcept override {
    return Conservation::IsSealed(state_->organs[organ]);
  }
  std::span<const geometry::Triangle> Surface(std::size_t organ) const noexcept override {
    return conservation_->Settings().organs[organ].triangles;
  }
  double Multiplier(std::size_t organ) const noexcept override { return state_->organs[organ].pressure; }
  void AddMultiplier(std::size_t organ, double change) noexcept override {
    conservation_->AddPressure(organ, change, *state_);
  }
  bool AreInReach(const TissueState& tissue) noexcept override {
    return conservation_->AreVolumesInReach(tissue, *state_);
  }

 private:
  Conservation* conservation_;
  ConservationState* state_;
};

}  // namespace trocar::tissue
