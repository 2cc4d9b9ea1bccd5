// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/workflow_recogniser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
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
    const SeenAct acts[] = {{{instrument, verb, target}, kTick},
                            {{InstrumentKind::kGrasper, Verb::kRetract, Target::kGallbladder}, kTick}};
    Go(acts, seconds);
  }
  /// What is done at once, by a tool that is there for some seconds.
  void DoOnce(InstrumentKind instrument, Verb verb, Target target, double seconds) {
    const SeenAct act[] = {{{instrument, verb, target}, 1.0}};
    Go(act, kTick);
    Do(instrument, Verb::kNullVerb, Target::kNullTarget, seconds);
  }
  void Divide() {
    DoOnce(InstrumentKind::kClipper, Verb::kClip, Target::kCysticDuct, 5);
    facts.has_divided = true;
    DoOnce(InstrumentKind::kClipper, Verb::kClip, Target::kCysticArtery, 5);
    DoOnce(InstrumentKind::kScissors, Verb::kCut, Target::kCysticDuct, 3);
    facts.structures_entering = 1;
    DoOnce(InstrumentKind::kScissors, Verb::kCut, Target::kCysticArtery, 3);
    facts.structures_entering = 0;
  }
  double Sum() const {
    double sum = 0;
    for (int phase = 0; phase < kPhaseCount; ++phase) sum += phases_.SecondsIn(static_cast<Phase>(phase));
    return sum;
  }
  double SecondsIn(Phase phase) const { return phases_.SecondsIn(phase); }
  WorkflowFacts facts{.structures_entering = 2};
  std::vector<std::string> passed;
  double total_ = 0;

 private:
  void Go(std::span<const SeenAct> acts, double seconds) {
    for (int tick = 0; tick < static_cast<int>(std::lround(seconds / kTick)); ++tick) {
      phases_.Update(acts, facts, kTick);
      total_ += kTick;
      if (passed.empty() || passed.back() != NameOf(phases_.Current()))
        passed.emplace_back(NameOf(phases_.Current()));
    }
  }
  WorkflowRecogniser phases_;
};

using enum InstrumentKind;

const std::vector<std::string> kUsualOrder = {
    "Preparation",          "CalotTriangleDissection", "ClippingCutting",      "GallbladderDissection",
    "GallbladderPackaging", "CleaningCoagulation",     "GallbladderRetraction"};

TEST(WorkflowRecogniser, FollowsTheUsualOrder) {
  Operation operation;
  operation.Do(kGrasper, Verb::kGrasp, Target::kGallbladder, 20);
  operation.Do(kHook, Verb::kDissect, Target::kPeritoneum, 60);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 60);
  // the lower third comes off for the critical view
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 60);
  operation.Divide();
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 120);
  operation.facts.is_gallbladder_free = true;
  operation.Do(kSpecimenBag, Verb::kPack, Target::kGallbladder, 20);
  operation.facts.is_gallbladder_in_bag = true;
  operation.Do(kIrrigator, Verb::kAspirate, Target::kFluid, 30);
  operation.facts.is_bag_leaving = true;
  operation.Do(kGrasper, Verb::kRetract, Target::kSpecimenBag, 10);
  EXPECT_EQ(operation.passed, kUsualOrder);
  EXPECT_NEAR(operation.Sum(), operation.total_, 1e-6);
}

TEST(WorkflowRecogniser, ABagThatIsHeldMeanwhileDoesNotEndTheCleaning) {
  Operation operation;
  operation.facts.is_gallbladder_free = operation.facts.is_gallbladder_in_bag = true;
  operation.Do(kSpecimenBag, Verb::kPack, Target::kGallbladder, 3);
  EXPECT_EQ(operation.passed.back(), "GallbladderPackaging") << "it closes in the tick in which it comes";
  for (int pause = 0; pause < 5; ++pause) {
    operation.Do(kIrrigator, Verb::kIrrigate, Target::kAbdominalWallCavity, 2);
    operation.Do(kSpecimenBag, Verb::kPack, Target::kGallbladder, 3);
  }
  EXPECT_EQ(operation.passed,
            (std::vector<std::string>{"Preparation", "GallbladderPackaging", "CleaningCoagulation"}));
}

// issue 47: blunt dissection was none, and the preparation lasted until the hook came
TEST(WorkflowRecogniser, SpreadingTheTriangleIsItsDissection) {
  Operation operation;
  operation.Do(kGrasper, Verb::kRetract, Target::kGallbladder, 8);
  operation.DoOnce(kBipolar, Verb::kDissect, Target::kCysticPedicle, 3);
  operation.DoOnce(kBipolar, Verb::kDissect, Target::kCysticPedicle, 3);
  EXPECT_EQ(operation.passed.back(), "CalotTriangleDissection");
  EXPECT_NEAR(operation.SecondsIn(Phase::kPreparation), 8, 0.1);
}

TEST(WorkflowRecogniser, AClipApplierBeginsTheClippingAndAHookTheBed) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 10);
  operation.Do(kClipper, Verb::kNullVerb, Target::kNullTarget, 0.5);
  EXPECT_EQ(operation.passed.back(), "CalotTriangleDissection") << "it only went by in the tray";
  operation.Do(kClipper, Verb::kNullVerb, Target::kNullTarget, 2);
  EXPECT_EQ(operation.passed.back(), "ClippingCutting");
  operation.Divide();
  operation.Do(kHook, Verb::kNullVerb, Target::kNullTarget, 4);
  EXPECT_EQ(operation.passed.back(), "GallbladderDissection");
}

TEST(WorkflowRecogniser, ComesBackToTheTriangleOnlyBeforeAnythingIsDivided) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 10);
  operation.Do(kClipper, Verb::kNullVerb, Target::kNullTarget, 4);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 10);
  EXPECT_EQ(operation.passed.back(), "CalotTriangleDissection") << "the applier was put away unused";
  operation.DoOnce(kClipper, Verb::kClip, Target::kCysticDuct, 5);
  operation.facts.has_divided = true;
  operation.Do(kHook, Verb::kDissect, Target::kCysticArtery, 30);
  EXPECT_EQ(operation.passed.back(), "ClippingCutting") << "freeing the second structure is part of it";
}

TEST(WorkflowRecogniser, FollowsASurgeonWhoBeginsAtTheFundus) {
  Operation operation;
  operation.facts.is_upper_bed = true;
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 60);
  operation.facts.is_upper_bed = false;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 60);
  operation.Divide();
  operation.Do(kHook, Verb::kDissect, Target::kCysticPlate, 30);
  EXPECT_EQ(operation.passed,
            (std::vector<std::string>{"Preparation", "GallbladderDissection", "CalotTriangleDissection",
                                      "ClippingCutting", "GallbladderDissection"}));
}

TEST(WorkflowRecogniser, IsNotShakenByASingleTouch) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  operation.Do(kHook, Verb::kCoagulate, Target::kLiver, 3);
  operation.Do(kIrrigator, Verb::kAspirate, Target::kFluid, 15);
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  EXPECT_EQ(operation.passed, (std::vector<std::string>{"Preparation", "CalotTriangleDissection"}));
}

TEST(WorkflowRecogniser, HoldingStillIsNoPhase) {
  Operation operation;
  operation.Do(kHook, Verb::kDissect, Target::kCysticDuct, 30);
  operation.Do(kGrasper, Verb::kRetract, Target::kGallbladder, 300);
  EXPECT_EQ(operation.passed.back(), "CalotTriangleDissection");
}

}  // namespace
}  // namespace trocar::cholecystectomy
