// SPDX-License-Identifier: Apache-2.0
/// \file equilibrium.h  Quasi-static equilibrium of the mass-spring system.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/simd_level.h"
#include "trocar/base/threads.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/tissue/solver_settings.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// How a solve ended.
struct SolveReport {
  int iterations = 0;
  double residual = 0;  ///< largest |R_i| of a node that is not prescribed, over `force_scale` [-]
  double force_scale =
      0;  ///< largest force that acts on any such node through one spring, load or contact [N]
  bool converged =
      false;  ///< residual <= tolerance (Newton: error <= max_error), and springs within law_error
  int outer_iterations = 1;  ///< solves with stiffening springs linearised, each where the last ended
  /// Largest difference between a spring's tension by its law and by its linearisation, over the largest tension [-]; 0
  /// where no spring stiffens.
  double law_error = 0;
  /// Newton: estimated largest distance of a node to the equilibrium, over the largest distance of any node
  /// from rest [-]; NaN where the solver has no estimate, as where it ended at a bound of SolverSettings.
  double error = NAN;
  int coarse_levels = 0;        ///< grids that a coarse-to-fine start went through
  int linear_iterations = 0;    ///< of conjugate gradients, all Newton steps together
  int negative_curvatures = 0;  ///< Newton steps that met a direction in which the energy is not convex
  int local_solves = 0;         ///< of the few nodes that snap through, on their own
  /// False where positions, loads, scales, contacts or elements were not usable; then nothing was solved, or not to the
  /// end. Give it to StateGuard::Check.
  bool is_finite = true;
  int restarts = 0;  ///< how often the acceleration was taken back because the residual grew
};

/// How a solver runs; none of it changes what it finds.
struct SolverOptions {
  base::Threads threads;
  base::SimdLevel simd =
      base::FindSimdLevel();  ///< the bits of AVX2 and AVX-512 agree; the baseline's differ in the last place
  bool recognises_grids = true;  ///< take structured meshes as stencils
  /// Spare capacity for UpdateTopology: so many times more springs and strands than the model has [-], >= 0. A half is
  /// enough for the cuts of an operation.
  double spare_share = 0;
};

/// Scalar constraints that hold in the equilibrium, such as the volumes of closed organs. Constraint c keeps the sum of
/// gradient_i . x_i over its nodes, linearised; its multiplier pushes each of them along its gradient.
class ConstraintSet {
 public:
  struct NodeRange {
    std::uint32_t first_node = 0, node_count = 0;
  };
  virtual ~ConstraintSet() = default;

  /// Called by a solver between its iterations, every Interval() of them; Newton's method calls it after every step.
  /// Brings positions back to the constraints, and makes the forces that load.external_force views and the gradients
  /// those of the new positions.
  ///
  /// \param previous  (n) positions of the iteration before, where the solver extrapolates from them, else empty. What
  ///                  shifts the present has to shift the past alike, or the extrapolation repeats the shift.
  virtual void Project(TissueState& state, std::span<math::Vec3> previous) noexcept = 0;
  virtual int Interval() const noexcept { return 1; }

  // For solvers whose steps are too long to leave the constraints to Project(): their steps stay on the linearised
  // constraints, and Project() corrects what is of second order.

  /// The nodes of each constraint, at most kMaxConstraints; empty where only Project() knows them.
  virtual std::span<const NodeRange> Nodes() const noexcept { return {}; }
  /// (n) of each node's constraint.
  virtual std::span<const math::Vec3> Gradient() const noexcept { return {}; }
  virtual bool IsActive(std::size_t /*constraint*/) const noexcept { return true; }
  /// The closed surface whose volume a constraint keeps, its nodes counted from first_node; empty where it keeps something
  /// else. The multiplier is then the pressure [Pa].
  virtual std::span<const geometry::Triangle> Surface(std::size_t /*constraint*/) const noexcept {
    return {};
  }
  virtual double Multiplier(std::size_t /*constraint*/) const noexcept { return 0.0; }
  /// The forces follow in the next Project().
  virtual void AddMultiplier(std::size_t /*constraint*/, double /*change*/) noexcept {}
  /// Whether Project() could bring these positions back: constraints are linear only near by. A step that leads farther is
  /// shortened; after one that does not, Project() is called with the same positions.
  virtual bool AreInReach(const TissueState& /*state*/) noexcept { return true; }
};
inline constexpr std::size_t kMaxConstraints = 8;

