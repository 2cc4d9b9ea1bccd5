// SPDX-License-Identifier: Apache-2.0
/// \file damage.h  Strands and springs that are stretched too far, or too long, tear.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// A strand that nothing tears [m].
inline constexpr double kNeverTears = std::numeric_limits<double>::infinity();

/// Tears every intact strand that is longer than at rest by more than its limit. Elongation does not change
/// when a freed organ is turned, so no frame is needed; a force limit F is the elongation F / k.
///
/// \param max_elongation  (strands) [m], > 0 or kNeverTears
/// \param[out] torn       indices of the strands torn now, lowest first; more tear than it has the capacity for
/// \return how many tore
/// \note Real-time safe.
std::size_t TearStrands(const TissueModel& model, std::span<const double> max_elongation, TissueState& state,
                        std::span<std::uint32_t> torn) noexcept;

/// Tears every spring that is stretched beyond its law's failure strain, and gathers the damage of the others:
/// D grows by damage_rate (T / T_f)^m dt, with T_f the tension at the failure strain, and the spring tears when D
/// reaches one. StabilisingShift springs gather none. A torn spring has the factor zero, and nothing makes it whole again.
///
/// \param dt           length of the tick [s], >= 0
/// \param[out] torn    indices of the springs torn now, lowest first; more tear than it has the capacity for
/// \return how many tore
/// \note Real-time safe.
/// Source: ultimate strains of wall and liver: domain facts 3.1; D += (sigma / sigma_0)^m dt: domain facts 3.3, with
/// sigma_0 = T_f damage_rate^(-1/m).
std::size_t TearSprings(const TissueModel& model, double dt, TissueState& state,
                        std::span<std::uint32_t> torn) noexcept;

/// True where the springs of a model can tear.
bool HasTearingSprings(const TissueModel& model) noexcept;

}  // namespace trocar::tissue
