// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/unseen_anatomy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "duct_template.h"
#include "trocar/anatomy/tube_graph.h"
#include "trocar/base/assert.h"
#include "trocar/files/patient_frame.h"
#include "trocar/math/elementary.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using base::Result;

constexpr std::string_view kSetByUser = "set by the user";
constexpr std::string_view kSeries = "cystic_duct_series", kInsertion = "cystic_duct_insertion",
                           kLengthClass = "cystic_duct_class", kDuctLength = "cystic_duct_length";
constexpr std::string_view kSubvesicalDuct = NameOf(roles::TubeRole::kSubvesicalDuct);
constexpr double kCentralShare = 1.959964;  // standard deviations on either side of the central 95 % [-]
constexpr double kHalfOfScale = 0.5;        // of what has a scale but no distribution

/// Variations that are combined, in the order in which they depend on each other.
constexpr std::string_view kVariations[] = {kInsertion, kLengthClass, "double_cystic_artery", "moynihan_hump",
                                            kSubvesicalDuct};

/// Points for what makes it easy to mistake a main duct or artery for one that may be divided, or leaves little room for
/// clips. General knowledge: no source gives such weights.
struct Difficulty {
  std::string_view name, value;
  int points;
};
constexpr Difficulty kDifficulties[] = {{kInsertion, "parallel", 3},
                                        {kInsertion, "medial", 2},
                                        {kInsertion, "low", 1},
                                        {kInsertion, "high", 1},
                                        {kInsertion, "short", 1},
                                        {kLengthClass, "short", 2},
                                        {"double_cystic_artery", "yes", 1},
                                        {"moynihan_hump", "yes", 3},
                                        {kSubvesicalDuct, "yes", 1}};

/// What ducts, arteries and tissue are like that no image of liver and gallbladder shows.
struct Unseen {
  std::string_view name;
  bool is_of_tubes;
  int harder;  ///< +1: more of it, -1: less, 0: neither
};
constexpr Unseen kUnseen[] = {{kSeries, true, 0},
                              {kInsertion, true, 0},
                              {kLengthClass, true, 0},
                              {kDuctLength, true, -1},
                              {"cystic_duct_diameter", true, +1},
                              {"hepatic_duct_length", true, 0},
                              {"hepatic_duct_diameter", true, -1},
                              {"bile_duct_length", true, 0},
                              {"bile_duct_diameter", true, -1},
                              {"cystic_artery_length", true, -1},
                              {"cystic_artery_diameter", true, +1},
                              {"hepatic_artery_diameter", true, 0},
                              {"double_cystic_artery", true, 0},
                              {"moynihan_hump", true, 0},
                              {kSubvesicalDuct, true, 0},
                              {"subvesical_duct_diameter", true, 0},
                              {"gallbladder_wall", false, +1},
                              {"hydrops", false, 0},
                              {"acute_cholecystitis", false, 0},
                              {"scleroatrophy", false, 0},
                              {"steatosis", false, 0},
                              {"cirrhosis", false, 0},
                              {"triangle_fibrosis", false, +1},
                              {"adhesions", false, +1},
                              {"gallstone_count", false, +1},
                              {"gallstone_diameter", false, 0}};

const Unseen* FindUnseen(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(kUnseen), std::end(kUnseen), [&](const Unseen& it) { return it.name == name; });
  return found == std::end(kUnseen) ? nullptr : found;
}

const ParameterRule& RuleOf(std::string_view name) {
  const auto rules = ParameterRules();
  const auto found =
      std::find_if(rules.begin(), rules.end(), [&](const auto& rule) { return rule.name == name; });
  TROCAR_ASSERT(found != rules.end());
  return *found;
}

/// The last setting of that name, or null.
const std::string* FindSetting(std::span<const ParameterSetting> settings, std::string_view name) {
  const std::string* found = nullptr;
  for (const auto& [set, value] : settings) {
    if (set == name) found = &value;
  }
  return found;
}

