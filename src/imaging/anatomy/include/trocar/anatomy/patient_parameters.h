// SPDX-License-Identifier: Apache-2.0
/// \file patient_parameters.h  Parameters that differ from patient to patient: dimensions, variations, pathologies, and
/// the distributions they are drawn from. docs/patients.md lists the sources.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

enum class Distribution {
  kNormal,     ///< centre = mean, spread = standard deviation; cut off at low and high
  kLognormal,  ///< centre = median, spread = standard deviation of the logarithm; cut off at low and high
  kChance,     ///< "yes" with probability `centre`, else "no"
  kChoice,     ///< one of `choices`
  kFixed       ///< `centre` unless it is set
};

struct Choice {
  std::string_view name;
  double weight = 0;  ///< probability up to the common factor, >= 0
};

/// How one parameter is drawn, and what may be set instead.
struct ParameterRule {
  std::string_view name;  ///< "gallbladder_length"
  Distribution distribution = Distribution::kFixed;
  double centre = 0, spread = 0, low = 0, high = 0;  ///< in `unit`
  double set_low = 0, set_high = 0;                  ///< what a person may set
  std::span<const Choice> choices;
  std::string_view unit;    ///< "mm", "deg", "" for shares and words
  std::string_view about;   ///< one line
  std::string_view source;  ///< publication; "general knowledge" where none was found
};

/// Every rule, in the order in which parameters are listed in a patient's file.
std::span<const ParameterRule> ParameterRules();

/// Share of the series' patients with each type of cystic-duct insertion, as published (they need not sum to
/// 1).
/// \return empty for a series that is not known
std::span<const Choice> FindInsertionSeries(std::string_view series);

/// Ranges of the cystic duct's length for "normal", "short" and "long": mean, deviation, low, high [mm].
struct LengthRange {
  double mean = 0, deviation = 0, low = 0, high = 0;
};
LengthRange FindCysticDuctRange(std::string_view length_class);

/// Name and value as text, as on the command line.
using ParameterSetting = std::pair<std::string, std::string>;

/// Draws one value for every rule.
///
/// Each parameter has a random stream of its own, so that setting one leaves the others as they were. What
/// depends on another: the insertion on the series, the duct's class on an insertion "short", its length on
/// the class, shapes on the population. Liver and gallbladder sizes are drawn again until the volumes that they make lie
/// within 950 to 2050 mL and 16 to 60 mL (1200 to 1500 and 30 to 50 in the population "ideal"), unless one of the
/// sizes is set.
/// \param settings  take the place of drawn values; the last of several for one name counts
/// \return one Parameter a rule; kUnknownName for a name or word that is not known (it lists what is),
///         kUsage for a number out of range or no number
base::Result<std::vector<patient::Parameter>> DrawParameters(std::uint64_t seed,
                                                             std::span<const ParameterSetting> settings = {});

/// The middle of every distribution, and no variation: for DrawParameters.
std::vector<ParameterSetting> MakeUsualSettings();

/// \pre the parameter is there and of that kind (TROCAR_ASSERT)
double NumberOf(std::span<const patient::Parameter> parameters, std::string_view name);
const std::string& TextOf(std::span<const patient::Parameter> parameters, std::string_view name);

/// Radius of the gallbladder at part t of its axis, 0 at the neck and 1 at the fundus, as a share of the
/// largest radius; round at both ends [-].
/// \param neck  diameter of the neck, as a share of the largest [-]
double CalcGallbladderProfile(double t, double neck);

}  // namespace trocar::anatomy
