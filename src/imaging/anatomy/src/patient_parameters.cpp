// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_parameters.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "trocar/base/assert.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using math::Cos;
using math::Exp;
using math::Log;

constexpr const char* kLiverSpread =
    "thecommonvein.net: 200 to 225 x 150 to 175 x 100 to 125 mm; our choice: wide enough for the "
    "Visible Human Male (191 x 180 x 196 mm)";
constexpr const char* kWideChoice = "our choice: wide enough for the Visible Human Male";
constexpr const char* kHindawi = "Hindawi, Radiology Research and Practice 2016, MRCP, n = 198";
constexpr const char* kLaparoscopic = "JGMDS 2025, laparoscopic series, n = 65";
constexpr const char* kArteryMeta = "meta-analysis of the cystic artery, 53 studies, 2024 (PubMed 38767077)";
constexpr const char* kGeneral = "general knowledge";
constexpr const char* kSlider = "a person's choice; what it does is general knowledge";

constexpr std::string_view kPopulation = "population", kIdealName = "ideal";
constexpr Choice kPopulations[] = {{"varied", 1}, {kIdealName, 0}};
constexpr Choice kSeries[] = {{"hindawi_2016", 1}, {"iran_mrcp", 0}};
constexpr Choice kHindawiTypes[] = {{"lateral", 0.51},   {"medial", 0.16}, {"low", 0.09},
                                    {"parallel", 0.075}, {"high", 0.06},   {"short", 0.01}};
constexpr Choice kIranTypes[] = {{"lateral", 0.77},  {"medial", 0.076}, {"low", 0.028},
                                 {"parallel", 0.01}, {"high", 0.10},    {"short", 0.003}};
constexpr Choice kLengthClasses[] = {{"normal", 0.831}, {"short", 0.092}, {"long", 0.077}};

using enum Distribution;

/// How parameters are drawn; numbers are in `unit`.
constexpr ParameterRule Number(std::string_view name, Distribution distribution, double centre, double spread,
                               double low, double high, double set_low, double set_high,
                               std::string_view unit, std::string_view about, std::string_view source) {
  return {name, distribution, centre, spread, low, high, set_low, set_high, {}, unit, about, source};
}
constexpr ParameterRule Chance(std::string_view name, double probability, std::string_view about,
                               std::string_view source) {
  return {name, kChance, probability, 0, 0, 0, 0, 0, {}, "", about, source};
}
constexpr ParameterRule Word(std::string_view name, std::span<const Choice> choices, std::string_view about,
                             std::string_view source) {
  return {name, kChoice, 0, 0, 0, 0, 0, 0, choices, "", about, source};
}
/// 0 unless a person wants up to 1 of it.
constexpr ParameterRule Slider(std::string_view name, std::string_view about) {
  return {name, kFixed, 0, 0, 0, 0, 0, 1, {}, "", about, kSlider};
}

