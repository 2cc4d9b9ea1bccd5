// SPDX-License-Identifier: Apache-2.0
// Control points and patient folders from strangers: each damage has its code, and nothing waits or crashes.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/contours/control_points.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

class HostileFiles : public testing::Test {
 protected:
  ErrorCode PointsCode(const std::string& text) const {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / "points.json", text).ok());
    const auto points = contours::ReadControlPoints(folder_.Path() / "points.json");
    return points.ok() ? ErrorCode::kNone : points.error().code;
  }
  test::TemporaryFolder folder_;
};

TEST_F(HostileFiles, ControlPoints) {
  EXPECT_EQ(PointsCode(std::string(1000000, '[')), ErrorCode::kFileTooLarge);
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "{\"a\":";
  EXPECT_EQ(PointsCode(deep), ErrorCode::kFileTooLarge);
  EXPECT_EQ(PointsCode("{\"format\": NaN}"), ErrorCode::kJsonSyntax);
  EXPECT_EQ(PointsCode("{\"format\": \"\xff\xfe\"}"), ErrorCode::kJsonSyntax);
  EXPECT_EQ(PointsCode(std::string("\0\0\0", 3)), ErrorCode::kJsonSyntax);
  EXPECT_EQ(PointsCode(""), ErrorCode::kJsonSyntax);
  EXPECT_EQ(PointsCode("{\"format\": \"trocar-control-points\", \"version\": 1e308}"), ErrorCode::kJsonField);
  ASSERT_EQ(::mkfifo((folder_.Path() / "pipe.json").c_str(), 0600), 0);
  EXPECT_EQ(contours::ReadControlPoints(folder_.Path() / "pipe.json").error().code,
            ErrorCode::kFileUnreadable);
  EXPECT_EQ(contours::ReadControlPoints(folder_.Path()).error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(contours::ReadControlPoints("/dev/zero").error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(contours::ReadControlPoints(folder_.Path() / "none.json").error().code, ErrorCode::kFileMissing);
}

TEST_F(HostileFiles, PatientFolders) {
  const auto patient = GeneratePatient(1);
  ASSERT_TRUE(patient.ok());
  const fs::path whole = folder_.Path() / "whole";
  ASSERT_TRUE(files::WritePatient(whole, *patient).ok());
  fs::path mesh;
  for (const auto& entry : fs::directory_iterator(whole)) {
    if (entry.path().extension() == ".ply") mesh = entry.path().filename();
  }
  ASSERT_FALSE(mesh.empty());
  const std::string sound = *host::ReadFile(whole / mesh);
  const auto refuses = [&](const char* what, const std::string& content) {
    ASSERT_TRUE(host::WriteFile(whole / mesh, content).ok());
    const auto read = files::ReadPatient(whole);
    ASSERT_FALSE(read.ok()) << what;
    EXPECT_NE(read.error().message.find(mesh.string()), std::string::npos)
        << what << ": " << read.error().message;
  };
  refuses("cut", sound.substr(0, sound.size() / 2));
  refuses("empty", "");
  refuses("noise", std::string(5000, '\x7f'));
  std::string lying = sound;
  const auto at = lying.find("element vertex ");
  ASSERT_NE(at, std::string::npos);
  lying.insert(at + 15, "9999999");
  refuses("billions of vertices", lying);
  ASSERT_TRUE(host::WriteFile(whole / mesh, sound).ok());
  EXPECT_TRUE(files::ReadPatient(whole).ok());
  fs::remove(whole / mesh);
  ASSERT_EQ(::mkfifo((whole / mesh).c_str(), 0600), 0);
  EXPECT_FALSE(files::ReadPatient(whole).ok()) << "a pipe";
}

}  // namespace
}  // namespace trocar::anatomy
