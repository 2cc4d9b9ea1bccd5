// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/unseen_anatomy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::ErrorCode;
using testing::HasSubstr;

std::string ValueOf(const UnseenVariant& variant, std::string_view name) {
  for (const VariationShare& share : variant.shares) {
    if (share.name == name) return share.value;
  }
  return "";
}

double LengthMm(const patient::Patient& patient, roles::TubeRole role) {
  return 1e3 * geometry::CalcLength(patient.tubes.at(static_cast<std::size_t>(patient.TubeOf(role))).line);
}

const patient::Patient& SomePatient() {
  static const patient::Patient patient = *GeneratePatient(3);
  return patient;
}

// the shares of the published series, multiplied by hand
TEST(UnseenAnatomy, RanksCombinationsByTheirProbability) {
  const auto variants = RankUnseenVariants();
  ASSERT_TRUE(variants.ok());
  // five insertions in three classes and the short one in its own, with three things there or not
  EXPECT_EQ(variants->size(), (5u * 3 + 1) * 8);
  double sum = 0;
  for (const UnseenVariant& variant : *variants) sum += variant.probability;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_TRUE(std::is_sorted(variants->begin(), variants->end(),
                             [](const auto& a, const auto& b) { return a.probability > b.probability; }));
  const UnseenVariant& likely = variants->front();
  EXPECT_EQ(ValueOf(likely, "cystic_duct_insertion"), "lateral");
  EXPECT_EQ(ValueOf(likely, "moynihan_hump"), "no");
  EXPECT_EQ(likely.difficulty, 0);
  EXPECT_NEAR(likely.probability, 0.51 / 0.905 * 0.831 * 0.87 * (1 - 0.0381) * 0.96, 1e-12);
  EXPECT_EQ(ValueOf((*variants)[1], "cystic_duct_insertion"), "medial");
  EXPECT_NEAR((*variants)[1].probability, likely.probability * 0.16 / 0.51, 1e-12);
}

TEST(UnseenAnatomy, WhatIsSetIsCertain) {
  const std::vector<ParameterSetting> settings = {{"moynihan_hump", "yes"},
                                                  {"cystic_duct_insertion", "short"}};
  const auto variants = RankUnseenVariants(settings);
  ASSERT_TRUE(variants.ok());
  for (const UnseenVariant& variant : *variants) {
    EXPECT_EQ(ValueOf(variant, "moynihan_hump"), "yes");
    EXPECT_EQ(ValueOf(variant, "cystic_duct_class"), "short");
  }
  EXPECT_NEAR(variants->front().probability, 0.87 * 0.96, 1e-12);
  const std::vector<ParameterSetting> series = {{"cystic_duct_series", "iran_mrcp"}};
  EXPECT_NEAR(RankUnseenVariants(series)->front().probability,
              0.77 / 0.987 * 0.831 * 0.87 * (1 - 0.0381) * 0.96, 1e-12);
  const std::vector<ParameterSetting> wrong = {{"cystic_duct_insertion", "sideways"}};
  EXPECT_EQ(RankUnseenVariants(wrong).error().code, ErrorCode::kUnknownName);
}

TEST(UnseenAnatomy, TheWorstPlausibleIsTheHardestThatEnoughPeopleHave) {
  const auto variants = RankUnseenVariants();
  for (const double at_least : {0.05, 0.01, 0.001}) {
    const UnseenVariant& worst = FindWorstPlausible(*variants, at_least);
    EXPECT_GE(worst.probability, at_least);
    for (const UnseenVariant& other : *variants) {
      if (other.probability >= at_least) {
        EXPECT_LE(other.difficulty, worst.difficulty);
      }
    }
  }
  EXPECT_GT(FindWorstPlausible(*variants, 0.001).difficulty, FindWorstPlausible(*variants, 0.01).difficulty);
  EXPECT_EQ(&FindWorstPlausible(*variants, 1.0), &variants->front()) << "nothing is that likely";
}

TEST(UnseenAnatomy, NumbersAreTheMiddleOrTheHarderEndAndSayTheirSource) {
  const auto variants = RankUnseenVariants();
  const auto middle = MakeUnseenParameters(variants->front(), UnseenNumbers::kMiddle);
  const auto hard = MakeUnseenParameters(variants->front(), UnseenNumbers::kHard);
  ASSERT_TRUE(middle.ok() && hard.ok());
  EXPECT_DOUBLE_EQ(NumberOf(*middle, "gallbladder_wall"), 2.0);
  EXPECT_NEAR(NumberOf(*hard, "gallbladder_wall"), 2.0 + 1.959964 * 0.4, 1e-6);
  EXPECT_NEAR(NumberOf(*hard, "cystic_artery_length"), 20.8 * std::exp(-1.959964 * 0.2), 1e-6);
  EXPECT_DOUBLE_EQ(NumberOf(*middle, "gallstone_count"), 1.0) << "whole";
  EXPECT_DOUBLE_EQ(NumberOf(*middle, "adhesions"), 0.0);
  EXPECT_DOUBLE_EQ(NumberOf(*hard, "adhesions"), 0.5);
  const auto& insertion = *std::find_if(
      middle->begin(), middle->end(),
      [](const patient::Parameter& parameter) { return parameter.name == "cystic_duct_insertion"; });
  EXPECT_THAT(insertion.source, HasSubstr("n = 198; 56.4 % of people"));
  for (const patient::Parameter& parameter : *middle) {
    EXPECT_TRUE(IsUnseenParameter(parameter.name)) << parameter.name;
    EXPECT_FALSE(parameter.source.empty()) << parameter.name;
  }
  EXPECT_FALSE(IsUnseenParameter("gallbladder_length"));
}