/// The values of a variation with their probabilities, after those that are decided already.
std::vector<VariationShare> SharesOf(std::string_view name, const std::vector<VariationShare>& before,
                                     std::string_view series) {
  const ParameterRule& rule = RuleOf(name);
  std::vector<VariationShare> shares;
  const auto add = [&](std::string_view value, double probability, std::string_view source) {
    shares.push_back({std::string(name), std::string(value), probability, std::string(source)});
  };
  if (rule.distribution == Distribution::kChance) {
    add("no", 1.0 - rule.centre, rule.source);
    add("yes", rule.centre, rule.source);
    return shares;
  }
  const bool is_short = std::any_of(before.begin(), before.end(), [](const VariationShare& share) {
    return share.name == kInsertion && share.value == "short";
  });
  if (name == kLengthClass && is_short) {
    add("short", 1.0, "follows from the insertion");
    return shares;
  }
  const std::span<const Choice> choices = name == kInsertion ? FindInsertionSeries(series) : rule.choices;
  double total = 0;
  for (const Choice& choice : choices) total += choice.weight;
  // the series that is not the rule's own
  const std::string_view source =
      name == kInsertion && series != "hindawi_2016" ? "IJMS, MRCP, Iran, n = 290" : rule.source;
  for (const Choice& choice : choices) add(choice.name, choice.weight / total, source);
  return shares;
}

int DifficultyOf(const std::vector<VariationShare>& shares) {
  int points = 0;
  for (const VariationShare& share : shares) {
    for (const Difficulty& difficulty : kDifficulties)
      if (share.name == difficulty.name && share.value == difficulty.value) points += difficulty.points;
  }
  return points;
}

/// Quantile at the harder end of the central 95 %, within the limits that the rule draws from.
double HardNumber(const ParameterRule& rule, const LengthRange* range, int harder) {
  const double centre = range != nullptr ? range->mean : rule.centre;
  const double spread = range != nullptr ? range->deviation : rule.spread;
  const double low = range != nullptr ? range->low : rule.low,
               high = range != nullptr ? range->high : rule.high;
  const double z = harder * kCentralShare * spread;
  return std::clamp(rule.distribution == Distribution::kLognormal ? centre * math::Exp(z) : centre + z, low,
                    high);
}

std::string FormatSetting(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// "Schnelldorfer 2012; 4 % of people"
std::string WithShare(const std::string& source, double probability) {
  char share[48];
  std::snprintf(share, sizeof share, "; %.3g %% of people", 100 * probability);
  return source + share;
}

/// Keeps what is not seen, and says of each variation how likely it is.
std::vector<patient::Parameter> KeepUnseen(std::vector<patient::Parameter> parameters) {
  std::erase_if(parameters,
                [](const patient::Parameter& parameter) { return FindUnseen(parameter.name) == nullptr; });
  return parameters;
}

/// Ducts and arteries in place of those that were placed by landmarks.
base::Status ReplaceTubes(patient::Patient& patient, std::span<const patient::Parameter> parameters) {
  const int liver = patient.OrganOf(roles::OrganRole::kLiver),
            gallbladder = patient.OrganOf(roles::OrganRole::kGallbladder);
  const patient::Landmark* infundibulum = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum);
  if (liver < 0 || gallbladder < 0 || infundibulum == nullptr) {
    return Error{ErrorCode::kPatientInvalid,
                 "ducts and arteries are placed by liver, gallbladder and infundibulum; the patient lacks "
                 "one of them"};
  }
  // where the duct left the gallbladder before
  math::Vec3 neck = infundibulum->position;
  if (const int duct = patient.TubeOf(roles::TubeRole::kCysticDuct); duct >= 0) {
    const patient::Tube& tube = patient.tubes[static_cast<std::size_t>(duct)];
    const std::string& organ = patient.organs[static_cast<std::size_t>(gallbladder)].name;
    if (tube.from == organ) neck = tube.line.points.front();
    if (tube.to == organ) neck = tube.line.points.back();
  }
  // the template asks for all parameters; those of the organs' shapes are not used
  std::vector<ParameterSetting> settings = MakeUsualSettings();
  auto all = DrawParameters(0, settings);
  if (!all.ok()) return all.error();
  for (patient::Parameter& parameter : *all) {
    const auto given =
        std::find_if(parameters.begin(), parameters.end(),
                     [&](const patient::Parameter& other) { return other.name == parameter.name; });
    if (given != parameters.end()) parameter = *given;
  }
  const std::string& liver_name = patient.organs[static_cast<std::size_t>(liver)].name;
  const std::string& gallbladder_name = patient.organs[static_cast<std::size_t>(gallbladder)].name;
  patient.tubes = MakeTemplateTubes(patient.organs[static_cast<std::size_t>(liver)].mesh,
                                    patient.organs[static_cast<std::size_t>(gallbladder)].mesh, neck, *all);
  // the template calls the organs by their roles
  for (patient::Tube& tube : patient.tubes) {
    for (std::string* end : {&tube.from, &tube.to}) {
      if (*end == NameOf(roles::OrganRole::kLiver)) *end = liver_name;
      if (*end == NameOf(roles::OrganRole::kGallbladder)) *end = gallbladder_name;
    }
  }
  JoinTubes(patient);
  std::erase_if(patient.landmarks, [](const patient::Landmark& it) {
    return it.role == roles::LandmarkRole::kHepatocysticTriangle;
  });
  if (const auto middle = CalcTriangleMiddle(patient))
    patient.landmarks.push_back({NameOf(roles::LandmarkRole::kHepatocysticTriangle), *middle});
  return {};
}