constexpr ParameterRule kRules[] = {
    Word(kPopulation, kPopulations, "whom the shapes of liver and gallbladder are drawn from",
         "docs/shapes.md"),
    Number("liver_transverse", kNormal, 206, 14, 172, 240, 160, 260, "mm", "width, right to left",
           kLiverSpread),
    Number("liver_vertical", kNormal, 165, 12, 138, 196, 120, 210, "mm", "height of the right lobe",
           kLiverSpread),
    Number("liver_depth", kNormal, 150, 30, 100, 210, 80, 220, "mm",
           "front to back; a deep liver reaches back beside the spine", kLiverSpread),
    Number("liver_edge_rounding", kNormal, 8, 3, 3, 15, 3, 20, "mm", "blend of front and visceral face",
           kWideChoice),
    Number("right_lobe_taper", kNormal, 0.4, 0.3, 0, 1, 0, 1, "",
           "0: the right lobe's lower end is blunt, 1: a thin tongue", kWideChoice),
    Number("gallbladder_length", kNormal, 80, 12, 55, 112, 40, 150, "mm", "neck to fundus along the axis",
           "cadavers: 69 +- 8 mm (n = 60), 33 to 120 mm (n = 100); introductiontoradiology: 70 to 100 mm"),
    Number("gallbladder_diameter", kNormal, 30, 4.5, 21, 44, 15, 60, "mm", "largest",
           "cadavers: 36 +- 7 mm (n = 60), 20 to 50 mm (n = 100); introductiontoradiology: 30 mm"),
    Number("gallbladder_wall", kNormal, 2.0, 0.4, 1, 3, 0.5, 10, "mm",
           "thickness; not meshed, makes the wall stiffer",
           "radiology: at most 3 mm; mean and deviation: general knowledge"),
    Number("gallbladder_neck", kNormal, 0.39, 0.055, 0.26, 0.52, 0.2, 0.6, "",
           "diameter of the neck, as a share of the largest", kWideChoice),
    Number("gallbladder_bend", kNormal, 33, 16, 0, 75, 0, 80, "deg", "of the axis from neck to fundus",
           kWideChoice),
    Number(
        "gallbladder_inclination", kNormal, 47, 21, 12, 66, 8, 70, "deg",
        "of the axis below the axial plane; the visceral face follows",
        "Sanal 2016, CT: 49 +- 21 with stones, 53 +- 19 without; limits: as far as the liver's shape allows"),
    Number("gallbladder_azimuth", kNormal, 24, 10, 4, 50, 0, 60, "deg",
           "of the axis in the axial plane, from anterior to the patient's right", kWideChoice),
    Number("gallbladder_embedding", kNormal, 0.47, 0.11, 0.25, 0.7, 0.2, 0.75, "",
           "share of its diameter that lies in the fossa", kWideChoice),
    Number("fundus_overhang", kNormal, 9, 6, 0, 25, 0, 25, "mm", "fundus in front of the liver's edge",
           "cadavers: 4 to 25 mm below the inferior border (n = 100); the rest general knowledge"),
    Chance("hartmann_pouch", 0.52, "the infundibulum bulges beside the cystic duct",
           "van Eijck 2007: 51 of 98 gallbladders"),
    Number("hartmann_pouch_depth", kNormal, 4.5, 1.8, 2, 8, 1, 10, "mm", "where there is one", kWideChoice),
    Word("cystic_duct_series", kSeries, "whose frequencies the insertion follows", "docs/patients.md"),
    Word("cystic_duct_insertion", kHindawiTypes,
         "lateral, medial (from behind), low, parallel, high or short", kHindawi),
    Word("cystic_duct_class", kLengthClasses, "length class", kLaparoscopic),
    Number("cystic_duct_length", kNormal, 35, 2.5, 30, 40, 8, 60, "mm",
           "30 to 40; class short 8 to 20, long 42 to 60",
           "radiology: 30 to 40 mm; ranges of the other classes: general knowledge"),
    Number("cystic_duct_diameter", kLognormal, 2.5, 0.2, 1, 5, 1, 8, "mm", "outer", kGeneral),
    Number("hepatic_duct_length", kNormal, 30, 3, 24, 36, 10, 60, "mm",
           "common hepatic duct before the insertion moves its end", "radiology: about 30 mm"),
    Number("hepatic_duct_diameter", kNormal, 4.5, 0.6, 3, 6, 2, 12, "mm", "common hepatic duct",
           "radiology: at most 6 mm"),
    Number("bile_duct_length", kNormal, 75, 2.5, 70, 80, 30, 110, "mm",
           "common bile duct before the insertion moves its start", "radiology: 70 to 80 mm"),
    Number("bile_duct_diameter", kNormal, 4.1, 1.0, 2.5, 6, 2, 15, "mm", "common bile duct",
           "radiology: 4.1 +- 1.0 mm, at most 6 mm"),
    Number("cystic_artery_length", kLognormal, 20.8, 0.2, 10, 35, 6, 50, "mm", "each branch", kArteryMeta),
    Number("cystic_artery_diameter", kLognormal, 1.91, 0.15, 1, 3, 0.8, 4, "mm",
           "a branch of two has 0.8 of it", kArteryMeta),
    Number("hepatic_artery_diameter", kNormal, 3.0, 0.4, 2, 4, 1.5, 6, "mm", "right hepatic artery",
           kGeneral),
    Chance("double_cystic_artery", 0.13, "two branches", kArteryMeta),
    Chance("moynihan_hump", 0.0381, "the right hepatic artery loops to the gallbladder's neck",
           "Asghar 2023, pooled, n = 8418"),
    Chance("subvesical_duct", 0.04, "small duct along the gallbladder's bed", "Schnelldorfer 2012"),
    Number("subvesical_duct_diameter", kLognormal, 2.0, 0.25, 1, 3, 1, 6, "mm", "where there is one",
           "Schnelldorfer 2012: 2 mm (1 to 18); spread and upper limit: general knowledge"),
    Chance("phrygian_cap", 0.035, "the fundus is folded over", "general knowledge: 1 to 6 %"),
    Slider("hydrops", "0 none to 1: half as long again, a third wider; tense"),
    Slider("acute_cholecystitis", "0 none to 1: 80 x 40 mm at least (Tokyo guidelines); thick wall"),
    Slider("scleroatrophy", "0 none to 1: 45 mm long, a third narrower; thick, stiff wall"),
    Slider("steatosis", "0 none to 1: a quarter more volume, rounded edge"),
    Slider("cirrhosis", "0 none to 1: nodules, small right lobe, large caudate lobe; 11 times as stiff"),
    Slider("triangle_fibrosis", "0 none to 1, of the hepatocystic triangle: ducts and arteries held firmly"),
    Slider("adhesions", "0 none to 1: share of the free wall near the liver that has grown to it"),
    Number("gallstone_count", kLognormal, 0.9, 1.2, 0.5, 40, 0, 40, "", "whole; 0: no stones",
           "one stone in 71 of 141 patients (Dev, BCSRJ 2025); how many otherwise: general knowledge"),
    Number("gallstone_diameter", kLognormal, 8, 0.8, 2, 30, 1, 30, "mm", "median of this patient's stones",
           "85 % below 20 mm (gallbladdersurgery.co.uk); median and spread: general knowledge"),
};

