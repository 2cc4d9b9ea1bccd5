// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/files/patient_file.h"
#include "trocar/geometry/primitives.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

const patient::Patient& BuiltIn() {
  static const patient::Patient patient = [] {
    auto read =
        files::ReadPatient(std::string(TROCAR_SOURCE_DIR) + "/assets/patients/visible-human-male/patient");
    EXPECT_TRUE(read.ok()) << read.error().Text();
    return *read;
  }();
  return patient;
}
std::uint32_t TubeIndex(const patient::Patient& patient, std::string_view name) {
  const auto found =
      std::find_if(patient.tubes.begin(), patient.tubes.end(), [&](auto& t) { return t.name == name; });
  return static_cast<std::uint32_t>(found - patient.tubes.begin());
}
const patient::Region& RegionOf(const patient::Patient& patient, std::string_view organ,
                                std::string_view name) {
  const auto& regions = patient.organs[patient.FindOrgan(organ)].regions;
  return *std::find_if(regions.begin(), regions.end(), [&](auto& r) { return r.name == name; });
}
bool IsSame(const patient::Patient& a, const patient::Patient& b) {
  for (std::size_t i = 0; i < a.organs.size(); ++i) {
    if (!(a.organs[i].regions == b.organs[i].regions)) return false;
  }
  return a.attachments == b.attachments && a.tubes == b.tubes && a.landmarks == b.landmarks;
}

TEST(FindBrushVertices, StaysOnItsSideOfAThinLobe) {
  // a flat box: top and bottom 2 mm apart, divided finely
  auto mesh = geometry::MakeSphere({0, 0, 0}, 1, 5);
  for (auto& p : mesh.positions) p = {0.05 * p.x, 0.001 * p.y, 0.05 * p.z};
  const auto neighbours = geometry::FindVertexNeighbours(mesh.triangles, mesh.positions.size());
  const auto top = static_cast<std::uint32_t>(std::max_element(mesh.positions.begin(), mesh.positions.end(),
                                                               [](auto& a, auto& b) { return a.y < b.y; }) -
                                              mesh.positions.begin());
  const auto brush = FindBrushVertices(mesh, neighbours, top, mesh.positions[top], 0.01);
  EXPECT_TRUE(std::is_sorted(brush.begin(), brush.end()));
  EXPECT_GT(brush.size(), 20u);
  std::size_t within = 0;
  for (const auto& p : mesh.positions) within += Distance(p, mesh.positions[top]) <= 0.01 && p.y > 0;
  EXPECT_EQ(brush.size(), within);
  for (const auto v : brush) EXPECT_GT(mesh.positions[v].y, 0);
  EXPECT_EQ(FindBrushVertices(mesh, neighbours, top, mesh.positions[top], 0),
            (std::vector<std::uint32_t>{top}));
}

TEST(PaintRegion, AddsAndErasesAndMakesARegion) {
  patient::Patient patient = BuiltIn();
  const auto before = RegionOf(patient, "liver", patient::kFalciform).vertices;
  const std::uint32_t some[] = {7, 3, 7, before[0]};
  ASSERT_TRUE(PaintRegion(patient, "liver", patient::kFalciform, some, true).ok());
  const auto& painted = RegionOf(patient, "liver", patient::kFalciform).vertices;
  EXPECT_TRUE(std::is_sorted(painted.begin(), painted.end()));
  EXPECT_TRUE(std::binary_search(painted.begin(), painted.end(), 3u));
  ASSERT_TRUE(PaintRegion(patient, "liver", patient::kFalciform, some, false).ok());
  EXPECT_EQ(RegionOf(patient, "liver", patient::kFalciform).vertices.size(), before.size() - 1);
  ASSERT_TRUE(PaintRegion(patient, "liver", "bare_area", some, true).ok());
  EXPECT_EQ(RegionOf(patient, "liver", "bare_area").vertices.size(), 3u);
  EXPECT_TRUE(patient::CheckPatient(patient).ok());
}

