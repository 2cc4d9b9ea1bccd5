// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::ErrorCode;

constexpr int kSeeds = 10'000;

std::vector<patient::Parameter> Draw(std::uint64_t seed, std::vector<ParameterSetting> settings = {}) {
  auto drawn = DrawParameters(seed, settings);
  EXPECT_TRUE(drawn.ok()) << drawn.error().Text();
  return drawn.ok() ? *drawn : std::vector<patient::Parameter>{};
}

/// Whether `hits` of `draws` lie within three standard deviations of the probability.
void ExpectFrequency(const std::string& what, double hits, double draws, double probability) {
  const double deviation = std::sqrt(draws * probability * (1 - probability));
  EXPECT_NEAR(hits, draws * probability, 3 * deviation) << what;
}

TEST(DrawParameters, GivesEveryRuleOnceAndTheSameForTheSameSeed) {
  const auto first = Draw(7);
  ASSERT_EQ(first.size(), ParameterRules().size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].name, ParameterRules()[i].name);
    EXPECT_TRUE(names.insert(first[i].name).second) << first[i].name;
    EXPECT_FALSE(first[i].source.empty()) << first[i].name;
  }
  EXPECT_EQ(first, Draw(7));
  EXPECT_NE(first, Draw(8));
}

TEST(DrawParameters, SettingOneLeavesTheOthersAsTheyWere) {
  const auto free = Draw(7), bound = Draw(7, {{"cystic_artery_length", "11.5"}});
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i].name != "cystic_artery_length") {
      EXPECT_EQ(free[i], bound[i]) << free[i].name;
    }
  }
  EXPECT_DOUBLE_EQ(NumberOf(bound, "cystic_artery_length"), 11.5);
}

TEST(DrawParameters, FrequenciesAndMomentsAreTheConfiguredOnes) {
  std::map<std::string, std::map<std::string, int>> words;
  std::map<std::string, double> sums, squares;
  int not_short = 0;
  std::map<std::string, int> classes;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto drawn = Draw(static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const ParameterRule& rule = ParameterRules()[i];
      if (const double* value = std::get_if<double>(&drawn[i].value)) {
        sums[drawn[i].name] += *value, squares[drawn[i].name] += *value * *value;
        if (rule.distribution != Distribution::kFixed && rule.name != "cystic_duct_length") {
          ASSERT_GE(*value, rule.low) << rule.name << ", seed " << seed;
          ASSERT_LE(*value, rule.high) << rule.name << ", seed " << seed;
        }
      } else {
        ++words[drawn[i].name][std::get<std::string>(drawn[i].value)];
      }
    }
    const std::string& length_class = TextOf(drawn, "cystic_duct_class");
    const LengthRange range = FindCysticDuctRange(length_class);
    const double length = NumberOf(drawn, "cystic_duct_length");
    ASSERT_TRUE(length >= range.low && length <= range.high) << "seed " << seed;
    if (TextOf(drawn, "cystic_duct_insertion") == "short") {
      ASSERT_EQ(length_class, "short");
    } else {
      ++not_short, ++classes[length_class];
    }
  }
  for (const ParameterRule& rule : ParameterRules()) {
    const std::string name(rule.name);
    if (rule.distribution == Distribution::kChance)
      ExpectFrequency(name, words[name]["yes"], kSeeds, rule.centre);
  }
  // the published shares leave 9.5 % of the patients without a type; they are shared out in proportion
  for (const Choice& type : FindInsertionSeries("hindawi_2016")) {
    const std::string name(type.name);
    ExpectFrequency(name, words["cystic_duct_insertion"][name], kSeeds, type.weight / 0.905);
  }
  ExpectFrequency("short class", classes["short"], not_short, 0.092);
  ExpectFrequency("long class", classes["long"], not_short, 0.077);
  // limits at two deviations to either side leave the mean and take some of the spread
  for (const char* name :
       {"hepatic_duct_length", "gallbladder_wall", "gallbladder_bend", "bile_duct_length"}) {
    const auto rule = std::find_if(ParameterRules().begin(), ParameterRules().end(),
                                   [&](const auto& r) { return r.name == name; });
    const double mean = sums[name] / kSeeds, deviation = std::sqrt(squares[name] / kSeeds - mean * mean);
    EXPECT_NEAR(mean, rule->centre, 4 * rule->spread / std::sqrt(kSeeds) + 0.02 * rule->spread) << name;
    EXPECT_GT(deviation, 0.8 * rule->spread) << name;
    EXPECT_LT(deviation, 1.02 * rule->spread) << name;
  }
}

TEST(DrawParameters, HalfOfThePatientsHaveOneStone) {
  int solitary = 0, small = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto drawn = Draw(static_cast<std::uint64_t>(seed));
    const double count = NumberOf(drawn, "gallstone_count");
    ASSERT_EQ(count, std::round(count)) << "seed " << seed;
    ASSERT_GE(count, 1.0);
    solitary += count == 1.0 ? 1 : 0;
    small += NumberOf(drawn, "gallstone_diameter") < 20.0 ? 1 : 0;
  }
  EXPECT_NEAR(solitary / double{kSeeds}, 0.50, 0.04);
  EXPECT_NEAR(small / double{kSeeds}, 0.90, 0.05);
  EXPECT_EQ(NumberOf(Draw(3, {{"gallstone_count", "0"}}), "gallstone_count"), 0.0);
}

