// SPDX-License-Identifier: Apache-2.0
#include "trocar/patient/patient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "trocar/files/mesh_file.h"
#include "trocar/geometry/primitives.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::files {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

patient::Patient MakePatient() {
  patient::Patient patient;
  patient.name = "Test";
  patient.provenance = "made up";
  patient.organs = {
      {"liver",
       geometry::MakeSphere({0, 0.1, -0.1}, 0.05, 2),
       {{patient::kDiaphragmaticFace, {1, 5, 9}}, {patient::kFalciform, {}}}},
      {"gallbladder", geometry::MakeSphere({0, 0.04, -0.1}, 0.01, 1), {{patient::kGallbladderBed, {0, 2}}}}};
  patient.attachments = {{patient::kGallbladderBed, 1, 0, 0, 4}, {patient::kGallbladderBed, 1, 2, 0, 7}};
  patient.tubes = {{"common_bile_duct",
                    patient::TubeKind::kDuct,
                    "",
                    "",
                    {{{0, 0, 0}, {0.01, 0, 0}}, {0.003, 0.0025}},
                    true},
                   {"cystic_artery",
                    patient::TubeKind::kArtery,
                    "common_bile_duct",
                    "gallbladder",
                    {{{0, 0, 0}, {0, 0.01, 0}}, {0.001, 0.001}},
                    false}};
  patient.landmarks = {{"umbilicus", {0, 0, 0}}, {"fundus", {-0.075, 0.095, -0.07}}};
  return patient;
}

class PatientFolder : public testing::Test {
 protected:
  std::size_t EntriesInBase() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(base_.Path()), fs::directory_iterator()));
  }
  void Rewrite(const std::string& from, const std::string& to) {
    std::string text = *host::ReadFile(folder_ / "patient.json");
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    ASSERT_TRUE(host::WriteFile(folder_ / "patient.json", text.replace(at, from.size(), to)).ok());
  }

  test::TemporaryFolder base_;
  const fs::path folder_ = base_.Path() / "patient";
};

TEST_F(PatientFolder, StatesTheRolesThatNamesDoNotSay) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  EXPECT_EQ(host::ReadFile(folder_ / "patient.json")->find("role"), std::string::npos)
      << "conventional names say what they are";
  patient::Patient patient = MakePatient();
  patient.organs[0].name = "hepar";
  patient.organs[0].regions[0].name = "dome";
  patient.organs[1].role = roles::OrganRole::kOther;
  patient.tubes[1].name = "arteria_cystica";
  patient.landmarks[1].name = "apex";
  patient.tubes[1].to = "hepar";
  ASSERT_TRUE(WritePatient(folder_, patient).ok());
  const auto read = ReadPatient(folder_);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->OrganOf(roles::OrganRole::kLiver), 0);
  EXPECT_EQ(read->FindOrganRole("hepar"), roles::OrganRole::kLiver);
  EXPECT_EQ(read->OrganOf(roles::OrganRole::kGallbladder), -1) << "stated to be none, whatever its name";
  ASSERT_NE(read->organs[0].RegionOf(roles::RegionRole::kDiaphragmaticFace), nullptr);
  EXPECT_EQ(read->organs[0].RegionOf(roles::RegionRole::kDiaphragmaticFace)->name, "dome");
  EXPECT_EQ(read->TubeOf(roles::TubeRole::kCysticArtery), 1);
  EXPECT_EQ(read->TubeOf(roles::TubeRole::kCommonBileDuct), 0);
  EXPECT_EQ(read->TubeOf(roles::TubeRole::kCysticDuct), -1);
  ASSERT_NE(read->LandmarkOf(roles::LandmarkRole::kFundus), nullptr);
  EXPECT_EQ(read->FindLandmark("fundus"), read->LandmarkOf(roles::LandmarkRole::kFundus))
      << "found by its role";
  EXPECT_EQ(read->FindLandmark("apex"), read->LandmarkOf(roles::LandmarkRole::kFundus));
  EXPECT_EQ(read->FindLandmark("other"), nullptr);
}