TEST(PaintRegion, StrandsFollowTheBed) {
  patient::Patient patient = BuiltIn();
  const auto bed = RegionOf(patient, "gallbladder", patient::kGallbladderBed).vertices;
  const std::vector<std::uint32_t> half(bed.begin(),
                                        bed.begin() + static_cast<std::ptrdiff_t>(bed.size() / 2));
  ASSERT_TRUE(PaintRegion(patient, "gallbladder", patient::kGallbladderBed, half, false).ok());
  EXPECT_LT(patient.attachments.size(), 0.7 * BuiltIn().attachments.size());
  for (const auto& a : patient.attachments)
    EXPECT_FALSE(std::binary_search(half.begin(), half.end(), a.vertex_a));
  ASSERT_TRUE(PaintRegion(patient, "gallbladder", patient::kGallbladderBed, half, true).ok());
  // painted back, the strands are where they were (but for those whose weight the file's rounding moved)
  const auto as_set = [](const patient::Patient& p) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const auto& a : p.attachments) pairs.insert({a.vertex_a, a.vertex_b});
    return pairs;
  };
  const auto now = as_set(patient), once = as_set(BuiltIn());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> different;
  std::set_symmetric_difference(now.begin(), now.end(), once.begin(), once.end(),
                                std::back_inserter(different));
  EXPECT_LT(different.size(), once.size() / 50);
  // a vertex far from the liver joins the region, and no strand crosses the belly
  patient::Patient whole = BuiltIn();
  std::vector<std::uint32_t> all(whole.organs[whole.FindOrgan("gallbladder")].mesh.positions.size());
  for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = v;
  ASSERT_TRUE(PaintRegion(whole, "gallbladder", patient::kGallbladderBed, all, true).ok());
  for (const auto& finding : LintPatient(whole).findings) EXPECT_NE(finding.code, "L-ATTACHMENT-FAR");
}

TEST(PaintRegion, RefusesWhatIsNotThere) {
  patient::Patient patient = BuiltIn();
  const std::uint32_t far[] = {1u << 30};
  EXPECT_EQ(PaintRegion(patient, "liver", patient::kFalciform, far, true).error().code,
            base::ErrorCode::kPatientInvalid);
  EXPECT_EQ(PaintRegion(patient, "spleen", patient::kFalciform, {}, true).error().code,
            base::ErrorCode::kPatientInvalid);
  EXPECT_EQ(PaintRegion(patient, "liver", "../evil", {}, true).error().code,
            base::ErrorCode::kPatientInvalid);
  EXPECT_TRUE(IsSame(patient, BuiltIn()));
}

TEST(MoveTubePoint, DragsNeighboursAndWhatIsJoined) {
  patient::Patient patient = BuiltIn();
  JoinTubes(patient);
  const patient::Patient before = patient;
  const auto bile = TubeIndex(patient, "common_bile_duct");
  const math::Vec3 shift = {0.004, 0, 0.003};
  ASSERT_TRUE(MoveTubePoint(patient, bile, 0, patient.tubes[bile].line.points[0] + shift, 0.02).ok());
  EXPECT_NEAR(Distance(patient.tubes[bile].line.points[0], before.tubes[bile].line.points[0] + shift), 0,
              1e-12);
  // further points follow less
  double last = Norm(shift) + 1e-9;
  for (std::size_t i = 0; i < patient.tubes[bile].line.points.size(); ++i) {
    const double moved = Distance(patient.tubes[bile].line.points[i], before.tubes[bile].line.points[i]);
    EXPECT_LE(moved, last + 1e-12);
    last = moved;
  }
  EXPECT_EQ(last, 0);
  // the ducts that end there come along: every joint of before is one still
  const TubeGraph old_graph = MakeTubeGraph(before);
  for (const TubeNode& node : old_graph.nodes) {
    for (const TubeVertex& v : node.vertices) {
      EXPECT_NEAR(Distance(patient.tubes[v.tube].line.points[v.point],
                           patient.tubes[node.vertices[0].tube].line.points[node.vertices[0].point]),
                  0, 1e-12);
    }
  }
}

