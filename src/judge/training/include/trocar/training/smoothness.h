// SPDX-License-Identifier: Apache-2.0
/// \file smoothness.h  How smooth a movement is, from its speed profile. Each measure is defined for one
/// movement.
#pragma once

#include <optional>
#include <span>

namespace trocar::training {

/// Largest pad_level: an hour of samples at 100 Hz then takes a transform of 2^25 lines, about 0.8 GB [-].
inline constexpr int kMaxPadLevel = 6;

/// Parameters of the spectral arc length, as published.
struct SparcSettings {
  int pad_level = 4;              ///< transform length = 2^(ceil(log2 n) + pad_level), 0 to kMaxPadLevel [-]
  double cutoff_hz = 10.0;        ///< highest frequency that counts
  double amplitude_limit = 0.05;  ///< the spectrum ends where it last reaches this part of its maximum [-]
};

/// Spectral arc length [-]: negative; closer to zero is smoother. Healthy reaching movements have about -1.4
/// to -1.6.
///
/// \param speed           (n) [any unit]
/// \param sample_rate_hz  > 0 (TROCAR_ASSERT)
/// \return nothing for an empty, all-zero or not finite profile, or a spectrum of a single line
/// Source: Balasubramanian, Melendez-Calderon, Roby-Brami, Burdet, "On the analysis of movement smoothness",
/// J. Neuroeng. Rehabil. 2015.
std::optional<double> CalcSparc(std::span<const double> speed, double sample_rate_hz,
                                const SparcSettings& settings = {});

/// Dimensionless jerk of a speed profile, -(T^3 / v_peak^2) sum(v''^2) dt with T = n dt [-]: closer to zero
/// is smoother.
///
/// \return nothing for fewer than three samples or an all-zero or not finite profile
/// Source: as CalcSparc; second differences as in its published code.
std::optional<double> CalcDimensionlessJerk(std::span<const double> speed, double sample_rate_hz);

/// -ln |dimensionless jerk| [-]: higher (less negative) is smoother. Nothing also where the jerk is zero.
std::optional<double> CalcLogDimensionlessJerk(std::span<const double> speed, double sample_rate_hz);

}  // namespace trocar::training
