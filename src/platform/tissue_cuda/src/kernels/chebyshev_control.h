// SPDX-License-Identifier: Apache-2.0
/// \file chebyshev_control.h  When the Chebyshev recurrence starts again, when it is taken back, and when it
/// ends: the decisions of tissue/chebyshev_jacobi_wang2015.cpp, taken by every thread alike from the same
/// three maxima, so that no iteration waits for the host.
/// Source: Wang, "A Chebyshev semi-iterative approach for accelerating projective and position-based
/// dynamics", ACM TOG 34(6), 2015, equations 7 to 9.
#pragma once

#include "portable.h"

namespace trocar::tissue_cuda {

/// Constants of the CPU's solver; the host fills them in, so that they stand in one place for the GPU.
template <typename Real>
struct ChebyshevSettings {
  std::uint32_t max_iterations = 40;
  std::uint32_t pause_at = 0xffffffffu;  ///< the launch ends at this iteration, to be resumed
  Real tolerance = Real(1e-4);           ///< [-]
  Real max_step = Real(0.002);           ///< no node moves farther in one Jacobi step [m]
  Real transverse_share = Real(0.2), share_growth = 4;
  std::uint32_t first_cycle = 40, longest_cycle = 1280;
  Real cycle_damping = Real(2.302585);  ///< ln(100) / 2
  Real growth_limit = 4;
};

/// Result of an iteration: maxima over all free nodes.
template <typename Real>
struct IterationMaxima {
  Real residual2 = 0;  ///< [N^2]
  Real force2 = 0;     ///< [N^2]
  bool is_cut_short = false;
};

/// State of the recurrence; the same in every thread.
template <typename Real>
struct ChebyshevControl {
  Real omega = 1, damping = 1, rho = 0, transverse_share = 0, smallest = 0;
  Real residual = 0, force_scale = 0;
  std::uint32_t iterations = 0, in_cycle = 0, cycle_length = 0, restarts = 0;
  bool converged = false, ended = false, has_smallest = false;
  bool needs_blocks = true;  ///< the next iteration begins with fresh blocks

  TROCAR_HD void Begin(const ChebyshevSettings<Real>& settings) {
    cycle_length =
        settings.max_iterations < settings.first_cycle ? settings.max_iterations : settings.first_cycle;
    transverse_share = settings.transverse_share;
    SetFactors(settings);
  }

  /// In another launch, from where the last one paused.
  TROCAR_HD void Resume() { ended = false; }

  /// Whether the position before counts as the present one.
  TROCAR_HD bool IsFirst() const { return in_cycle == 0; }
  /// Which of two buffers holds the accepted displacements.
  TROCAR_HD std::uint32_t Parity() const { return iterations % 2; }

  /// After an iteration: accepts its step or ends, and sets the factors of the next.
  TROCAR_HD void Decide(const ChebyshevSettings<Real>& settings, const IterationMaxima<Real>& maxima) {
    const Real norm = SquareRoot(maxima.residual2);
    force_scale = SquareRoot(maxima.force2);
    residual = force_scale > Real(0) ? norm / force_scale : Real(0);
    converged = residual <= settings.tolerance;
    if (converged) {
      ended = true;  // the accepted displacements are those that the residual belongs to
      return;
    }
    ++iterations, ++in_cycle;
    if (!has_smallest || norm < smallest) smallest = norm;
    has_smallest = true;
    if (norm > settings.growth_limit * smallest) {
      const Real grown = settings.share_growth * transverse_share;
      transverse_share = grown < Real(1) ? grown : Real(1);
      smallest = norm;
      in_cycle = 0;
      ++restarts;
    } else if (in_cycle == cycle_length || maxima.is_cut_short) {
      if (in_cycle == cycle_length) {
        cycle_length = 2 * cycle_length < settings.longest_cycle ? 2 * cycle_length : settings.longest_cycle;
      }
      in_cycle = 0;
    }
    // a residual that is not a number ends the solve: the state's guard looks at what came out
    ended = iterations >= settings.max_iterations || iterations >= settings.pause_at || !(norm == norm);
    needs_blocks = in_cycle == 0;
    SetFactors(settings);
  }

 private:
  TROCAR_HD void SetFactors(const ChebyshevSettings<Real>& settings) {
    if (in_cycle == 0) {
      // modes whose eigenvalue is below `lowest` are out of reach of this cycle
      const Real reach = settings.cycle_damping / Real(cycle_length);
      const Real lowest = reach * reach < Real(0.5) ? reach * reach : Real(0.5);
      damping = Real(2) / (Real(2) + lowest);
      rho = (Real(2) - lowest) / (Real(2) + lowest);
      omega = 1;
    } else if (in_cycle == 1) {
      omega = Real(2) / (Real(2) - rho * rho);
    } else {
      omega = Real(4) / (Real(4) - rho * rho * omega);
    }
  }
};

}  // namespace trocar::tissue_cuda
