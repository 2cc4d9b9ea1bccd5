// SPDX-License-Identifier: Apache-2.0
// Rebuilds the built-in patient from the photographs and holds it against the reference labels.
#include "trocar/anatomy/build_patient.h"
#include "trocar/contours/control_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/safe_file.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

const fs::path kData = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male";
const fs::path kAssets = fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male";

const patient::Region* FindRegion(const patient::Organ& organ, std::string_view name) {
  for (const patient::Region& region : organ.regions) {
    if (region.name == name) return &region;
  }
  return nullptr;
}

void ExpectUsablePatient(const patient::Patient& patient) {
  ASSERT_TRUE(patient::CheckPatient(patient).ok());
  const patient::Organ& liver = patient.organs.at(patient.FindOrgan("liver"));
  const patient::Organ& gallbladder = patient.organs.at(patient.FindOrgan("gallbladder"));
  EXPECT_LE(liver.mesh.triangles.size(), 5132u);
  EXPECT_GE(liver.mesh.triangles.size(), 5030u);
  EXPECT_LE(gallbladder.mesh.triangles.size(), 1798u);
  EXPECT_GE(gallbladder.mesh.triangles.size(), 1763u);
  for (const patient::Organ* organ : {&liver, &gallbladder}) {
    const auto report = geometry::InspectMesh(organ->mesh);
    EXPECT_TRUE(report.closed && report.manifold && report.outward) << organ->name;
    EXPECT_EQ(report.components, 1u) << organ->name;
    EXPECT_EQ(geometry::CountSelfIntersections(organ->mesh), 0u) << organ->name;
  }

  // the four rules, and what they must leave free
  for (const char* name :
       {patient::kDiaphragmaticFace, patient::kFalciform, patient::kCoronary, patient::kGallbladderBed}) {
    ASSERT_NE(FindRegion(liver, name), nullptr);
    EXPECT_GE(FindRegion(liver, name)->vertices.size(), 8u) << name;
  }
  std::vector<math::Vec3> normals(liver.mesh.positions.size());
  geometry::CalcVertexNormals(liver.mesh.positions, liver.mesh.triangles, normals);
  const meshing::NearestSurface gallbladder_surface(gallbladder.mesh);
  std::vector<std::uint32_t> fixed;
  for (const char* name : {patient::kDiaphragmaticFace, patient::kFalciform, patient::kCoronary}) {
    const auto& vertices = FindRegion(liver, name)->vertices;
    fixed.insert(fixed.end(), vertices.begin(), vertices.end());
  }
  EXPECT_LT(fixed.size(), liver.mesh.positions.size() / 2);
  for (const auto v : fixed) {
    EXPECT_GT(gallbladder_surface.Find(liver.mesh.positions[v]).distance, 0.012);
    EXPECT_FALSE(normals[v].y < -0.6 && normals[v].z < 0.6 && normals[v].x > -0.6)
        << "an inferior vertex is fixed";
  }
  const auto& bed = FindRegion(liver, patient::kGallbladderBed)->vertices;
  for (const auto v : bed) EXPECT_EQ(std::count(fixed.begin(), fixed.end(), v), 0);

  // a contact surface, no deep overlap
  const meshing::NearestSurface liver_surface(liver.mesh);
  for (const auto& p : gallbladder.mesh.positions) {
    if (liver_surface.IsInside(p)) {
      EXPECT_LT(liver_surface.Find(p).distance, 0.0015);
    }
  }
  EXPECT_GT(patient.attachments.size(), 100u);
  for (const patient::Attachment& a : patient.attachments) {
    EXPECT_LT(Distance(patient.organs[a.organ_a].mesh.positions[a.vertex_a],
                       patient.organs[a.organ_b].mesh.positions[a.vertex_b]),
              0.015);
  }

  // frame: the fundus where domain facts put it, infundibulum above and behind it
  ASSERT_NE(patient.FindLandmark("fundus"), nullptr);
  const auto fundus = patient.FindLandmark("fundus")->position,
             infundibulum = patient.FindLandmark("infundibulum")->position;
  EXPECT_LT(Distance(fundus, {-0.075, 0.095, -0.070}), 1e-9);
  EXPECT_GT(infundibulum.y, fundus.y);
  EXPECT_LT(infundibulum.z, fundus.z);
  EXPECT_NEAR(Distance(fundus, infundibulum), 0.075, 0.025);

  // ducts and arteries of human size, joined where anatomy joins them
  const auto tube = [&](std::string_view name) -> const patient::Tube& {
    return *std::find_if(patient.tubes.begin(), patient.tubes.end(),
                         [&](const patient::Tube& t) { return t.name == name; });
  };
  ASSERT_EQ(patient.tubes.size(), 5u);
  EXPECT_NEAR(geometry::CalcLength(tube("cystic_duct").line), 0.033, 0.008);
  EXPECT_NEAR(geometry::CalcLength(tube("cystic_artery").line), 0.021, 0.006);
  EXPECT_LT(gallbladder_surface.Find(tube("cystic_duct").line.points.front()).distance, 1e-6);
  EXPECT_EQ(tube("cystic_duct").from, "gallbladder");
  EXPECT_EQ(tube("cystic_duct").to, "common_bile_duct");
}