TEST(DrawParameters, FollowsTheOtherSeriesWhenAsked) {
  std::map<std::string, int> types;
  constexpr int kDraws = 4000;
  for (int seed = 0; seed < kDraws; ++seed) {
    ++types[TextOf(Draw(static_cast<std::uint64_t>(seed), {{"cystic_duct_series", "iran_mrcp"}}),
                   "cystic_duct_insertion")];
  }
  ExpectFrequency("lateral", types["lateral"], kDraws, 0.77 / 0.987);
  ExpectFrequency("medial", types["medial"], kDraws, 0.076 / 0.987);
}

TEST(DrawParameters, RefusesWhatItDoesNotKnow) {
  const auto code = [](const char* name, const char* value) {
    const auto drawn = DrawParameters(1, std::vector<ParameterSetting>{{name, value}});
    return drawn.ok() ? ErrorCode::kNone : drawn.error().code;
  };
  EXPECT_EQ(code("hydrops", "0.5"), ErrorCode::kNone);
  EXPECT_EQ(code("hydrops", "1.5"), ErrorCode::kUsage);
  EXPECT_EQ(code("hydrops", "nan"), ErrorCode::kUsage);
  EXPECT_EQ(code("hydrops", "inf"), ErrorCode::kUsage);
  EXPECT_EQ(code("hydrops", ""), ErrorCode::kUsage);
  EXPECT_EQ(code("hydrops", "0.5x"), ErrorCode::kUsage);
  EXPECT_EQ(code("hydrop", "0.5"), ErrorCode::kUnknownName);
  EXPECT_EQ(code("moynihan_hump", "yes"), ErrorCode::kNone);
  EXPECT_EQ(code("moynihan_hump", "1"), ErrorCode::kUnknownName);
  EXPECT_EQ(code("cystic_duct_insertion", "sideways"), ErrorCode::kUnknownName);
}

constexpr double kNeck = 0.335;

TEST(GallbladderProfile, IsNarrowAtTheNeckAndWidestInTheBody) {
  EXPECT_LT(CalcGallbladderProfile(0, kNeck), 0.3);
  double widest = 0;
  for (int i = 0; i <= 100; ++i) widest = std::max(widest, CalcGallbladderProfile(0.01 * i, kNeck));
  EXPECT_NEAR(widest, 1.0, 0.01);
  EXPECT_LT(CalcGallbladderProfile(1, kNeck), 0.8);
  EXPECT_GT(CalcGallbladderProfile(1, kNeck), CalcGallbladderProfile(0.15, kNeck));
}

/// Measures of the Visible Human Male that are parameters: from its labels, then from contours on its photographs.
/// trocar anatomy from-labels labels.nii.gz -o out/labels
/// trocar anatomy measure out/labels assets/patients/visible-human-male/patient
struct RealMeasure {
  const char* name;
  double labels, contours;
};
constexpr RealMeasure kReal[] = {
    {"liver_transverse", 188, 191},     {"liver_vertical", 180, 180},
    {"liver_depth", 189, 196},          {"gallbladder_length", 77, 73},
    {"gallbladder_diameter", 28, 26.8}, {"gallbladder_neck", 12.5 / 28, 11.4 / 26.8},
    {"gallbladder_bend", 37.6, 34.5},   {"gallbladder_inclination", 21.3, 16.7},
    {"gallbladder_azimuth", 25, 23.3},  {"gallbladder_embedding", 0.491, 0.564},
};

/// Values of a parameter over many seeds, sorted.
std::vector<double> DrawSorted(const char* name, const std::vector<ParameterSetting>& settings) {
  constexpr std::uint64_t kDraws = 2000;
  std::vector<double> values;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) values.push_back(NumberOf(Draw(seed, settings), name));
  std::sort(values.begin(), values.end());
  return values;
}

TEST(Population, HoldsTheRealOneInEveryParameterThatIsMeasured) {
  for (const RealMeasure& real : kReal) {
    const auto values = DrawSorted(real.name, {});
    const double low = values[values.size() / 50], high = values[values.size() - 1 - values.size() / 50];
    for (const double value : {real.labels, real.contours}) {
      EXPECT_GT(value, low) << real.name << ": below the 2nd percentile";
      EXPECT_LT(value, high) << real.name << ": above the 98th percentile";
    }
  }
}

TEST(Population, IdealIsTheNarrowOneAndLeavesDuctsAsTheyWere) {
  const std::vector<ParameterSetting> ideal = {{"population", "ideal"}};
  const auto depths = DrawSorted("liver_depth", ideal);
  EXPECT_GE(depths.front(), 100);
  EXPECT_LE(depths.back(), 125) << "the real one, 189 mm, lies outside";
  EXPECT_GE(DrawSorted("gallbladder_inclination", ideal).front(), 42);
  EXPECT_LE(DrawSorted("gallbladder_embedding", ideal).back(), 0.48);
  const auto varied = Draw(7), narrow = Draw(7, ideal);
  EXPECT_EQ(TextOf(varied, "population"), "varied");
  EXPECT_EQ(TextOf(narrow, "population"), "ideal");
  EXPECT_EQ(TextOf(narrow, "hartmann_pouch"), "no");
  for (const char* name : {"cystic_duct_length", "bile_duct_diameter", "gallstone_diameter"})
    EXPECT_EQ(NumberOf(varied, name), NumberOf(narrow, name)) << name;
}

}  // namespace
}  // namespace trocar::anatomy
