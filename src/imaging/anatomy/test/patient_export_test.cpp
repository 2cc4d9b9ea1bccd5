// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "trocar/files/mesh_file.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;
using testing::SizeIs;

const fs::path kRoot = TROCAR_SOURCE_DIR;

const patient::Patient& BuiltIn() {
  static const patient::Patient patient = [] {
    auto read = files::ReadPatient(kRoot / "assets/patients/visible-human-male/patient");
    EXPECT_TRUE(read.ok()) << read.error().Text();
    return *read;
  }();
  return patient;
}

class Export : public testing::Test {
 protected:
  std::vector<fs::path> Write(MeshFormat format) {
    const auto paths = ExportPatient(BuiltIn(), target_, {format});
    EXPECT_TRUE(paths.ok()) << paths.error().Text();
    return paths.ok() ? *paths : std::vector<fs::path>{};
  }
  std::size_t EntriesBesideTarget() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.Path()), fs::directory_iterator()));
  }

  test::TemporaryFolder folder_;
  const fs::path target_ = folder_.Path() / "out";
};

TEST_F(Export, WritesOneFileAMeshInLpsMillimetres) {
  const auto paths = Write(MeshFormat::kPly);
  ASSERT_THAT(paths, SizeIs(7));  // two organs, five tubes
  // the organs' files are those of the patient folder but for rounding of the conversion there and back
  const auto mesh = files::ReadPly(target_ / "liver.ply");
  const auto original = files::ReadPly(kRoot / "assets/patients/visible-human-male/patient/liver.ply");
  ASSERT_TRUE(mesh.ok() && original.ok());
  EXPECT_EQ(mesh->triangles, original->triangles);
  for (std::size_t v = 0; v < mesh->positions.size(); ++v)
    EXPECT_LT(Distance(mesh->positions[v], original->positions[v]), 1e-9);
  const auto duct = files::ReadPly(target_ / "cystic_duct.ply");
  ASSERT_TRUE(duct.ok());
  EXPECT_EQ(duct->positions.size(), 17u * 16u + 2u);
  EXPECT_LT(Distance(duct->positions[17 * 16], {-45.86603, 131.97074, 115.80947}), 1e-4);  // its first point
}

TEST_F(Export, WritesStlAndVtkOfEachMesh) {
  ASSERT_THAT(Write(MeshFormat::kStl), SizeIs(7));
  EXPECT_EQ(fs::file_size(target_ / "liver.stl"), 84u + 50u * 5132u);
  fs::remove_all(target_);
  ASSERT_THAT(Write(MeshFormat::kVtk), SizeIs(7));
  EXPECT_THAT(*host::ReadFile(target_ / "liver.vtk"),
              HasSubstr("\nBINARY\nDATASET POLYDATA\nPOINTS 2568 double\n"));
  fs::remove_all(target_);
  ASSERT_TRUE(ExportPatient(BuiltIn(), target_, {MeshFormat::kVtk, true}).ok());
  EXPECT_THAT(*host::ReadFile(target_ / "liver.vtk"),
              HasSubstr("\nASCII\nDATASET POLYDATA\nPOINTS 2568 double\n"));
}

TEST_F(Export, WritesOneObjWithAGroupForEachMesh) {
  ASSERT_THAT(Write(MeshFormat::kObj), SizeIs(1));
  std::istringstream file(*host::ReadFile(target_ / "patient.obj"));
  std::vector<std::string> groups;
  std::size_t faces = 0;
  double lowest = 1e9;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("g ")) groups.push_back(line.substr(2));
    faces += line.starts_with("f ") && groups.size() == 1 ? 1 : 0;
    if (line.starts_with("v ") && groups.size() == 1) lowest = std::min(lowest, std::atof(line.c_str() + 2));
  }
  EXPECT_THAT(groups, testing::ElementsAre("liver", "gallbladder", "cystic_duct", "common_hepatic_duct",
                                           "common_bile_duct", "right_hepatic_artery", "cystic_artery"));
  EXPECT_EQ(faces, 5132u);
  EXPECT_NEAR(lowest, -121.53746, 1e-4);  // the liver's right side
}