TEST(TubePoints, AreInsertedAndDeleted) {
  patient::Patient patient = BuiltIn();
  const auto duct = TubeIndex(patient, "cystic_duct");
  const auto before = patient.tubes[duct].line;
  const math::Vec3 middle = math::Lerp(before.points[3], before.points[4], 0.25);
  ASSERT_TRUE(InsertTubePoint(patient, duct, 3, middle).ok());
  EXPECT_EQ(patient.tubes[duct].line.points[4], middle);
  EXPECT_NEAR(patient.tubes[duct].line.radii[4], 0.75 * before.radii[3] + 0.25 * before.radii[4], 1e-12);
  ASSERT_TRUE(DeleteTubePoint(patient, duct, 4).ok());
  EXPECT_EQ(patient.tubes[duct].line, before);
  EXPECT_FALSE(
      InsertTubePoint(patient, duct, static_cast<std::uint32_t>(before.points.size() - 1), middle).ok());
  while (patient.tubes[duct].line.points.size() > 2) ASSERT_TRUE(DeleteTubePoint(patient, duct, 0).ok());
  EXPECT_FALSE(DeleteTubePoint(patient, duct, 0).ok());
  EXPECT_FALSE(DeleteTubePoint(patient, 99, 0).ok());
}

TEST(ScaleTubeRadius, GrowsHereAndLessBesideIt) {
  patient::Patient patient = BuiltIn();
  const auto duct = TubeIndex(patient, "common_bile_duct");
  const auto before = patient.tubes[duct].line.radii;
  ASSERT_TRUE(ScaleTubeRadius(patient, duct, 5, 1.5, 0.01).ok());
  EXPECT_NEAR(patient.tubes[duct].line.radii[5], 1.5 * before[5], 1e-12);
  EXPECT_GT(patient.tubes[duct].line.radii[6], before[6]);
  EXPECT_LT(patient.tubes[duct].line.radii[6] / before[6], 1.5);
  EXPECT_EQ(patient.tubes[duct].line.radii.back(), before.back());
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(ScaleTubeRadius(patient, duct, 5, 2, 0).ok());
  EXPECT_DOUBLE_EQ(patient.tubes[duct].line.radii[5], 0.015);
  EXPECT_FALSE(ScaleTubeRadius(patient, duct, 5, -1, 0).ok());
}

TEST(JoinTubeEnd, MovesTheEndToWhatItJoins) {
  patient::Patient patient = BuiltIn();
  const auto artery = TubeIndex(patient, "cystic_artery"), duct = TubeIndex(patient, "cystic_duct");
  ASSERT_TRUE(JoinTubeEnd(patient, artery, TubeEnd::kFrom, "cystic_duct").ok());
  EXPECT_EQ(patient.tubes[artery].from, "cystic_duct");
  const auto& line = patient.tubes[duct].line.points;
  EXPECT_NE(std::find(line.begin(), line.end(), patient.tubes[artery].line.points.front()), line.end());
  EXPECT_EQ(patient.tubes[artery].line.points.back(), BuiltIn().tubes[artery].line.points.back());
  ASSERT_TRUE(JoinTubeEnd(patient, artery, TubeEnd::kFrom, "").ok());
  EXPECT_TRUE(patient.tubes[artery].from.empty());
  EXPECT_EQ(JoinTubeEnd(patient, artery, TubeEnd::kTo, "aorta").error().code, base::ErrorCode::kUnknownName);
  EXPECT_EQ(JoinTubeEnd(patient, artery, TubeEnd::kTo, "cystic_artery").error().code,
            base::ErrorCode::kPatientInvalid);
}

TEST(RemoveTube, LetsGoOfItsName) {
  patient::Patient patient = BuiltIn();
  ASSERT_TRUE(RemoveTube(patient, TubeIndex(patient, "common_bile_duct")).ok());
  EXPECT_TRUE(patient.tubes[TubeIndex(patient, "cystic_duct")].to.empty());
  EXPECT_TRUE(patient::CheckPatient(patient).ok());
  EXPECT_EQ(FindMissingTubes(patient), (std::vector<std::string>{"common_bile_duct"}));
}

