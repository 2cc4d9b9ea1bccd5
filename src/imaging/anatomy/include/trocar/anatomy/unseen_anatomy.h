// SPDX-License-Identifier: Apache-2.0
/// \file unseen_anatomy.h  Anatomy that images of liver and gallbladder do not show: ducts, arteries, the wall's thickness,
/// adhesions, stones. The variations in the order of their probability, and a patient completed by one of them.
/// The distributions are ParameterRules(); docs/patients.md lists their sources.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// One variation with its value, and the share of people who have it.
struct VariationShare {
  std::string name, value;  ///< "moynihan_hump", "yes"
  double probability = 0;   ///< given the shares before it [-], 0 to 1
  std::string source;       ///< publication, or "set by the user"
};

/// One combination of variations.
struct UnseenVariant {
  std::vector<VariationShare> shares;
  double probability = 0;  ///< product of the shares, which are taken as independent [-]
  int difficulty = 0;      ///< sum of points for what makes ducts and arteries easy to mistake [-], >= 0
};

/// Every combination of cystic duct's insertion and length class, second cystic artery, Moynihan's hump and subvesical
/// duct; the most likely first. Probabilities sum to 1.
///
/// \param settings  values that are certain; names that are no variation are left to DrawParameters
/// \return kUnknownName or kUsage as DrawParameters
base::Result<std::vector<UnseenVariant>> RankUnseenVariants(std::span<const ParameterSetting> settings = {});

/// The hardest of those that at least such a share of people has; of equally hard ones the most likely.
/// \param variants   as RankUnseenVariants returns them, at least one (TROCAR_ASSERT)
/// \param at_least   [-]; where none is so likely, the most likely one
const UnseenVariant& FindWorstPlausible(std::span<const UnseenVariant> variants, double at_least);

/// Whether images of liver and gallbladder leave a parameter open. False for what the organs' shapes show.
bool IsUnseenParameter(std::string_view name);

/// Where the numbers beside a variant come from: lengths, diameters, the wall, stones.
enum class UnseenNumbers {
  kMiddle,  ///< the middle of each distribution
  kHard  ///< the harder end of each distribution's central 95 %; adhesions and fibrosis at half of their scale
};

/// Values for all that is not seen, each with its source and, where it is a variation, its probability.
///
/// \param settings  take the place of the variant's and of the numbers
/// \return as DrawParameters, without what the images show
base::Result<std::vector<patient::Parameter>> MakeUnseenParameters(
    const UnseenVariant& variant, UnseenNumbers numbers, std::span<const ParameterSetting> settings = {});

/// Draws all that is not seen from the distributions.
base::Result<std::vector<patient::Parameter>> DrawUnseenParameters(
    std::uint64_t seed, std::span<const ParameterSetting> settings = {});

/// The combination that parameters show.
/// \pre the variations are among them (TROCAR_ASSERT)
UnseenVariant FindVariant(std::span<const UnseenVariant> variants,
                          std::span<const patient::Parameter> parameters);

/// A patient with ducts and arteries after the parameters, in place of those that are not seen.
///
/// Where one of its ducts or arteries is seen, all of them stay: they are one tree. Then only the wall, adhesions,
/// diseases and stones are taken from `parameters`.
/// \param what        said in the patient's file: "the most likely"
/// \param parameters  as MakeUnseenParameters or DrawUnseenParameters returns them
/// \return kPatientInvalid where the patient has no liver, gallbladder or infundibulum, or what comes of it is
///         inconsistent
base::Result<patient::Patient> CompletePatient(const patient::Patient& patient, std::string_view what,
                                               const UnseenVariant& variant,
                                               std::span<const patient::Parameter> parameters);

/// Whether CompletePatient keeps its ducts and arteries.
bool HasSeenTubes(const patient::Patient& patient);

}  // namespace trocar::anatomy