TEST(UnseenAnatomy, CompletesAPatientByWhatIsGivenAndLeavesItsOrgans) {
  const patient::Patient& patient = SomePatient();
  const std::vector<ParameterSetting> settings = {{"cystic_duct_class", "short"},
                                                  {"double_cystic_artery", "yes"}};
  const auto variants = RankUnseenVariants(settings);
  const auto parameters = MakeUnseenParameters(variants->front(), UnseenNumbers::kMiddle, settings);
  ASSERT_TRUE(parameters.ok());
  const auto completed = CompletePatient(patient, "the most likely", variants->front(), *parameters);
  ASSERT_TRUE(completed.ok()) << completed.error().Text();
  for (const LintFinding& finding : LintPatient(*completed).findings)
    ADD_FAILURE() << finding.code << " " << finding.where << ": " << finding.text;
  EXPECT_NEAR(LengthMm(*completed, roles::TubeRole::kCysticDuct), 14.0, 3.0);
  EXPECT_GE(completed->FindTube("cystic_artery_deep"), 0);
  EXPECT_EQ(completed->organs[0].mesh.positions, patient.organs[0].mesh.positions);
  EXPECT_EQ(completed->attachments, patient.attachments);
  EXPECT_EQ(std::get<std::string>(completed->FindParameter("unseen_variant")->value), "the most likely");
  EXPECT_NEAR(std::get<double>(completed->FindParameter("unseen_variant_probability")->value),
              variants->front().probability, 1e-12);
  EXPECT_EQ(completed->FindParameter("double_cystic_artery")->source, "set by the user");
  // what the images show is the patient's own
  EXPECT_EQ(completed->FindParameter("gallbladder_length")->value,
            patient.FindParameter("gallbladder_length")->value);
  // once more, and nothing is there twice
  const auto again = CompletePatient(*completed, "the most likely", variants->front(), *parameters);
  ASSERT_TRUE(again.ok()) << again.error().Text();
  ASSERT_EQ(again->tubes.size(), completed->tubes.size());
  for (std::size_t i = 0; i < again->tubes.size(); ++i) {
    EXPECT_EQ(again->tubes[i].name, completed->tubes[i].name);
    EXPECT_NEAR(geometry::CalcLength(again->tubes[i].line), geometry::CalcLength(completed->tubes[i].line),
                1e-5);
  }
  EXPECT_EQ(again->parameters.size(), completed->parameters.size());
}

TEST(UnseenAnatomy, DrawsBySeedAndSaysHowLikelyItIs) {
  const auto variants = RankUnseenVariants();
  const auto one = DrawUnseenParameters(5), same = DrawUnseenParameters(5), other = DrawUnseenParameters(6);
  ASSERT_TRUE(one.ok() && same.ok() && other.ok());
  EXPECT_EQ(*one, *same);
  EXPECT_NE(*one, *other);
  const UnseenVariant variant = FindVariant(*variants, *one);
  EXPECT_EQ(ValueOf(variant, "moynihan_hump"), TextOf(*one, "moynihan_hump"));
  EXPECT_GT(variant.probability, 0.0);
}

TEST(UnseenAnatomy, KeepsDuctsAndArteriesThatAreSeen) {
  patient::Patient patient = SomePatient();
  patient.tubes.front().is_seen = true;
  const auto variants = RankUnseenVariants();
  const auto parameters = MakeUnseenParameters(variants->front(), UnseenNumbers::kHard);
  const auto completed = CompletePatient(patient, "the worst plausible", variants->front(), *parameters);
  ASSERT_TRUE(completed.ok()) << completed.error().Text();
  EXPECT_EQ(completed->tubes, patient.tubes);
  EXPECT_EQ(completed->FindParameter("cystic_duct_length")->value,
            patient.FindParameter("cystic_duct_length")->value);
  EXPECT_NE(completed->FindParameter("gallbladder_wall")->value,
            patient.FindParameter("gallbladder_wall")->value);
  EXPECT_EQ(completed->FindParameter("unseen_variant_probability"), nullptr);
}

TEST(UnseenAnatomy, NeedsOrgansAndANeck) {
  patient::Patient patient = SomePatient();
  std::erase_if(patient.landmarks,
                [](const patient::Landmark& it) { return it.role == roles::LandmarkRole::kInfundibulum; });
  const auto variants = RankUnseenVariants();
  const auto parameters = MakeUnseenParameters(variants->front(), UnseenNumbers::kMiddle);
  const auto completed = CompletePatient(patient, "", variants->front(), *parameters);
  ASSERT_FALSE(completed.ok());
  EXPECT_EQ(completed.error().code, ErrorCode::kPatientInvalid);
}

}  // namespace
}  // namespace trocar::anatomy
