// SPDX-License-Identifier: Apache-2.0
#include "trocar/procedures/operation_end.h"

#include <gtest/gtest.h>

#include "trocar/cholecystectomy/operation_error.h"

namespace trocar::procedures {
namespace {

using cholecystectomy::OperationError;
using simulation::OperationResult;

OperationResult With(OperationError error) {
  OperationResult result;
  result.procedure.errors = surgery::ErrorLog(cholecystectomy::OperationErrors());
  result.procedure.errors.Add({error, 1.0, {}, 0});
  return result;
}

TEST(OperationEnd, ABailOutCountsWhereNothingWasHarmed) {
  OperationResult whole;
  EXPECT_EQ(JudgeEnd(whole, true), OperationEnd::kConversion);
  EXPECT_EQ(JudgeEnd(whole, false), OperationEnd::kUnfinished) << "nobody said that it is over";
  EXPECT_EQ(JudgeEnd(With(OperationError::kExcessForce), true), OperationEnd::kConversion);
  whole.is_completed = true;
  EXPECT_EQ(JudgeEnd(whole, false), OperationEnd::kCompleted);
}

TEST(OperationEnd, ABailOutAfterTheHarmIsNone) {
  EXPECT_EQ(JudgeEnd(With(OperationError::kWrongStructureClipped), true), OperationEnd::kUnfinished);
  OperationResult found;
  found.procedure.findings = {{"strasberg", std::string_view("A"), false}};
  EXPECT_EQ(JudgeEnd(found, true), OperationEnd::kConversion);
  found.procedure.findings.push_back({"right_liver_without_blood", true, true});
  EXPECT_EQ(JudgeEnd(found, true), OperationEnd::kUnfinished);
}

TEST(OperationEnd, HasNames) {
  EXPECT_EQ(NameOf(OperationEnd::kCompleted), "completed");
  EXPECT_EQ(NameOf(OperationEnd::kConversion), "conversion");
  EXPECT_EQ(NameOf(OperationEnd::kUnfinished), "unfinished");
}

}  // namespace
}  // namespace trocar::procedures