bool IsOfTubes(std::string_view name) {
  const Unseen* unseen = FindUnseen(name);
  return unseen != nullptr && unseen->is_of_tubes;
}

}  // namespace

Result<std::vector<UnseenVariant>> RankUnseenVariants(std::span<const ParameterSetting> settings) {
  // wrong names and values are refused as everywhere
  if (const auto checked = DrawParameters(0, settings); !checked.ok()) return checked.error();
  const std::string* set_series = FindSetting(settings, kSeries);
  const std::string_view series = set_series != nullptr ? std::string_view(*set_series) : "hindawi_2016";
  std::vector<UnseenVariant> variants = {{{}, 1.0, 0}};
  for (const std::string_view name : kVariations) {
    const std::string* set = FindSetting(settings, name);
    std::vector<UnseenVariant> longer;
    for (const UnseenVariant& variant : variants) {
      std::vector<VariationShare> shares = SharesOf(name, variant.shares, series);
      if (set != nullptr) shares = {{std::string(name), *set, 1.0, std::string(kSetByUser)}};
      for (VariationShare& share : shares) {
        UnseenVariant next = variant;
        next.probability *= share.probability;
        next.shares.push_back(std::move(share));
        longer.push_back(std::move(next));
      }
    }
    variants = std::move(longer);
  }
  for (UnseenVariant& variant : variants) variant.difficulty = DifficultyOf(variant.shares);
  std::stable_sort(variants.begin(), variants.end(), [](const UnseenVariant& a, const UnseenVariant& b) {
    return a.probability > b.probability;
  });
  return variants;
}

const UnseenVariant& FindWorstPlausible(std::span<const UnseenVariant> variants, double at_least) {
  TROCAR_ASSERT(!variants.empty());
  const UnseenVariant* worst = &variants.front();
  for (const UnseenVariant& variant : variants) {
    if (variant.probability >= at_least && variant.difficulty > worst->difficulty) worst = &variant;
  }
  return *worst;
}

bool IsUnseenParameter(std::string_view name) {
  return FindUnseen(name) != nullptr;
}

Result<std::vector<patient::Parameter>> MakeUnseenParameters(const UnseenVariant& variant,
                                                             UnseenNumbers numbers,
                                                             std::span<const ParameterSetting> settings) {
  std::vector<ParameterSetting> all = MakeUsualSettings();
  if (const std::string* series = FindSetting(settings, kSeries)) all.emplace_back(kSeries, *series);
  std::string length_class = "normal";
  for (const VariationShare& share : variant.shares) {
    all.emplace_back(share.name, share.value);
    if (share.name == kLengthClass) length_class = share.value;
  }
  const LengthRange range = FindCysticDuctRange(length_class);
  all.emplace_back(kDuctLength, FormatSetting(range.mean));
  constexpr std::string_view kStones = "gallstone_count";
  all.emplace_back(kStones, FormatSetting(std::round(RuleOf(kStones).centre)));
  const bool is_hard = numbers == UnseenNumbers::kHard;
  for (const Unseen& unseen : kUnseen) {
    if (!is_hard || unseen.harder == 0) continue;
    const ParameterRule& rule = RuleOf(unseen.name);
    double value = rule.distribution == Distribution::kFixed
                       ? kHalfOfScale
                       : HardNumber(rule, unseen.name == kDuctLength ? &range : nullptr, unseen.harder);
    if (unseen.name == kStones) value = std::round(value);
    all.emplace_back(unseen.name, FormatSetting(value));
  }
  all.insert(all.end(), settings.begin(), settings.end());
  auto drawn = DrawParameters(0, all);
  if (!drawn.ok()) return drawn.error();
  std::vector<patient::Parameter> parameters = KeepUnseen(std::move(*drawn));
  for (patient::Parameter& parameter : parameters) {
    if (FindSetting(settings, parameter.name) != nullptr) continue;  // "set by the user"
    const ParameterRule& rule = RuleOf(parameter.name);
    parameter.source = std::string(rule.source);
    const bool is_end = is_hard && FindUnseen(parameter.name)->harder != 0;
    if (rule.distribution == Distribution::kFixed) {
      parameter.source =
          is_end ? "half of its scale, a choice: no frequency is known" : "not present unless it is set";
    } else if (std::holds_alternative<double>(parameter.value)) {
      parameter.source += is_end ? "; harder end of the central 95 %" : "; middle of the distribution";
    }
    for (const VariationShare& share : variant.shares) {
      if (share.name == parameter.name) parameter.source = WithShare(share.source, share.probability);
    }
  }
  return parameters;
}