/// What the population "ideal" draws otherwise: textbook sizes, one kind of shape.
struct IdealRange {
  std::string_view name;
  double centre = 0, spread = 0, low = 0, high = 0;
};
constexpr IdealRange kIdeal[] = {
    {"liver_transverse", 212, 7, 200, 225},   {"liver_vertical", 162, 7, 150, 175},
    {"liver_depth", 112, 7, 100, 125},        {"liver_edge_rounding", 9, 0, 9, 9},
    {"right_lobe_taper", 0, 0, 0, 0},         {"gallbladder_length", 85, 8, 70, 100},
    {"gallbladder_diameter", 32, 3, 27, 40},  {"gallbladder_neck", 0.335, 0, 0.335, 0.335},
    {"gallbladder_bend", 20, 8, 0, 40},       {"gallbladder_inclination", 48, 2.5, 42, 53},
    {"gallbladder_azimuth", 20, 1.5, 17, 25}, {"gallbladder_embedding", 0.36, 0.05, 0.25, 0.48},
    {"fundus_overhang", 8, 3, 2, 14},         {"hartmann_pouch", 0, 0, 0, 0},
};

/// Standard normal number (Box and Muller 1958).
double DrawNormal(math::Random& random) {
  const double u = 1.0 - random.Uniform(), v = random.Uniform();
  return std::sqrt(-2.0 * Log(u)) * Cos(2.0 * M_PI * v);
}

/// Draws until the value lies within the limits, which leave most of the distribution.
double DrawNumber(math::Random& random, Distribution distribution, double centre, double spread, double low,
                  double high) {
  constexpr int kMaxDraws = 1000;
  double value = centre;
  for (int i = 0; i < kMaxDraws; ++i) {
    const double z = spread * DrawNormal(random);
    value = distribution == kLognormal ? centre * Exp(z) : centre + z;
    if (value >= low && value <= high) return value;
  }
  return std::clamp(value, low, high);
}

std::string_view DrawChoice(math::Random& random, std::span<const Choice> choices) {
  double total = 0;
  for (const Choice& choice : choices) total += choice.weight;
  double left = total * random.Uniform();
  for (const Choice& choice : choices) {
    if (left < choice.weight) return choice.name;
    left -= choice.weight;
  }
  return choices.front().name;
}

