// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_population.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <set>

#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

TEST(CalcChiSquareTail, HasTheValuesOfTheTables) {
  EXPECT_NEAR(CalcChiSquareTail(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(CalcChiSquareTail(5.991465, 2), 0.05, 1e-6);
  EXPECT_NEAR(CalcChiSquareTail(15.08627, 5), 0.01, 1e-6);
  EXPECT_NEAR(CalcChiSquareTail(2.0, 2), std::exp(-1.0), 1e-12);
  EXPECT_EQ(CalcChiSquareTail(0.0, 3), 1.0);
  EXPECT_LT(CalcChiSquareTail(400.0, 3), 1e-12);
}

TEST(CalcBinomialDeviation, IsInStandardDeviations) {
  EXPECT_NEAR(CalcBinomialDeviation(0.5, 60, 100), 2.0, 1e-12);
  EXPECT_NEAR(CalcBinomialDeviation(0.1, 70, 1000), -30 / std::sqrt(90.0), 1e-12);
  EXPECT_EQ(CalcBinomialDeviation(1.0, 5, 5), 0.0);
}

std::vector<std::vector<patient::Parameter>> DrawMany(std::size_t count,
                                                      const std::vector<ParameterSetting>& settings) {
  std::vector<std::vector<patient::Parameter>> all;
  for (std::size_t seed = 0; seed < count; ++seed) all.push_back(*DrawParameters(seed, settings));
  return all;
}

const VariationCount* Find(const std::vector<VariationCount>& variations, std::string_view name) {
  for (const VariationCount& variation : variations) {
    if (variation.parameter == name) return &variation;
  }
  return nullptr;
}

TEST(CountVariations, OfManyDrawsFitsWhatIsConfigured) {
  const auto variations = CountVariations(DrawMany(4000, {}));
  ASSERT_EQ(variations.size(), 7u);
  for (const VariationCount& variation : variations) {
    EXPECT_GT(variation.p_value, 0.001) << variation.parameter;
    double configured = 0;
    std::size_t observed = 0;
    for (const ValueCount& value : variation.values) {
      configured += value.configured, observed += value.observed;
      EXPECT_LT(std::fabs(CalcBinomialDeviation(value.configured, value.observed, variation.patients)), 4.0);
    }
    EXPECT_NEAR(configured, 1.0, 1e-12);
    EXPECT_EQ(observed, variation.patients) << variation.parameter;
  }
  // short ducts that follow from a short insertion are not draws of the class
  const VariationCount* insertion = Find(variations, "cystic_duct_insertion (hindawi_2016)");
  ASSERT_NE(insertion, nullptr);
  EXPECT_EQ(Find(variations, "cystic_duct_class")->patients, 4000 - insertion->values.back().observed);
}

TEST(CountVariations, SeesAFrequencyThatIsWrongAndSkipsWhatWasSet) {
  auto patients = DrawMany(1000, {{"phrygian_cap", "yes"}, {"cystic_duct_series", "iran_mrcp"}});
  EXPECT_EQ(Find(CountVariations(patients), "phrygian_cap"), nullptr);
  EXPECT_NE(Find(CountVariations(patients), "cystic_duct_insertion (iran_mrcp)"), nullptr);
  EXPECT_EQ(Find(CountVariations(patients), "cystic_duct_insertion (hindawi_2016)"), nullptr);
  // every tenth patient gets a hump that nobody configured
  for (std::size_t i = 0; i < patients.size(); i += 10) {
    for (patient::Parameter& parameter : patients[i]) {
      if (parameter.name == "moynihan_hump") parameter.value = std::string("yes");
    }
  }
  EXPECT_LT(Find(CountVariations(patients), "moynihan_hump")->p_value, 1e-6);
}

TEST(GeneratePopulation, ReportsTheSameForAnyNumberOfThreads) {
  PopulationSettings settings;
  settings.first_seed = 40, settings.count = 4;
  std::vector<std::uint64_t> seeds;
  std::size_t last = 0;
  const auto many = GeneratePopulation(
      settings,
      [&](std::uint64_t seed, const patient::Patient& patient) {
        seeds.push_back(seed);
        EXPECT_EQ(patient.organs.size(), 2u);
        return base::Status{};
      },
      [&](std::size_t done) { last = done; });
  ASSERT_TRUE(many.ok()) << many.error().Text();
  EXPECT_TRUE(many->IsSound());
  EXPECT_EQ(many->patients, 4u);
  EXPECT_EQ(many->meshes, 8u);
  EXPECT_EQ(last, 4u);
  EXPECT_EQ(std::set<std::uint64_t>(seeds.begin(), seeds.end()), (std::set<std::uint64_t>{40, 41, 42, 43}));
  EXPECT_GT(many->smallest_angle_deg, 8.0);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const auto single = GeneratePopulation(settings);
  ASSERT_TRUE(single.ok());
  EXPECT_EQ(single->smallest_angle_deg, many->smallest_angle_deg);
}

TEST(GeneratePopulation, EndsWithTheSinksErrorAndRefusesWrongSettings) {
  PopulationSettings settings;
  settings.count = 3;
  const auto ended = GeneratePopulation(settings, [](std::uint64_t, const patient::Patient&) -> base::Status {
    return base::Error{base::ErrorCode::kFileUnwritable, "the disk is full; free some space"};
  });
  ASSERT_FALSE(ended.ok());
  EXPECT_EQ(ended.error().code, base::ErrorCode::kFileUnwritable);
  settings.parameters = {{"horns", "yes"}};
  EXPECT_EQ(GeneratePopulation(settings).error().code, base::ErrorCode::kUnknownName);
  settings.count = 0;
  EXPECT_EQ(GeneratePopulation(settings).error().code, base::ErrorCode::kUsage);
}

// The figure of the documentation, docs/patients.md: about ten minutes of one processor.
TEST(GeneratePopulationSlow, AThousandPatientsAreSoundAndVaryAsConfigured) {
  PopulationSettings settings;
  settings.first_seed = 1, settings.count = 1000;
  const auto report = GeneratePopulation(settings);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  EXPECT_TRUE(report->IsSound());
  EXPECT_EQ(report->patients, 1000u);
  for (const VariationCount& variation : report->variations)
    EXPECT_GT(variation.p_value, 0.01 / static_cast<double>(report->variations.size()))
        << variation.parameter;
}

}  // namespace
}  // namespace trocar::anatomy
