// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/tube_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/geometry/primitives.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

patient::Tube MakeTube(const char* name, patient::TubeKind kind, const char* from, const char* to,
                       const math::Vec3& a, const math::Vec3& b) {
  patient::Tube tube{name, kind, from, to, {}, true};
  constexpr int kParts = 10;
  for (int i = 0; i <= kParts; ++i) {
    tube.line.points.push_back(math::Lerp(a, b, static_cast<double>(i) / kParts));
    tube.line.radii.push_back(0.002);
  }
  return tube;
}

// a gallbladder, its duct, and the main duct that it joins in the middle
patient::Patient MakePatient() {
  patient::Patient patient;
  patient.organs = {{"gallbladder", geometry::MakeSphere({0, 0, 0}, 0.02, 3), {}}};
  patient.tubes = {
      MakeTube("cystic_duct", patient::TubeKind::kDuct, "gallbladder", "main", {0.02, 0, 0}, {0.0492, 0, 0}),
      MakeTube("main", patient::TubeKind::kDuct, "", "", {0.05, 0.04, 0}, {0.05, -0.04, 0}),
      MakeTube("artery", patient::TubeKind::kArtery, "", "gallbladder", {0.06, 0.02, 0}, {0.01, 0.0173, 0})};
  return patient;
}

TEST(TubeGraph, FindsJointsOrgansAndOpenEnds) {
  const patient::Patient patient = MakePatient();
  const TubeGraph graph = MakeTubeGraph(patient);
  const auto count = [&](TubeNode::Kind kind) {
    return std::count_if(graph.nodes.begin(), graph.nodes.end(),
                         [&](const TubeNode& n) { return n.kind == kind; });
  };
  EXPECT_EQ(count(TubeNode::Kind::kJoint), 1);
  EXPECT_EQ(count(TubeNode::Kind::kOrgan), 2);
  EXPECT_EQ(count(TubeNode::Kind::kOpen), 3);
  EXPECT_EQ(count(TubeNode::Kind::kNowhere), 0);
  // the main duct is cut in two by the joint
  ASSERT_EQ(graph.pieces.size(), 4u);
  EXPECT_EQ(graph.pieces[1].tube, 1u);
  EXPECT_EQ(graph.pieces[1].last, 5u);
  EXPECT_EQ(graph.pieces[2].first, 5u);
  EXPECT_EQ(graph.pieces[1].to, graph.pieces[2].from);
  EXPECT_EQ(graph.pieces[0].to, graph.pieces[1].to);
  EXPECT_EQ(FindEnteringTubes(patient, graph, roles::OrganRole::kGallbladder),
            (std::vector<std::uint32_t>{0, 2}));
  EXPECT_TRUE(FindEnteringTubes(patient, graph, roles::OrganRole::kLiver).empty());
  EXPECT_EQ(FindConnectedTubes(patient, graph, 0), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(FindConnectedTubes(patient, graph, 2), (std::vector<std::uint32_t>{2}));
  EXPECT_TRUE(FindCycleTubes(patient, graph).empty());
}

TEST(TubeGraph, EndsThatReachNothingAreNowhere) {
  patient::Patient patient = MakePatient();
  patient.tubes[0].to = "nobody";
  patient.tubes[1].from = "main";  // itself
  patient.tubes[2].from = "main";  // 8 mm away
  const TubeGraph graph = MakeTubeGraph(patient);
  int nowhere = 0;
  for (const TubeNode& node : graph.nodes) nowhere += node.kind == TubeNode::Kind::kNowhere;
  EXPECT_EQ(nowhere, 3);
}

TEST(TubeGraph, FindsCyclesOfOneKindOnly) {
  patient::Patient patient = MakePatient();
  // a duct from the main duct back to it
  patient.tubes.push_back(
      MakeTube("loop", patient::TubeKind::kDuct, "main", "main", {0.05, 0.03, 0}, {0.05, -0.03, 0}));
  EXPECT_EQ(FindCycleTubes(patient, MakeTubeGraph(patient)), (std::vector<std::uint32_t>{1, 3}));
  patient.tubes.back().kind = patient::TubeKind::kArtery;
  EXPECT_TRUE(FindCycleTubes(patient, MakeTubeGraph(patient)).empty());
  // two ducts between the gallbladder and the main duct: through an organ, so no cycle
  patient = MakePatient();
  patient.tubes.push_back(MakeTube("second", patient::TubeKind::kDuct, "gallbladder", "main",
                                   {0.0199, 0.002, 0}, {0.0495, 0.02, 0}));
  EXPECT_TRUE(FindCycleTubes(patient, MakeTubeGraph(patient)).empty());
  // a duct that hangs on the cycle is not part of it
  patient.tubes.push_back(
      MakeTube("link", patient::TubeKind::kDuct, "cystic_duct", "second", {0.03, 0, 0}, {0.03, 0.0082, 0}));
  EXPECT_EQ(FindCycleTubes(patient, MakeTubeGraph(patient)), (std::vector<std::uint32_t>{0, 1, 3, 4}));
}

TEST(TubeGraph, SurvivesLinesThatCannotBe) {
  patient::Patient patient = MakePatient();
  patient.tubes[1].line.points[3].x = NAN;
  patient.tubes.push_back({"empty", patient::TubeKind::kDuct, "gallbladder", "main", {}, true});
  const TubeGraph graph = MakeTubeGraph(patient);
  for (const TubePiece& piece : graph.pieces) EXPECT_TRUE(piece.tube == 0 || piece.tube == 2);
  EXPECT_TRUE(JoinTubes(patient).empty());
}

TEST(JoinTubes, MakesJointsExactAndKeepsTheLineSmooth) {
  patient::Patient patient = MakePatient();
  const auto before = patient.tubes[0].line.points;
  EXPECT_TRUE(JoinTubes(patient).empty());
  const auto& line = patient.tubes[0].line.points;
  EXPECT_EQ(line.back(), patient.tubes[1].line.points[5]);
  EXPECT_NEAR(Norm(line.front()), 0.02, 2e-4);
  for (std::size_t i = 1; i < line.size(); ++i)
    EXPECT_NEAR(Distance(line[i], line[i - 1]), Distance(before[i], before[i - 1]), 0.0003);
  const patient::Patient once = patient;
  JoinTubes(patient);  // nothing is left to do
  for (std::size_t i = 0; i < line.size(); ++i)
    EXPECT_NEAR(Distance(patient.tubes[0].line.points[i], once.tubes[0].line.points[i]), 0, 1e-12);
}

TEST(JoinTubes, LeavesWhatIsTooFarAndSaysSo) {
  patient::Patient patient = MakePatient();
  for (auto& p : patient.tubes[1].line.points) p.x += 0.02;
  const auto open = JoinTubes(patient);
  ASSERT_EQ(open.size(), 1u);
  EXPECT_EQ(open[0].tube, 0u);
  EXPECT_EQ(open[0].end, TubeEnd::kTo);
  EXPECT_NEAR(open[0].gap, 0.0188, 1e-4);
  EXPECT_NEAR(patient.tubes[0].line.points.back().x, 0.0492, 1e-12);
}

TEST(TubeGraph, GeneratedPatientIsOneTreeOfDuctsAndOneOfArteries) {
  const ParameterSetting settings[] = {{"double_cystic_artery", "yes"}, {"subvesical_duct", "yes"}};
  const auto patient = GeneratePatient(5, settings);
  ASSERT_TRUE(patient.ok());
  const TubeGraph graph = MakeTubeGraph(*patient);
  EXPECT_TRUE(FindCycleTubes(*patient, graph).empty());
  std::size_t cystic = 0, arteries = 0, ducts = 0;
  for (std::size_t t = 0; t < patient->tubes.size(); ++t) {
    if (patient->tubes[t].name == "cystic_duct") cystic = t;
    (patient->tubes[t].kind == patient::TubeKind::kDuct ? ducts : arteries) += 1;
  }
  EXPECT_EQ(FindConnectedTubes(*patient, graph, static_cast<std::uint32_t>(cystic)).size(), ducts);
  EXPECT_EQ(FindEnteringTubes(*patient, graph, roles::OrganRole::kGallbladder).size(),
            3u);  // duct and two arteries
  // joints are exact: every node's vertices share one place
  for (const TubeNode& node : graph.nodes) {
    EXPECT_NE(node.kind, TubeNode::Kind::kNowhere);
    for (const TubeVertex& v : node.vertices)
      EXPECT_EQ(patient->tubes[v.tube].line.points[v.point],
                patient->tubes[node.vertices[0].tube].line.points[node.vertices[0].point]);
  }
}

}  // namespace
}  // namespace trocar::anatomy