/// One stream a parameter and round: FNV-1a of the name, mixed with the seed.
math::Random MakeStream(std::uint64_t seed, std::string_view name, int round) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  math::Random mixed(seed ^ hash);
  const std::uint64_t word = mixed.NextWord();
  return math::Random(word + static_cast<std::uint64_t>(round) * 0x9e3779b97f4a7c15ULL * 7919);
}

const ParameterRule* FindRule(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(kRules), std::end(kRules), [&](const auto& rule) { return rule.name == name; });
  return found == std::end(kRules) ? nullptr : found;
}

base::Result<patient::Parameter> ReadSetting(const ParameterRule& rule, const std::string& text) {
  patient::Parameter parameter{std::string(rule.name), 0.0, std::string(rule.unit), "set by the user"};
  const auto one_of = [&](std::span<const Choice> choices) -> base::Result<patient::Parameter> {
    std::string known;
    for (const Choice& choice : choices) {
      if (choice.name == text) {
        parameter.value = text;
        return parameter;
      }
      known += (known.empty() ? "" : ", ") + std::string(choice.name);
    }
    return Error{ErrorCode::kUnknownName,
                 parameter.name + " cannot be \"" + text + "\"; it is one of " + known};
  };
  constexpr Choice kYesNo[] = {{"yes", 0}, {"no", 0}};
  if (rule.distribution == kChance) return one_of(kYesNo);
  if (rule.distribution == kChoice) return one_of(rule.choices);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_number = !text.empty() && *end == '\0' && std::isfinite(value);
  if (!is_number || value < rule.set_low || value > rule.set_high) {
    char range[96];
    std::snprintf(range, sizeof range, "%g to %g %s", rule.set_low, rule.set_high,
                  std::string(rule.unit).c_str());
    return Error{ErrorCode::kUsage, parameter.name + ": \"" + text + "\" is no number of the range " + range};
  }
  parameter.value = value;
  return parameter;
}

constexpr double kMlPerCubicMm = 1e-3;
constexpr double kUsualNeck = 0.335;  // of the largest diameter

/// Volume of a generated liver of that size [mL]; a deep one fills less of its box (measured; a test holds it).
double CalcLiverVolume(const math::Vec3& size) {
  constexpr double kFill = 0.327, kLessWhenDeep = 0.06;
  const double deep = std::clamp((size.z / size.x - 0.55) / 0.45, 0.0, 1.0);
  return kMlPerCubicMm * (kFill - kLessWhenDeep * deep) * size.x * size.y * size.z;
}

}  // namespace

double CalcGallbladderProfile(double t, double neck) {
  // neck, body, fundus: knots of a smooth blend
  constexpr std::size_t kKnots = 6;
  const std::array<std::array<double, 2>, kKnots> knots = {
      {{0.0, 0.776 * neck}, {0.14, 1.254 * neck}, {0.4, 0.84}, {0.68, 1.0}, {0.86, 0.93}, {1.0, 0.74}}};
  t = std::clamp(t, 0.0, 1.0);
  for (std::size_t i = 0; i + 1 < kKnots; ++i) {
    if (t > knots[i + 1][0]) continue;
    const double h = knots[i + 1][0] - knots[i][0], part = (t - knots[i][0]) / h;
    const auto slope = [&](std::size_t k) {
      const std::size_t a = k == 0 ? 0 : k - 1, b = std::min(k + 1, kKnots - 1);
      return (knots[b][1] - knots[a][1]) / (knots[b][0] - knots[a][0]);
    };
    const double p2 = part * part, p3 = p2 * part;
    return (2 * p3 - 3 * p2 + 1) * knots[i][1] + (p3 - 2 * p2 + part) * h * slope(i) +
           (3 * p2 - 2 * p3) * knots[i + 1][1] + (p3 - p2) * h * slope(i + 1);
  }
  return knots[kKnots - 1][1];
}