TEST_F(PatientFolder, RefusesRolesThatDoNotFit) {
  const auto refuse = [&](const std::string& from, const std::string& to, const std::string& why) {
    ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
    Rewrite(from, to);
    const auto read = ReadPatient(folder_);
    ASSERT_FALSE(read.ok()) << to;
    EXPECT_NE(read.error().message.find(why), std::string::npos) << read.error().Text();
  };
  refuse(R"("name":"gallbladder")", R"("name":"gallbladder","role":"spleen")",
         "role must be other, or one of liver");
  refuse(R"("name":"gallbladder")", R"("name":"gallbladder","role":"liver")", "have the role liver");
  refuse(R"("name":"umbilicus")", R"("name":"umbilicus","role":"fundus")", "have the role fundus");
  refuse(R"("name":"falciform")", R"("name":"falciform","role":"diaphragmatic_face")",
         "have the role diaphragmatic face");
  refuse(R"("name":"cystic_artery")", R"("name":"cystic_artery","role":"cystic_duct")",
         "a cystic duct is no artery");
}

TEST_F(PatientFolder, ComesBack) {
  const patient::Patient written = MakePatient();
  ASSERT_TRUE(WritePatient(folder_, written).ok());
  const auto read = ReadPatient(folder_);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  ASSERT_EQ(read->organs.size(), 2u);
  EXPECT_EQ(read->organs[0].mesh.triangles, written.organs[0].mesh.triangles);
  for (std::size_t v = 0; v < written.organs[0].mesh.positions.size(); ++v) {
    EXPECT_LT(Distance(read->organs[0].mesh.positions[v], written.organs[0].mesh.positions[v]), 1e-15);
  }
  EXPECT_EQ(read->organs[0].regions[0].vertices, (std::vector<std::uint32_t>{1, 5, 9}));
  ASSERT_EQ(read->attachments.size(), 2u);
  EXPECT_EQ(read->attachments[1].vertex_b, 7u);
  EXPECT_EQ(read->tubes[1].kind, patient::TubeKind::kArtery);
  EXPECT_EQ(read->tubes[1].from, "common_bile_duct");
  EXPECT_FALSE(read->tubes[1].is_seen);
  EXPECT_NEAR(read->tubes[0].line.radii[1], 0.0025, 1e-15);
  EXPECT_LT(Distance(read->FindLandmark("fundus")->position, {-0.075, 0.095, -0.07}), 1e-15);
  EXPECT_EQ(read->FindOrgan("gallbladder"), 1);
  EXPECT_EQ(read->FindOrgan("spleen"), -1);
  EXPECT_EQ(EntriesInBase(), 1u);
}

TEST_F(PatientFolder, KeepsParameters) {
  patient::Patient written = MakePatient();
  ASSERT_TRUE(WritePatient(folder_, written).ok());
  EXPECT_EQ(host::ReadFile(folder_ / "patient.json")->find("parameters"), std::string::npos);
  EXPECT_TRUE(ReadPatient(folder_)->parameters.empty());
  written.parameters = {{"cystic_duct_length", 35.25, "mm", "a series"},
                        {"cystic_duct_insertion", std::string("low \"quoted\""), "", "another"}};
  ASSERT_TRUE(WritePatient(folder_, written).ok());
  const auto read = ReadPatient(folder_);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->parameters, written.parameters);
  EXPECT_EQ(read->FindParameter("cystic_duct_length")->unit, "mm");
  EXPECT_EQ(read->FindParameter("height"), nullptr);
  Rewrite("35.25", "\"35.25\"");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kJsonField);
}

TEST_F(PatientFolder, KeepsWhatLabelsWereTakenFor) {
  patient::Patient written = MakePatient();
  ASSERT_TRUE(WritePatient(folder_, written).ok());
  EXPECT_TRUE(ReadPatient(folder_)->labels.empty());
  written.labels = {{5, "liver", "the numbers of AbdomenAtlas, which all labels fit", ""},
                    {2, "gallbladder", "as asked", "it does not touch the liver"}};
  ASSERT_TRUE(WritePatient(folder_, written).ok());
  const auto read = ReadPatient(folder_);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->labels, written.labels);
}

TEST_F(PatientFolder, HoldsLpsMillimetres) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  const auto mesh = ReadPly(folder_ / "liver.ply");
  ASSERT_TRUE(mesh.ok());
  math::Vec3 mean;
  for (const auto& p : mesh->positions) mean += p / static_cast<double>(mesh->positions.size());
  // world (0, 0.1 cranial, -0.1 anterior) is left 0, posterior 100, superior 100
  EXPECT_LT(Distance(mean, {0, 100, 100}), 1e-9);
}