TEST_F(Export, WritesGltfInMetresWithTheHeadUp) {
  ASSERT_THAT(Write(MeshFormat::kGltf), SizeIs(1));
  const std::string file = *host::ReadFile(target_ / "patient.glb");
  std::uint32_t size = 0;
  std::memcpy(&size, file.data() + 12, sizeof(size));
  const auto json = nlohmann::json::parse(file.substr(20, size));
  ASSERT_EQ(json["nodes"].size(), 7u);
  EXPECT_EQ(json["nodes"][0]["name"], "liver");
  const auto& accessor =
      json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<int>()];
  // x left, y superior, z anterior: the box of liver.ply (left, posterior, superior) in metres
  const double low[3] = {-0.12153746, 0.03514073, -0.24408346},
               high[3] = {0.06509977, 0.21284121, -0.05061067};
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(accessor["min"][axis].get<double>(), low[axis], 1e-6);
    EXPECT_NEAR(accessor["max"][axis].get<double>(), high[axis], 1e-6);
  }
  std::set<std::string> materials;
  for (const auto& material : json["materials"]) materials.insert(material["name"]);
  EXPECT_EQ(materials, (std::set<std::string>{"artery", "duct", "gallbladder", "liver"}));
}

TEST_F(Export, NeverTouchesAFolderWithSomethingInIt) {
  ASSERT_TRUE(host::WriteFile(target_ / "holiday.txt", "keep").ok());
  EXPECT_EQ(ExportPatient(BuiltIn(), target_, {}).error().code, ErrorCode::kFileUnwritable);
  EXPECT_EQ(*host::ReadFile(target_ / "holiday.txt"), "keep");
  EXPECT_EQ(EntriesBesideTarget(), 1u);
}

TEST_F(Export, FillsAnEmptyFolderAndAcceptsATrailingSlash) {
  fs::create_directories(target_);
  const auto paths = ExportPatient(BuiltIn(), target_ / "", {MeshFormat::kStl});
  ASSERT_TRUE(paths.ok()) << paths.error().Text();
  for (const auto& path : *paths) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_EQ(EntriesBesideTarget(), 1u);
}

TEST_F(Export, LeavesNothingWhenItFails) {
  patient::Patient patient = BuiltIn();
  patient.tubes[0].name = "../../escape";
  patient.tubes[1].to = patient.tubes[2].from = "";
  EXPECT_EQ(ExportPatient(patient, target_, {MeshFormat::kPly}).error().code, ErrorCode::kPatientInvalid);
  patient = BuiltIn();
  patient.organs[0].mesh.triangles.pop_back();
  EXPECT_EQ(ExportPatient(patient, target_, {}).error().code, ErrorCode::kMeshNotClosed);
  EXPECT_EQ(EntriesBesideTarget(), 0u);
  // a file stands where the parent folder should be
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "file", "").ok());
  EXPECT_EQ(ExportPatient(BuiltIn(), folder_.Path() / "file" / "out", {}).error().code,
            ErrorCode::kFileUnwritable);
  EXPECT_EQ(EntriesBesideTarget(), 1u);
}

TEST(FindMeshFormat, KnowsFiveNames) {
  for (const char* name : {"obj", "ply", "stl", "gltf", "vtk"})
    EXPECT_TRUE(FindMeshFormat(name).ok()) << name;
  const auto unknown = FindMeshFormat("dae");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kUnknownName);
  EXPECT_THAT(unknown.error().message, HasSubstr("obj, ply, stl, gltf, vtk"));
}

// The Khronos validator must find no error and no warning. Label: gltf.
TEST(GltfValidator, AcceptsTheBuiltInPatient) {
  const fs::path script = kRoot / "tools/validate-gltf";
  // 3: node or the package is not there
  const auto run = [&](const std::string& arguments) {
    const int status = std::system(("'" + script.string() + "' " + arguments).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  if (run("--check") == 3)
    GTEST_SKIP() << "gltf-validator is not installed; run tools/install-gltf-validator";
  test::TemporaryFolder folder;
  ASSERT_TRUE(ExportPatient(BuiltIn(), folder.Path() / "out", {MeshFormat::kGltf}).ok());
  const fs::path file = folder.Path() / "out" / "patient.glb";
  EXPECT_EQ(run("'" + file.string() + "'"), 0);
  // negative control: one byte of the limits wrong
  std::string text = *host::ReadFile(file);
  const auto at = text.find("\"max\":[0.");
  ASSERT_NE(at, std::string::npos);
  text[at + 9] = text[at + 9] == '9' ? '8' : '9';
  ASSERT_TRUE(host::WriteFile(file, text).ok());
  EXPECT_EQ(run("'" + file.string() + "' > /dev/null"), 1);
}

}  // namespace
}  // namespace trocar::anatomy
