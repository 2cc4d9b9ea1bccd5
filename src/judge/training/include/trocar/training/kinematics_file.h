// SPDX-License-Identifier: Apache-2.0
/// \file kinematics_file.h  Kinematics of people on a surgical robot, as public data sets write them, for the metrics of tips.
///
/// Sources: Y. Gao et al., "The JHU-ISI Gesture and Skill Assessment Working Set (JIGSAWS)", M2CAI 2014, and the description of its
/// columns; K. Hutchinson et al., "COMPASS: a formal framework and aggregate dataset for generalized surgical procedure modeling",
/// IJCARS 2023. Their data are under terms of their own and are not part of this program.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_value.h"

namespace trocar::training {

enum class KinematicsFormat : std::uint8_t {
  kJigsaws,  ///< lines of 76 numbers: both master arms, then the left and the right instrument, 19 numbers each
  kCompass  ///< comma-separated columns with a heading: PSML_position_x to PSMR_position_z
};
inline constexpr std::array kKinematicsFormats = {KinematicsFormat::kJigsaws, KinematicsFormat::kCompass};
/// "jigsaws", "compass"
std::string_view NameOf(KinematicsFormat format) noexcept;
std::optional<KinematicsFormat> FindKinematicsFormat(std::string_view name) noexcept;

/// Of both data sets [Hz].
inline constexpr double kKinematicsRate = 30.0;

/// A trace of the instruments' tips [m]; nothing else is in it: see MetricsOfTips.
/// \param name  for messages
/// \return kDatasetInvalid with the line, where a row has too few or too many columns, a field is no finite number, a heading is
///         missing, or there are fewer than two rows
base::Result<AttemptTrace> ParseKinematics(std::string_view text, KinematicsFormat format,
                                           const std::string& name);

/// Ids of the metrics that follow from where the tips were, and from nothing else.
std::span<const std::string_view> MetricsOfTips() noexcept;
/// Leaves those: what was never measured is absent, not 0.
AttemptMetrics KeepMetricsOfTips(AttemptMetrics metrics);

}  // namespace trocar::training