Result<std::vector<patient::Parameter>> DrawUnseenParameters(std::uint64_t seed,
                                                             std::span<const ParameterSetting> settings) {
  auto drawn = DrawParameters(seed, settings);
  if (!drawn.ok()) return drawn.error();
  auto variants = RankUnseenVariants(settings);
  if (!variants.ok()) return variants.error();
  const UnseenVariant variant = FindVariant(*variants, *drawn);
  std::vector<patient::Parameter> parameters = KeepUnseen(std::move(*drawn));
  for (patient::Parameter& parameter : parameters) {
    for (const VariationShare& share : variant.shares) {
      if (share.name == parameter.name && share.source != kSetByUser)
        parameter.source = WithShare(share.source, share.probability);
    }
  }
  return parameters;
}

UnseenVariant FindVariant(std::span<const UnseenVariant> variants,
                          std::span<const patient::Parameter> parameters) {
  const auto found = std::find_if(variants.begin(), variants.end(), [&](const UnseenVariant& variant) {
    return std::all_of(variant.shares.begin(), variant.shares.end(), [&](const VariationShare& share) {
      return TextOf(parameters, share.name) == share.value;
    });
  });
  TROCAR_ASSERT(found != variants.end());
  return *found;
}

bool HasSeenTubes(const patient::Patient& patient) {
  return std::any_of(patient.tubes.begin(), patient.tubes.end(),
                     [](const patient::Tube& tube) { return tube.is_seen; });
}

Result<patient::Patient> CompletePatient(const patient::Patient& patient, std::string_view what,
                                         const UnseenVariant& variant,
                                         std::span<const patient::Parameter> parameters) {
  patient::Patient completed = patient;
  const bool keeps_tubes = HasSeenTubes(patient);
  constexpr std::string_view kMeasured = "measured_", kVariant = "unseen_variant";
  std::erase_if(completed.parameters, [&](const patient::Parameter& parameter) {
    const bool is_length = parameter.name.starts_with(kMeasured) && parameter.name.ends_with("_length");
    if (keeps_tubes && (is_length || IsOfTubes(parameter.name))) return false;
    return is_length || parameter.name.starts_with(kVariant) || IsUnseenParameter(parameter.name);
  });
  for (const patient::Parameter& parameter : parameters) {
    if (!keeps_tubes || !IsOfTubes(parameter.name)) completed.parameters.push_back(parameter);
  }
  if (!keeps_tubes) {
    if (const auto status = ReplaceTubes(completed, parameters); !status.ok()) return status.error();
    for (const patient::Tube& tube : completed.tubes) {
      double length = 0;
      for (std::size_t i = 1; i < tube.line.points.size(); ++i)
        length += Distance(tube.line.points[i - 1], tube.line.points[i]);
      completed.parameters.push_back({std::string(kMeasured) + tube.name + "_length",
                                      files::kMmPerMetre * length, "mm", "measured on the result"});
    }
    completed.parameters.push_back({std::string(kVariant) + "_probability", variant.probability, "",
                                    "product of its variations' shares, taken as independent"});
  }
  completed.parameters.push_back({std::string(kVariant), std::string(what), "", "trocar anatomy complete"});
  if (const auto status = patient::CheckPatient(completed); !status.ok()) return status.error();
  return completed;
}

}  // namespace trocar::anatomy