TEST(AddTemplateTube, PutsBackWhatIsMissing) {
  patient::Patient patient = BuiltIn();
  patient.tubes.clear();
  for (const auto& name : FindMissingTubes(patient)) ASSERT_TRUE(AddTemplateTube(patient, name).ok()) << name;
  EXPECT_TRUE(FindMissingTubes(patient).empty());
  EXPECT_FALSE(patient.tubes[0].is_seen);
  ASSERT_TRUE(patient::CheckPatient(patient).ok());
  const auto duct = patient.tubes[TubeIndex(patient, "cystic_duct")];
  EXPECT_NEAR(1e3 * geometry::CalcLength(duct.line), 35, 8);
  EXPECT_EQ(AddTemplateTube(patient, "cystic_duct").error().code, base::ErrorCode::kPatientInvalid);
  EXPECT_EQ(AddTemplateTube(patient, "aorta").error().code, base::ErrorCode::kUnknownName);
  std::erase_if(patient.landmarks, [](auto& l) { return l.name == "infundibulum"; });
  EXPECT_EQ(AddTemplateTube(patient, "cystic_duct").error().code, base::ErrorCode::kPatientInvalid);
}

TEST(AddTube, RefusesNamesAndLinesThatCannotBe) {
  patient::Patient patient = BuiltIn();
  const auto refuse = [&](patient::Tube tube) {
    EXPECT_EQ(AddTube(patient, std::move(tube)).error().code, base::ErrorCode::kPatientInvalid);
  };
  const geometry::CentreLine line{{{0, 0, 0}, {0, 0, 0.01}}, {0.001, 0.001}};
  refuse({"liver", patient::TubeKind::kDuct, "", "", line, true});
  refuse({"cystic_duct", patient::TubeKind::kDuct, "", "", line, true});
  refuse({"a b", patient::TubeKind::kDuct, "", "", line, true});
  refuse({"thin", patient::TubeKind::kDuct, "", "", {line.points, {0.001, 0}}, true});
  refuse({"short", patient::TubeKind::kDuct, "", "", {{{0, 0, 0}}, {0.001}}, true});
  EXPECT_TRUE(IsSame(patient, BuiltIn()));
}

TEST(PlaceLandmark, KeepsTheFundusOnTheGallbladder) {
  patient::Patient patient = BuiltIn();
  const math::Vec3 wanted = patient.FindLandmark("fundus")->position + math::Vec3{0.01, -0.02, 0.01};
  ASSERT_TRUE(PlaceLandmark(patient, "fundus", wanted).ok());
  for (const auto& finding : LintPatient(patient).findings) EXPECT_NE(finding.code, "L-LANDMARK-FAR");
  EXPECT_NE(patient.FindLandmark("fundus")->position, wanted);
  ASSERT_TRUE(PlaceLandmark(patient, "node_of_lund", {0.01, 0.02, 0.03}).ok());
  EXPECT_EQ(patient.FindLandmark("node_of_lund")->position, (math::Vec3{0.01, 0.02, 0.03}));
  EXPECT_FALSE(PlaceLandmark(patient, "fundus", {std::numeric_limits<double>::quiet_NaN(), 0, 0}).ok());
}

TEST(FindWhere, FindsEveryKindOfPlace) {
  const patient::Patient& patient = BuiltIn();
  for (const char* where :
       {"liver", "liver/falciform", "cystic_duct", "cystic_duct/to", "fundus", "gallbladder_bed"})
    EXPECT_TRUE(FindWhere(patient, where).has_value()) << where;
  EXPECT_EQ(*FindWhere(patient, "cystic_duct/from"),
            patient.tubes[TubeIndex(patient, "cystic_duct")].line.points.front());
  EXPECT_NEAR(FindWhere(patient, "liver/falciform")->x, -0.02, 0.08);
  EXPECT_FALSE(FindWhere(patient, "spleen").has_value());
}

}  // namespace
}  // namespace trocar::anatomy