namespace {

/// Volume of a gallbladder of that length and diameter [mL]: the body of revolution with round ends.
double CalcGallbladderVolume(double length, double diameter) {
  const double radius = 0.5 * diameter;
  const double first = radius * CalcGallbladderProfile(0, kUsualNeck),
               last = radius * CalcGallbladderProfile(1, kUsualNeck);
  const double body = length - first - last;
  constexpr int kSteps = 64;
  double volume = 2.0 / 3.0 * M_PI * (first * first * first + last * last * last);
  for (int i = 0; i < kSteps; ++i) {
    const double here = radius * CalcGallbladderProfile((i + 0.5) / kSteps, kUsualNeck);
    volume += M_PI * here * here * body / kSteps;
  }
  return kMlPerCubicMm * volume;
}

}  // namespace

std::span<const ParameterRule> ParameterRules() {
  return kRules;
}

std::span<const Choice> FindInsertionSeries(std::string_view series) {
  if (series == "hindawi_2016") return kHindawiTypes;
  if (series == "iran_mrcp") return kIranTypes;
  return {};
}

LengthRange FindCysticDuctRange(std::string_view length_class) {
  if (length_class == "short") return {14, 3, 8, 20};
  if (length_class == "long") return {50, 4, 42, 60};
  return {35, 2.5, 30, 40};
}

std::vector<ParameterSetting> MakeUsualSettings() {
  std::vector<ParameterSetting> settings;
  for (const ParameterRule& rule : ParameterRules()) {
    std::string value = std::to_string(rule.centre);
    if (rule.distribution == Distribution::kChance) value = "no";
    if (rule.distribution == Distribution::kChoice) value = std::string(rule.choices.front().name);
    settings.emplace_back(std::string(rule.name), value);
  }
  return settings;
}

double NumberOf(std::span<const patient::Parameter> parameters, std::string_view name) {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const patient::Parameter& parameter) { return parameter.name == name; });
  TROCAR_ASSERT(found != parameters.end() && std::holds_alternative<double>(found->value));
  return std::get<double>(found->value);
}

const std::string& TextOf(std::span<const patient::Parameter> parameters, std::string_view name) {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const patient::Parameter& parameter) { return parameter.name == name; });
  TROCAR_ASSERT(found != parameters.end() && std::holds_alternative<std::string>(found->value));
  return std::get<std::string>(found->value);
}

namespace {

base::Result<std::vector<patient::Parameter>> ReadSettings(std::span<const ParameterSetting> settings) {
  std::vector<patient::Parameter> set;
  for (const auto& [name, text] : settings) {
    const ParameterRule* rule = FindRule(name);
    if (rule == nullptr) {
      std::string known;
      for (const ParameterRule& each : kRules) known += (known.empty() ? "" : ", ") + std::string(each.name);
      return Error{ErrorCode::kUnknownName, "there is no parameter \"" + name + "\"; known are " + known};
    }
    base::Result<patient::Parameter> parameter = ReadSetting(*rule, text);
    if (!parameter.ok()) return parameter.error();
    std::erase_if(set, [rule](const patient::Parameter& earlier) { return earlier.name == rule->name; });
    set.push_back(std::move(*parameter));
  }
  return set;
}

/// The rule as the population has it.
ParameterRule RuleFor(const ParameterRule& rule, bool is_ideal) {
  ParameterRule changed = rule;
  const auto* found = std::find_if(std::begin(kIdeal), std::end(kIdeal),
                                   [&](const IdealRange& range) { return range.name == rule.name; });
  if (!is_ideal || found == std::end(kIdeal)) return changed;
  changed.centre = found->centre, changed.spread = found->spread;
  changed.low = found->low, changed.high = found->high;
  changed.source = "follows from the population: textbook sizes, one kind of shape";
  return changed;
}

/// \param drawn  the parameters before this one
patient::Parameter DrawOne(std::uint64_t seed, const ParameterRule& rule,
                           std::span<const patient::Parameter> drawn) {
  math::Random random = MakeStream(seed, rule.name, 0);
  patient::Parameter parameter{std::string(rule.name), 0.0, std::string(rule.unit), std::string(rule.source)};
  if (rule.name == "cystic_duct_series" || rule.name == kPopulation) {
    parameter.value = std::string(rule.choices.front().name);
  } else if (rule.name == "cystic_duct_insertion") {
    const std::string& series = TextOf(drawn, "cystic_duct_series");
    parameter.value = std::string(DrawChoice(random, FindInsertionSeries(series)));
    if (series == "iran_mrcp") parameter.source = "IJMS, MRCP, Iran, n = 290";
  } else if (rule.name == "cystic_duct_class" && TextOf(drawn, "cystic_duct_insertion") == "short") {
    parameter.value = std::string("short");
    parameter.source = "follows from the insertion";
  } else if (rule.name == "cystic_duct_length") {
    const LengthRange range = FindCysticDuctRange(TextOf(drawn, "cystic_duct_class"));
    parameter.value = DrawNumber(random, kNormal, range.mean, range.deviation, range.low, range.high);
  } else if (rule.distribution == kChance) {
    parameter.value = std::string(random.Uniform() < rule.centre ? "yes" : "no");
  } else if (rule.distribution == kChoice) {
    parameter.value = std::string(DrawChoice(random, rule.choices));
  } else if (rule.distribution == kFixed) {
    parameter.value = rule.centre;
    parameter.source = "not present unless it is set";
  } else {
    parameter.value = DrawNumber(random, rule.distribution, rule.centre, rule.spread, rule.low, rule.high);
    if (rule.name == "gallstone_count") parameter.value = std::round(std::get<double>(parameter.value));
  }
  return parameter;
}

struct VolumeLimits {
  double low = 0, high = 0;  // mL
};

}  // namespace

