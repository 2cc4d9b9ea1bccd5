// SPDX-License-Identifier: Apache-2.0
/// \file equilibrium.h  Quasi-static equilibrium of the mass-spring system.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/tissue/simd_level.h"
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
      false;       ///< residual <= tolerance (Newton: error <= max_error), and springs within law_error
  int rounds = 1;  ///< solves with stiffening springs taken as lines, each about where the last ended
  /// Largest difference between a spring's tension by its law and by the line that stood for it, over the
  /// largest tension [-]; 0 where no spring stiffens.
  double law_error = 0;
  /// Newton: estimated largest distance of a node to the equilibrium, over the largest distance of any node
  /// from rest [-]; NaN where the solver has no estimate, as where it ended at a bound of SolverSettings.
  double error = NAN;
  int coarse_levels = 0;        ///< grids that a coarse-to-fine start went through
  int linear_iterations = 0;    ///< of conjugate gradients, all Newton steps together
  int negative_curvatures = 0;  ///< Newton steps that met a direction in which the energy is not convex
  int patches = 0;              ///< times that nodes which snapped were brought to rest on their own
  /// False where positions, loads, scales or contacts were not finite; then nothing was solved, or not to the
  /// end. Give it to StateGuard::Check.
  bool is_finite = true;
  int restarts = 0;  ///< how often the acceleration was taken back because the residual grew
};

/// How a solver runs; none of it changes what it finds.
struct SolverOptions {
  int threads = 1;  ///< >= 1
  SimdLevel simd =
      FindSimdLevel();  ///< the bits of AVX2 and AVX-512 agree; the baseline's differ in the last place
  bool recognises_grids = true;  ///< take structured meshes as stencils
  /// Room for Follow: so many times more springs and strands than the model has [-], >= 0. A half is enough for the cuts
  /// of an operation.
  double spare_share = 0;
};

/// Called between iterations: keeps a constraint, and may change the forces that load.external_force views.
struct SolveHook {
  /// \param before  positions of the iteration before, (n), where the solver extrapolates from them, else
  /// empty: what
  ///                shifts the present must shift the past alike, or the extrapolation repeats the shift
  void (*act)(void* self, TissueState& state, std::span<Vec3> before) noexcept = nullptr;
  void* self = nullptr;
  int interval = 1;  ///< iterations from one call to the next, >= 1

  /// The constraints themselves, for a solver whose steps are too long to leave them to act(): constraint c
  /// keeps sum_i gradient_i . x_i over its nodes, and its multiplier pushes each node along its gradient.
  /// Steps then stay on the constraints, and act() corrects what is of second order.
  struct Constraint {
    std::uint32_t first_node = 0, node_count = 0;
  };
  std::span<const Constraint> constraints;  ///< at most kMaxHookConstraints
  std::span<const Vec3> gradient;           ///< (n), of each node's constraint; act() keeps it up to date
  bool (*is_active)(void* self, std::size_t constraint) noexcept = nullptr;
  /// The closed surface whose volume a constraint keeps, its nodes counted from first_node. Null where constraints keep
  /// something else; otherwise a solver may ask for the multiplier too.
  std::span<const geometry::Triangle> (*surface)(void* self, std::size_t constraint) noexcept = nullptr;
  /// The multiplier now: of a surface its pressure [Pa].
  double (*multiplier)(void* self, std::size_t constraint) noexcept = nullptr;
  /// Adds to a multiplier; the forces that load.external_force views follow in the next act().
  void (*add_multiplier)(void* self, std::size_t constraint, double change) noexcept = nullptr;
  /// Whether act() could bring the constraints back from these positions: they are linear only near by. A step that
  /// leads farther is taken back, as one that raises the energy; after one that does not, act() is called with the same
  /// positions.
  bool (*is_in_reach)(void* self, const TissueState& state) noexcept = nullptr;

  /// How far each node may go, (n) or empty [m]: a solver that can tell the energy begins there if it is lower.
  std::span<const Vec3> lead;
};
inline constexpr std::size_t kMaxHookConstraints = 8;

/// Memory of the solvers, made once for a model so that a solve allocates nothing.
class EquilibriumSolver {
 public:
  /// \param model    must outlive the solver
  /// \param threads  >= 1; the result does not depend on it
  EquilibriumSolver(const TissueModel& model, int threads);
  /// \pre HasSimdLevel(options.simd)
  EquilibriumSolver(const TissueModel& model, const SolverOptions& options);
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
  virtual void Follow(const TissueModel& model);

  /// Moves every node that is not prescribed towards equilibrium, starting from the state's positions.
  /// \note Real-time safe: no allocation, lock or throw of ours; bounded by settings.max_iterations.
  /// \param hook  nullptr, or what is to be called between iterations; a solve that it disturbs has not
  /// converged
  virtual SolveReport Solve(const SolverSettings& settings, const TissueLoad& load, TissueState& state,
                            const SolveHook* hook = nullptr) noexcept;

  /// True where the model is a structured mesh and runs as a stencil.
  bool IsStructured() const noexcept;

  /// Force of the tissue on whatever prescribes each node of the list, summed; valid after Solve [N].
  Vec3 CalcReaction(const TissueLoad& load, const TissueState& state,
                    std::span<const std::uint32_t> nodes) const noexcept;

  struct Content;

 private:
  std::unique_ptr<Content> content_;
};

/// Largest step of the plain relaxation that converges, alpha < 2 / lambda_max with Gershgorin's bound
/// lambda_max <= max_i (2 sum_j k_ij + k_v) [m/N]. Contacts count with their stiffness.
double CalcLargestAlpha(const TissueModel& model, const TissueLoad& load);

}  // namespace trocar::tissue