/// Constant data that all solvers of one model share: its nodes in the order of their memory, and the levels of the multigrid.
struct SolverModel;

/// The solvers of one model and their memory.
class EquilibriumSolver {
 public:
  /// With the default options. \param model  must outlive the solver
  explicit EquilibriumSolver(const TissueModel& model);
  /// \param same_model  of another solver of an equal model, to share its memory; null makes one. Shared, because none of
  ///                    the solvers outlives the others for sure.
  /// \pre HasSimdLevel(options.simd)
  EquilibriumSolver(const TissueModel& model, const SolverOptions& options,
                    std::shared_ptr<const SolverModel> same_model = nullptr);
  virtual ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  /// Goes on with another model, after a cut: in the memory of this solver, what a solver made anew would be, bit by
  /// bit. A quarter of the time of making one, because nothing is allocated.
  ///
  /// \param model  as many nodes as before (TROCAR_ASSERT), of which spare ones may have become part of the tissue;
  ///               must outlive the solver; may be the same object with other content
  /// \note Allocates nothing as long as the links stay within SolverOptions::spare_share; beyond it does and goes on.
  ///       Structured meshes allocate.
  virtual void UpdateTopology(const TissueModel& model);

  /// Makes the memory that solves with these settings and so many constraints need, so that none of them allocates. Other
  /// solves make what they need when they first run.
  void Prepare(const SolverSettings& settings, std::size_t constraints);

  /// Of the model that the solver was made for.
  std::shared_ptr<const SolverModel> ShareModel() const noexcept;

  /// Moves every node that is not prescribed towards equilibrium, starting from the state's positions.
  /// \param constraints    null for none; a solve that they disturb has not converged
  /// \param extrapolation  (n) from the state's positions to the extrapolated initial guess, or empty [m]. Newton's method
  ///                       begins there if the energy is lower and the constraints are in reach; others do not.
  /// \note Real-time safe after Prepare(): no allocation, lock or throw of ours; bounded by the settings' counts.
  virtual SolveReport Solve(const SolverSettings& settings, const TissueLoad& load, TissueState& state,
                            ConstraintSet* constraints = nullptr,
                            std::span<const math::Vec3> extrapolation = {}) noexcept;

  /// True where the model is a structured mesh and runs as a stencil.
  bool IsStructured() const noexcept;

  /// Force of the tissue on whatever prescribes each node of the list, summed; valid after Solve [N].
  math::Vec3 CalcReaction(const TissueLoad& load, const TissueState& state,
                          std::span<const std::uint32_t> nodes) const noexcept;

  struct Content;

 private:
  std::unique_ptr<Content> content_;
};

/// A solver that asks another device first, a graphics processor for instance; after the device's first failure the processor
/// goes on, in the same call. The device's bits are its own.
class DeviceSolver : public EquilibriumSolver {
 public:
  using EquilibriumSolver::EquilibriumSolver;
  /// Of the device in use; empty once it failed, and after a cut.
  virtual std::string_view DeviceName() const noexcept = 0;
  /// Why the device is not used although it was asked for; else null.
  virtual const base::Error* DeviceError() const noexcept = 0;
};

/// Largest step of the plain relaxation that converges, alpha < 2 / lambda_max with Gershgorin's bound
/// lambda_max <= max_i (2 sum_j k_ij + k_v) [m/N]. Contacts count with their stiffness, elements with that which they have at
/// `position`; empty: at rest.
double CalcLargestAlpha(const TissueModel& model, const TissueLoad& load,
                        std::span<const math::Vec3> position = {});

}  // namespace trocar::tissue
