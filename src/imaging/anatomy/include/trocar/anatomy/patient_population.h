// SPDX-License-Identifier: Apache-2.0
/// \file patient_population.h  Many generated patients at once: are they all sound, and do the variations
/// occur as often as configured?
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// How often one value of a variation was drawn.
struct ValueCount {
  std::string value;      ///< "yes", "lateral"
  double configured = 0;  ///< probability [-]
  std::size_t observed = 0;
};

/// One variation over all patients, against what is configured.
struct VariationCount {
  std::string parameter;
  std::size_t patients = 0;        ///< of whom it was drawn
  std::vector<ValueCount> values;  ///< probabilities sum to 1
  double chi_square = 0;           ///< Pearson's, over the values [-]
  int degrees_of_freedom = 0;
  double p_value = 1;  ///< probability of a chi-square at least as large by chance [-]
};

/// Counts the variations of many patients' parameters: yes or no, and choices.
///
/// Parameters that were set, or that follow from another parameter, are left out. Insertions are counted for each
/// series.
std::vector<VariationCount> CountVariations(std::span<const std::vector<patient::Parameter>> patients);

/// Deviation of a count from what is configured, in standard deviations of the binomial distribution; 0 where
/// it has none.
/// \param configured  probability
/// \param trials  how often it was drawn
double CalcBinomialDeviation(double configured, std::size_t observed, std::size_t trials);

/// Probability that a chi-square variable is at least `chi_square`: the regularised upper incomplete gamma
/// function Q(degrees / 2, chi_square / 2).
/// Source: Abramowitz and Stegun 1964, 26.4.19.
/// \param degrees  >= 1
double CalcChiSquareTail(double chi_square, int degrees);

struct PopulationSettings {
  std::uint64_t first_seed = 0;
  std::size_t count = 1;  ///< seeds first_seed, first_seed + 1, ...
  std::vector<ParameterSetting> parameters;
};

/// Result of generating and checking a population of patients.
struct PopulationReport {
  std::size_t patients = 0;
  std::vector<std::pair<std::uint64_t, base::Error>> failures;  ///< seeds that gave no patient
  std::size_t meshes = 0, closed_meshes = 0, manifold_meshes = 0;
  std::size_t self_intersections = 0;           ///< pairs of triangles, all meshes together
  std::map<std::string, std::size_t> findings;  ///< of the linter, by code
  std::vector<std::uint64_t> seeds_with_findings;
  double smallest_angle_deg = 180;  ///< of any triangle
  std::vector<VariationCount> variations;

  /// Every seed gave a patient whose meshes are closed and do not cut themselves, and the linter is silent.
  bool IsSound() const {
    return failures.empty() && closed_meshes == meshes && manifold_meshes == meshes &&
           self_intersections == 0 && findings.empty();
  }
};

/// Called for each finished patient, one at a time, in no particular order. An error ends the run.
using PatientSink = std::function<base::Status(std::uint64_t seed, const patient::Patient& patient)>;

/// Generates, checks and lints patients, several at a time. The report is the same for any number of threads.
/// \param progress  called one at a time, with the number of patients done
/// \return kUsage for no patients or unknown parameters; the sink's error
base::Result<PopulationReport> GeneratePopulation(const PopulationSettings& settings,
                                                  const PatientSink& sink = {},
                                                  const std::function<void(std::size_t)>& progress = {});

}  // namespace trocar::anatomy
