// SPDX-License-Identifier: Apache-2.0
// What images of a patient do not show: the likeliest ways in which ducts and arteries run, and the patient with one of them.
#include <cstdio>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/shape_measures.h"
#include "trocar/anatomy/unseen_anatomy.h"

int main() {
  using namespace trocar::anatomy;
  // stands for a patient whose liver and gallbladder come from images
  const auto patient = GeneratePatient(3);
  if (!patient.ok()) return std::puts(patient.error().Text().c_str()), 1;

  // a cholangiogram has shown that the cystic duct joins low
  const std::vector<ParameterSetting> known = {{"cystic_duct_insertion", "low"}};
  const auto variants = RankUnseenVariants(known);
  if (!variants.ok()) return std::puts(variants.error().Text().c_str()), 1;
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("%4.1f %% of people with it:", 100 * (*variants)[i].probability);
    for (const VariationShare& share : (*variants)[i].shares)
      std::printf(" %s %s", share.name.c_str(), share.value.c_str());
    std::printf("\n");
  }
  const UnseenVariant& worst = FindWorstPlausible(*variants, 0.001);
  const auto parameters = MakeUnseenParameters(worst, UnseenNumbers::kHard, known);
  if (!parameters.ok()) return std::puts(parameters.error().Text().c_str()), 1;
  const auto completed = CompletePatient(*patient, "the worst plausible", worst, *parameters);
  if (!completed.ok()) return std::puts(completed.error().Text().c_str()), 1;
  const auto measures = MeasureShapes(*completed);
  if (!measures.ok()) return std::puts(measures.error().Text().c_str()), 1;
  for (const ShapeMeasure& measure : *measures) {
    if (measure.name == "infundibulum_to_hilum")
      std::printf("the worst plausible has %zu ducts and arteries, and %.0f mm from infundibulum to hilum\n",
                  completed->tubes.size(), measure.value);
  }
  return 0;
}