TEST_F(PatientFolder, ReplacesAPatientButNoOtherFolder) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  patient::Patient second = MakePatient();
  second.name = "Second";
  ASSERT_TRUE(WritePatient(folder_, second).ok());
  EXPECT_EQ(ReadPatient(folder_)->name, "Second");
  fs::create_directories(base_.Path() / "photos");
  ASSERT_TRUE(host::WriteFile(base_.Path() / "photos" / "holiday.txt", "keep").ok());
  const auto status = WritePatient(base_.Path() / "photos", second);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kFileUnwritable);
  EXPECT_TRUE(fs::exists(base_.Path() / "photos" / "holiday.txt"));
  EXPECT_EQ(EntriesInBase(), 2u);
}

TEST_F(PatientFolder, LeavesNothingOfABadPatient) {
  patient::Patient bad = MakePatient();
  bad.organs[0].mesh.triangles.pop_back();
  const auto status = WritePatient(folder_, bad);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kMeshNotClosed);
  EXPECT_EQ(EntriesInBase(), 0u);
}

TEST_F(PatientFolder, RefusesPathsThatLeadOut) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  Rewrite("\"mesh\":\"liver.ply\"", "\"mesh\":\"../liver.ply\"");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kJsonField);
}

TEST_F(PatientFolder, RefusesWhatIsInconsistent) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  Rewrite("[1,5,9]", "[1,5,99999]");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kPatientInvalid);
  Rewrite("[1,5,99999]", "[1,5,2.5]");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kJsonField);
  Rewrite("[1,5,2.5]", "[1,5,9]");
  Rewrite("\"unit\": \"mm\"", "\"unit\": \"m\"");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kJsonField);
}

TEST_F(PatientFolder, RefusesEveryTruncation) {
  ASSERT_TRUE(WritePatient(folder_, MakePatient()).ok());
  for (const char* name : {"patient.json", "gallbladder.ply"}) {
    const std::string whole = *host::ReadFile(folder_ / name);
    for (std::size_t length = 0; length + 2 < whole.size(); length += 17) {
      ASSERT_TRUE(host::WriteFile(folder_ / name, whole.substr(0, length)).ok());
      ASSERT_FALSE(ReadPatient(folder_).ok()) << name << " at " << length;
    }
    ASSERT_TRUE(host::WriteFile(folder_ / name, whole).ok());
  }
  ASSERT_TRUE(ReadPatient(folder_).ok());
  fs::remove(folder_ / "liver.ply");
  EXPECT_EQ(ReadPatient(folder_).error().code, ErrorCode::kFileMissing);
  EXPECT_EQ(ReadPatient(base_.Path() / "nowhere").error().code, ErrorCode::kFileMissing);
}

TEST(CheckPatient, FindsEachFault) {
  const auto code_after = [](auto change) {
    patient::Patient patient = MakePatient();
    change(patient);
    const auto status = patient::CheckPatient(patient);
    return status.ok() ? ErrorCode::kNone : status.error().code;
  };
  EXPECT_EQ(code_after([](patient::Patient&) {}), ErrorCode::kNone);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.organs.clear(); }), ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.organs[1].name = "liver"; }), ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.organs[1].name = "../liver"; }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              for (auto& t : p.organs[0].mesh.triangles) std::swap(t[0], t[1]);
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              p.organs[0].regions[0].vertices = {5, 1};
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.attachments[0].organ_b = 2; }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.attachments[0].vertex_b = 1u << 30; }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.tubes[0].line.radii[0] = 0; }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              p.tubes[0].line.points[0].x = std::numeric_limits<double>::quiet_NaN();
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.tubes[1].from = "aorta"; }), ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              p.organs[0].mesh.positions[0].x = std::numeric_limits<double>::infinity();
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              p.parameters = {{"a", 1.0, "", ""}, {"a", 2.0, "", ""}};
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) {
              p.parameters = {{"a", std::numeric_limits<double>::quiet_NaN(), "", ""}};
            }),
            ErrorCode::kPatientInvalid);
  EXPECT_EQ(code_after([](patient::Patient& p) { p.landmarks[1].name = "umbilicus"; }),
            ErrorCode::kPatientInvalid);
}

}  // namespace
}  // namespace trocar::files