class VisibleHuman : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kData / "slices"))
      GTEST_SKIP() << (kData / "slices").string() << " is not there; the photographs are needed";
  }
  std::size_t EntriesInBase() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(base_.Path()), fs::directory_iterator()));
  }

  test::TemporaryFolder base_;
};

TEST_F(VisibleHuman, BuildsFromPhotographsWithinTheReferenceBounds) {
  BuildOptions options;
  options.control_points = kAssets / "control_points.json";
  options.images = kData / "slices";
  options.output = base_.Path() / "patient";
  options.reference = kData / "reference/labels.nii.gz";
  options.overlays = base_.Path() / "overlays";
  const auto report = BuildPatient(options);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  SCOPED_TRACE(FormatReport(*report));
  ASSERT_EQ(report->organs.size(), 2u);
  const contours::OrganReport &liver = report->organs[0], &gallbladder = report->organs[1];
  ASSERT_TRUE(liver.judgement && gallbladder.judgement);
  EXPECT_NEAR(liver.judgement->ratio, 1.0, 0.12);
  EXPECT_GE(liver.judgement->dice, 0.90);
  EXPECT_NEAR(gallbladder.judgement->ratio, 1.0, 0.25);
  EXPECT_GE(gallbladder.judgement->dice, 0.70);
  EXPECT_LE(gallbladder.largest_shift_px, 2.5 + 1e-9);
  EXPECT_GT(report->overlays, 30u);
  EXPECT_TRUE(fs::exists(base_.Path() / "overlays/overlay-0546.png"));
  ExpectUsablePatient(report->patient);

  // what was written reads back, and is the patient in the repository
  const auto written = files::ReadPatient(base_.Path() / "patient");
  ASSERT_TRUE(written.ok()) << written.error().Text();
  const auto builtin = files::ReadPatient(kAssets / "patient");
  ASSERT_TRUE(builtin.ok()) << builtin.error().Text();
  ASSERT_EQ(written->organs.size(), builtin->organs.size());
  for (std::size_t i = 0; i < written->organs.size(); ++i) {
    const auto a = geometry::InspectMesh(written->organs[i].mesh),
               b = geometry::InspectMesh(builtin->organs[i].mesh);
    EXPECT_NEAR(a.volume, b.volume, 0.005 * b.volume);
  }
}

TEST_F(VisibleHuman, SlicesOfTheStructuresAreCloseEnough) {
  const auto points = contours::ReadControlPoints(kAssets / "control_points.json");
  ASSERT_TRUE(points.ok()) << points.error().Text();
  for (const contours::Structure& structure : points->structures) {
    const int step = structure.name == "liver" ? 8 : 3;
    for (std::size_t i = 1; i < structure.slices.size(); ++i) {
      EXPECT_LE(structure.slices[i].slice - structure.slices[i - 1].slice, step) << structure.name;
    }
  }
}

TEST_F(VisibleHuman, BadInputWritesNothing) {
  BuildOptions options;
  options.control_points = kAssets / "control_points.json";
  options.output = base_.Path() / "patient";
  options.overlays = base_.Path() / "overlays";
  options.images = base_.Path() / "nowhere";
  EXPECT_EQ(BuildPatient(options).error().code, ErrorCode::kImageFolderMissing);
  options.images = kData / "reference";
  EXPECT_EQ(BuildPatient(options).error().code, ErrorCode::kImageSliceMissing);
  options.images = kData / "slices";
  options.control_points = base_.Path() / "none.json";
  EXPECT_EQ(BuildPatient(options).error().code, ErrorCode::kFileMissing);
  EXPECT_EQ(EntriesInBase(), 0u);

  std::string text = *host::ReadFile(kAssets / "control_points.json");
  text.replace(text.find("\"width\": 1280"), 13, "\"width\": 1279");
  ASSERT_TRUE(host::WriteFile(base_.Path() / "points.json", text).ok());
  options.control_points = base_.Path() / "points.json";
  EXPECT_EQ(BuildPatient(options).error().code, ErrorCode::kImageSizeDiffers);
  EXPECT_EQ(EntriesInBase(), 1u);
}

TEST(BuiltInPatient, IsUsableWithoutTheData) {
  const auto patient = files::ReadPatient(kAssets / "patient");
  ASSERT_TRUE(patient.ok()) << patient.error().Text();
  ExpectUsablePatient(*patient);
  EXPECT_NE(patient->provenance.find("U.S. National Library of Medicine"), std::string::npos);
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(kAssets / "patient")) bytes += entry.file_size();
  EXPECT_LT(bytes, 1000000u);
}

}  // namespace
}  // namespace trocar::anatomy
