// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triplet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace trocar::cholecystectomy {
namespace {

constexpr double kTick = 1.0 / 120;

/// Work of one kind for some seconds; every phase that was gone through, in order.
class Operation {
 public:
  void Do(InstrumentKind instrument, Verb verb, Target target, double seconds) {
    // the other hand holds the gallbladder all the time
    const Triplet acts[] = {{instrument, verb, target},
                            {InstrumentKind::kGrasper, Verb::kRetract, Target::kGallbladder}};
    for (int tick = 0; tick < static_cast<int>(std::lround(seconds / kTick)); ++tick) {
      phases_.Update(acts, facts, kTick);
      total_ += kTick;
      if (passed.empty() || passed.back() != NameOf(phases_.Current()))
        passed.emplace_back(NameOf(phases_.Current()));
    }
  }
  double Sum() const {
    double sum = 0;
    for (int phase = 0; phase < kPhaseCount; ++phase) sum += phases_.SecondsIn(static_cast<Phase>(phase));
    return sum;
  }
  OperationFacts facts;
  std::vector<std::string> passed;
  double total_ = 0;

 private:
  PhaseRecogniser phases_;
};

using enum InstrumentKind;

TEST(PhaseRecogniser, FollowsTheUsualOrder) {
  Operation operation;
  operation.Do(kGrasper, Verb::kGrasp, Target::kGallbladder, 20);
  operation.Do(kHook, Verb::kDissect, Target::kPeritoneum, 60);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 60);
  operation.Do(kClipper, Verb::kClip, Target::kCysticDuct, 9);
  operation.Do(kScissors, Verb::kCut, Target::kCysticDuct, 3);
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 120);
  operation.facts.is_gallbladder_free = true;
  operation.Do(kSpecimenBag, Verb::kPack, Target::kGallbladder, 20);
  operation.facts.is_gallbladder_in_bag = true;
  operation.Do(kIrrigator, Verb::kAspirate, Target::kFluid, 30);
  operation.facts.is_bag_leaving = true;
  operation.Do(kGrasper, Verb::kRetract, Target::kSpecimenBag, 10);
  EXPECT_EQ(operation.passed,
            (std::vector<std::string>{"Preparation", "CalotTriangleDissection", "ClippingCutting",
                                      "GallbladderDissection", "GallbladderPackaging", "CleaningCoagulation",
                                      "GallbladderRetraction"}));
  EXPECT_NEAR(operation.Sum(), operation.total_, 1e-6);
}

TEST(PhaseRecogniser, FollowsASurgeonWhoBeginsAtTheFundus) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 60);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 60);
  operation.Do(kClipper, Verb::kClip, Target::kCysticArtery, 6);
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 30);
  EXPECT_EQ(operation.passed,
            (std::vector<std::string>{"Preparation", "GallbladderDissection", "CalotTriangleDissection",
                                      "ClippingCutting", "GallbladderDissection"}));
}

TEST(PhaseRecogniser, IsNotShakenByASingleTouch) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  operation.Do(kHook, Verb::kCoagulate, Target::kLiver, 1);
  operation.Do(kIrrigator, Verb::kAspirate, Target::kFluid, 1.5);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  EXPECT_EQ(operation.passed, (std::vector<std::string>{"Preparation", "CalotTriangleDissection"}));
}

TEST(PhaseRecogniser, HoldingStillIsNoPhase) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  operation.Do(kGrasper, Verb::kRetract, Target::kGallbladder, 300);
  EXPECT_EQ(operation.passed.back(), "CalotTriangleDissection");
}

TEST(Triplet, NamesAreThoseOfTheDataSets) {
  EXPECT_EQ(NameOf(Triplet{kHook, Verb::kDissect, Target::kCysticPlate}), "hook,dissect,cystic_plate");
  EXPECT_EQ(NameOf(Triplet{}), "grasper,null_verb,null_target");
  std::set<std::string_view> names;
  for (int i = 0; i < static_cast<int>(Target::kCount); ++i) names.insert(NameOf(static_cast<Target>(i)));
  for (int i = 0; i < static_cast<int>(Verb::kCount); ++i) names.insert(NameOf(static_cast<Verb>(i)));
  EXPECT_EQ(names.size(), 25u);
  EXPECT_EQ(names.count(""), 0u);
}

}  // namespace
}  // namespace trocar::cholecystectomy
