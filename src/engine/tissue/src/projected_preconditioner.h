// SPDX-License-Identifier: Apache-2.0
/// \file projected_preconditioner.h  Multigrid as a preconditioner that stays on linear constraints.
///
/// With M^-1 a V-cycle, G the gradients of the constraints and Y = M^-1 G the preconditioned gradients, a residual r is
/// preconditioned to P M^-1 P^T r, P = I - Y (G^T Y)^-1 G^T. That is symmetric and stays on the constraints whatever Y is, and
/// is best with the Y above. What P^T takes from r is carried by the constraints' multipliers. Source: Gould, Hribar,
/// Nocedal, "On the solution of equality constrained quadratic programming problems arising in optimization", SIAM J.
/// Sci. Comput. 23, 2001.
#pragma once

#include <array>
#include <span>

#include "linearisation.h"
#include "link_hierarchy.h"
#include "node_vectors.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

class ProjectedPreconditioner {
 public:
  using SmallVector = std::array<double, kMaxConstraints>;
  using SmallMatrix = std::array<SmallVector, kMaxConstraints>;

  /// \param model, hierarchy  must outlive this
  ProjectedPreconditioner(const OrderedModel& model, LinkHierarchy& hierarchy)
      : model_(&model), hierarchy_(&hierarchy) {}
  /// Takes another model, whose levels the hierarchy has.
  void SetModel(const OrderedModel& model) noexcept;
  /// Vectors for so many constraints. Those of more are made where they become active.
  void Prepare(std::size_t constraints);

  /// Without any constraint.
  void Clear() noexcept { active_ = {}; }
  /// The hierarchy has changed: gradients have to be preconditioned again.
  void Invalidate() noexcept { has_preconditioned_ = false; }
  /// Takes those constraints of a set that are active now, with no multiplier yet.
  /// \param set  null for none
  void SetActive(const ConstraintSet* set) noexcept;
  std::size_t Count() const noexcept { return active_.size(); }
  /// Which of the set's constraints the active one is.
  std::size_t IndexOf(std::size_t active) const noexcept { return active_[active].index; }
  /// Takes the gradient of an active constraint, zero on held nodes. Several may be taken at the same time.
  void TakeGradient(std::size_t active, const ConstraintSet& set, const OrderedLoad& load) noexcept;
  /// (padded nodes), as last taken.
  std::span<const Float4> Gradient(std::size_t active) const noexcept { return active_[active].gradient; }
  /// Y and G^T Y; Y is that of before where the hierarchy and the active constraints are.
  void PreconditionGradients(const Kernels& kernels, Workers& workers) noexcept;

  /// r <- P^T r: the multipliers carry what they can.
  void ProjectResidual(const Kernels& kernels, Workers& workers, math::AlignedVector<Float4>& r) noexcept;
  /// r <- P^T r, z = P M^-1 r.
  /// \return r . z, and the length of the longest of z
  DotAndLongest Apply(const Kernels& kernels, Workers& workers, math::AlignedVector<Float4>& r,
                      math::AlignedVector<Float4>& z) noexcept;

  /// Part of the residual that each active constraint carries since SetActive(), in its own units.
  SmallVector& Multipliers() noexcept { return multipliers_; }

 private:
  struct Constraint {
    std::size_t index = 0;                                // in the set
    math::AlignedVector<Float4> gradient;                 // (padded) G
    math::AlignedVector<Float4> preconditioned_gradient;  // (padded) Y
  };
  /// Of each constraint's part with v.
  SmallVector CalcDots(const Kernels& kernels, Workers& workers,
                       math::AlignedVector<Float4> Constraint::*part,
                       const math::AlignedVector<Float4>& v) const noexcept;
  /// from -= sum of shares of each constraint's part, of some of the nodes
  void Subtract(const Kernels& kernels, const SmallVector& shares,
                math::AlignedVector<Float4> Constraint::*part, math::AlignedVector<Float4>& from,
                std::uint32_t first, std::uint32_t last) const noexcept;

  const OrderedModel* model_;
  LinkHierarchy* hierarchy_;
  std::array<Constraint, kMaxConstraints> storage_;
  std::span<Constraint> active_;     // the first of storage_
  bool has_preconditioned_ = false;  // Y is that of the active constraints and the hierarchy as it is
  SmallMatrix gram_{};               // G^T Y
  SmallVector multipliers_{};
};

}  // namespace trocar::tissue
