// SPDX-License-Identifier: Apache-2.0
/// \file damage.h  Strands that are stretched too far tear.
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
/// \param[out] torn       indices of the strands torn now, lowest first; more tear than it has room for
/// \return how many tore
/// \note Real-time safe.
std::size_t TearStrands(const TissueModel& model, std::span<const double> max_elongation, TissueState& state,
                        std::span<std::uint32_t> torn) noexcept;

}  // namespace trocar::tissue
