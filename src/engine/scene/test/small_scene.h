// SPDX-License-Identifier: Apache-2.0
/// \file small_scene.h  A patient of two spheres and a scene around it, written to a folder of the test's
/// own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/geometry/primitives.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::scene {

class SmallScene : public testing::Test {
 protected:
  static constexpr const char* kScript = R"({"format": "trocar-script", "version": 1, "keys": [
    {"time_s": 0.0, "left": {"at": "fundus", "offset_mm": [-4, 0, 12], "jaw_deg": 45},
                    "right": {"at": "fundus", "offset_mm": [20, 0, 25], "jaw_deg": 0}},
    {"time_s": 0.4, "left": {"at": "fundus", "offset_mm": [-2, 0, -2], "jaw_deg": 45}},
    {"time_s": 0.6, "left": {"at": "fundus", "offset_mm": [-2, 0, -2], "jaw_deg": 2}},
    {"time_s": 1.0, "left": {"at": "fundus", "offset_mm": [-2, 4, 6], "jaw_deg": 2}},
    {"time_s": 1.2, "left": {"at": "fundus", "offset_mm": [-2, 4, 6], "jaw_deg": 45}}]})";

  void SetUp() override {
    ASSERT_TRUE(files::WritePatient(folder_ / "patient", MakePatient()).ok());
    Write("script.json", kScript);
    Write("scene.json", SceneText());
  }

  static patient::Patient MakePatient() {
    patient::Patient patient;
    patient.name = "two spheres";
    patient.provenance = "made by a test";
    patient::Organ liver{"liver", geometry::MakeSphere({0, 0.1, -0.12}, 0.03, 3), {}};
    patient::Region face{patient::kDiaphragmaticFace, {}};
    for (std::uint32_t i = 0; i < liver.mesh.positions.size(); ++i) {
      if (liver.mesh.positions[i].y > 0.115) face.vertices.push_back(i);
    }
    liver.regions.push_back(face);
    patient::Organ gallbladder{"gallbladder", geometry::MakeSphere({0, 0.056, -0.12}, 0.013, 2), {}};
    patient::Region bed{patient::kGallbladderBed, {}};
    for (std::uint32_t i = 0; i < gallbladder.mesh.positions.size(); ++i) {
      if (gallbladder.mesh.positions[i].y < 0.064) continue;
      bed.vertices.push_back(i);
      std::uint32_t nearest = 0;
      for (std::uint32_t j = 0; j < liver.mesh.positions.size(); ++j) {
        const auto far = [&](std::uint32_t k) {
          return math::Distance(liver.mesh.positions[k], gallbladder.mesh.positions[i]);
        };
        if (far(j) < far(nearest)) nearest = j;
      }
      patient.attachments.push_back({patient::kGallbladderBed, 1, i, 0, nearest});
    }
    gallbladder.regions.push_back(bed);
    patient.organs = {liver, gallbladder};
    patient.tubes.push_back(
        {"cystic_duct",
         patient::TubeKind::kDuct,
         "gallbladder",
         "",
         {{{0.012, 0.056, -0.12}, {0.02, 0.056, -0.122}, {0.03, 0.058, -0.125}}, {0.0015, 0.0015, 0.0015}},
         true});
    patient.landmarks = {{"umbilicus", {0, 0, 0}}, {"fundus", {0, 0.056, -0.107}}};
    return patient;
  }

  static std::string SceneText(const std::string& tool = "grasper", const std::string& more = "") {
    return R"({"format": "trocar-scene", "version": 1, "name": "two spheres", "patient": "patient", "script": "script.json",
      "settings": {"head_up_deg": 0, "right_up_deg": 0},
      "materials": [
        {"organ": "liver", "young_modulus_pa": 1e6, "wall_thickness_mm": 0.04, "foundation_modulus_pa": 5400, "foundation_depth_mm": 80, "density_kg_m3": 1060, "source": "test"},
        {"organ": "gallbladder", "young_modulus_pa": 255e3, "wall_thickness_mm": 0.5, "foundation_modulus_pa": 300, "foundation_depth_mm": 30, "source": "test"},
        {"organ": "gallbladder_bed", "young_modulus_pa": 20e3, "wall_thickness_mm": 1.5, "source": "test"},
        {"organ": "duct", "young_modulus_pa": 498e3, "wall_thickness_mm": 0.7, "foundation_modulus_pa": 1000, "foundation_depth_mm": 10, "source": "test"}],
      "instruments": {"left": {"tool": ")" +
           tool + R"(", "port_mm": [-30, 60, 0], "tip": {"at": "fundus", "offset_mm": [0, 0, 12]}},
                      "right": {"tool": "grasper", "port_mm": [30, 60, 0], "tip": {"at": "fundus", "offset_mm": [20, 0, 25]}}},
      "laparoscope": {"port_mm": [0, 0, 0], "target": {"at": "fundus"}, "depth_mm": 50})" +
           more + "}";
  }

  void Write(const char* name, const std::string& text) {
    ASSERT_TRUE(host::WriteFile(folder_ / name, text).ok());
  }
  base::Result<Scene> Read() const { return files::ReadScene(folder_ / "scene.json"); }

  test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.Path();
};

}  // namespace trocar::scene
