// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_end.h"

#include <gtest/gtest.h>

namespace trocar::cholecystectomy {
namespace {

ErrorLog With(OperationError error) {
  ErrorLog log;
  log.Add({error, 1.0, {}, 0});
  return log;
}

TEST(OperationEnd, ABailOutCountsWhereNothingWasHarmed) {
  const ErrorLog none;
  const InjuryReport whole;
  EXPECT_EQ(JudgeEnd(true, false, none, whole), OperationEnd::kCompleted);
  EXPECT_EQ(JudgeEnd(false, true, none, whole), OperationEnd::kConversion);
  EXPECT_EQ(JudgeEnd(false, false, none, whole), OperationEnd::kUnfinished) << "nobody said that it is over";
  EXPECT_EQ(JudgeEnd(false, true, With(OperationError::kExcessForce), whole), OperationEnd::kConversion);
}

TEST(OperationEnd, ABailOutAfterTheHarmIsNone) {
  const InjuryReport whole;
  EXPECT_EQ(JudgeEnd(false, true, With(OperationError::kWrongStructureClipped), whole),
            OperationEnd::kUnfinished);
  InjuryReport hole;
  hole.strasberg = Strasberg::kD;
  EXPECT_EQ(JudgeEnd(false, true, {}, hole), OperationEnd::kUnfinished);
  InjuryReport leak;
  leak.strasberg = Strasberg::kA;
  EXPECT_EQ(JudgeEnd(false, true, {}, leak), OperationEnd::kConversion);
  InjuryReport pale;
  pale.is_right_liver_without_blood = true;
  EXPECT_EQ(JudgeEnd(false, true, {}, pale), OperationEnd::kUnfinished);
}

TEST(OperationEnd, HasNames) {
  EXPECT_EQ(NameOf(OperationEnd::kCompleted), "completed");
  EXPECT_EQ(NameOf(OperationEnd::kConversion), "conversion");
  EXPECT_EQ(NameOf(OperationEnd::kUnfinished), "unfinished");
}

}  // namespace
}  // namespace trocar::cholecystectomy