base::Result<std::vector<patient::Parameter>> DrawParameters(std::uint64_t seed,
                                                             std::span<const ParameterSetting> settings) {
  const auto set = ReadSettings(settings);
  if (!set.ok()) return set.error();
  const auto find_set = [&](std::string_view name) -> const patient::Parameter* {
    const auto found = std::find_if(set->begin(), set->end(), [&](const auto& p) { return p.name == name; });
    return found == set->end() ? nullptr : &*found;
  };
  const patient::Parameter* population = find_set(kPopulation);
  const bool is_ideal = population != nullptr && std::get<std::string>(population->value) == kIdealName;

  std::vector<patient::Parameter> drawn;
  for (const ParameterRule& rule : kRules) {
    const patient::Parameter* parameter = find_set(rule.name);
    drawn.push_back(parameter != nullptr ? *parameter : DrawOne(seed, RuleFor(rule, is_ideal), drawn));
  }

  // sizes together, until the volume fits
  const auto redraw = [&](std::initializer_list<std::string_view> names, auto volume_of,
                          const VolumeLimits& limits) {
    constexpr int kMaxRounds = 1000;
    if (std::any_of(names.begin(), names.end(), [&](auto name) { return find_set(name) != nullptr; })) return;
    for (int round = 1; round < kMaxRounds && (volume_of() < limits.low || volume_of() > limits.high);
         ++round) {
      for (const auto name : names) {
        const ParameterRule rule = RuleFor(*FindRule(name), is_ideal);
        math::Random random = MakeStream(seed, name, round);
        const auto parameter =
            std::find_if(drawn.begin(), drawn.end(), [&](auto& p) { return p.name == name; });
        parameter->value =
            DrawNumber(random, rule.distribution, rule.centre, rule.spread, rule.low, rule.high);
      }
    }
  };
  const auto number = [&](std::string_view name) { return NumberOf(drawn, name); };
  redraw(
      {"liver_transverse", "liver_vertical", "liver_depth"},
      [&] {
        return CalcLiverVolume({number("liver_transverse"), number("liver_vertical"), number("liver_depth")});
      },
      is_ideal ? VolumeLimits{1200, 1500} : VolumeLimits{950, 2050});
  redraw(
      {"gallbladder_length", "gallbladder_diameter"},
      [&] { return CalcGallbladderVolume(number("gallbladder_length"), number("gallbladder_diameter")); },
      is_ideal ? VolumeLimits{30, 50} : VolumeLimits{16, 60});
  return drawn;
}

}  // namespace trocar::anatomy
