// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/physics_checks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trocar::bench {
namespace {

void ExpectAllPass(const PhysicsCheck& check) {
  EXPECT_FALSE(check.figures.empty());
  for (const CheckFigure& figure : check.figures) {
    if (!figure.is_known_limit) {
      EXPECT_TRUE(figure.Passes()) << check.title << ": " << figure.name << " " << figure.value;
    }
  }
}

TEST(PhysicsChecks, AnalyticCasesPass) {
  for (const auto run : {CheckPatch, CheckHangingChain, CheckSelfWeight, CheckMeshRefinement,
                         CheckRodCantilever, CheckRodBuckling, CheckRodRing, CheckRodCatenary})
    ExpectAllPass(run());
}

TEST(PhysicsChecks, TheMeshRefinementConverges) {
  const PhysicsCheck check = CheckMeshRefinement();
  const auto& points = check.lines.at(0).points;
  ASSERT_EQ(points.size(), 4u);
  EXPECT_LT(std::fabs(points.back().y), std::fabs(points.front().y));
}

TEST(ReportCard, ShowsEachFigureItsVerdictAndEscapesText) {
  const double nan = std::nan("");
  const std::vector<PhysicsCheck> checks{{"A < B",
                                          "how & why",
                                          {{"good", 1.0, 0.5, 2.0, "N"},
                                           {"bad", 3.0, 0.5, 2.0, "N"},
                                           {"lost", nan, 0.0, 1.0, ""},
                                           {"limit", 9.0, 0.0, 1.0, "", true}},
                                          {"t", "x", "y"},
                                          {{"l", {{0, 0}, {1, 1}}}}}};
  EXPECT_EQ(CountFailures(checks), 2) << "too large, and no number at all";
  const std::string page = FormatReportCard(checks, "a machine");
  for (const char* text : {"A &lt; B", "how &amp; why", "passes", "FAILS", "a known limit", "<svg",
                           "1 of 4 figures hold", "a machine", "0.5 to 2"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(page.find("http"), std::string::npos) << "nothing from elsewhere";
}

}  // namespace
}  // namespace trocar::bench
