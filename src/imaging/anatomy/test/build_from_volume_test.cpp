// SPDX-License-Identifier: Apache-2.0
// The chain takes any series: the same pictures as a stack and as one volume give the same patient.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/anatomy/phantom.h"
#include "trocar/contours/control_points.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

class BuildFromVolume : public testing::Test {
 protected:
  void SetUp() override {
    const auto patient = GeneratePatient(3);
    ASSERT_TRUE(patient.ok()) << patient.error().Text();
    PhantomOptions coarse;
    coarse.pixel_mm = 2, coarse.slice_mm = 3, coarse.every = 3;
    ASSERT_TRUE(WritePhantom(folder_, *patient, coarse).ok());
    WriteVolume();
    stack_.control_points = folder_ / "control_points.json";
    stack_.images = folder_ / "slices";
    stack_.spacing_mm = 2;
    volume_ = stack_;
    volume_.control_points = folder_ / "volume_points.json";
    volume_.images = folder_ / "volume.nrrd";
  }

  /// The slices in one colour NRRD, whose numbers begin with 0; and control points without a pattern.
  void WriteVolume() const {
    auto points = contours::ReadControlPoints(folder_ / "control_points.json");
    ASSERT_TRUE(points.ok());
    images::ImageSeriesOptions options;
    options.pixel_mm = points->pixel_mm, options.slice_mm = points->slice_mm, options.axes = points->axes;
    const auto series = images::ImageSeries::Open(folder_ / "slices", options);
    ASSERT_TRUE(series.ok()) << series.error().Text();
    const images::ImageSeriesInfo& info = series->Info();
    ASSERT_EQ(info.slice_numbers.front(), 1);
    std::string samples(static_cast<std::size_t>(info.width) * info.height * 3, '\0');  // slice 0
    for (const int number : info.slice_numbers) {
      const auto picture = series->ReadSlice(number, {});
      ASSERT_TRUE(picture.ok());
      samples.append(picture->samples.begin(), picture->samples.end());
    }
    std::string header =
        "NRRD0004\ntype: uchar\ndimension: 4\nkinds: RGB-color domain domain domain\nencoding: raw\n"
        "space: left-posterior-superior\nsizes: 3 " +
        std::to_string(info.width) + " " + std::to_string(info.height) + " " +
        std::to_string(info.slice_numbers.size() + 1) + "\nspace directions: none";
    const double steps[] = {info.pixel_mm, info.pixel_mm, info.slice_mm};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& d = info.direction[axis];
      header += " (" + std::to_string(d[0] * steps[axis]) + "," + std::to_string(d[1] * steps[axis]) + "," +
                std::to_string(d[2] * steps[axis]) + ")";
    }
    ASSERT_TRUE(host::WriteFile(folder_ / "volume.nrrd", header + "\n\n" + samples).ok());
    points->image_pattern.clear();
    ASSERT_TRUE(contours::WriteControlPoints(folder_ / "volume_points.json", *points).ok());
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path() / "phantom";
  BuildOptions stack_, volume_;
};

TEST_F(BuildFromVolume, GivesTheSamePatientAsTheStack) {
  const auto a = BuildPatient(stack_), b = BuildPatient(volume_);
  ASSERT_TRUE(a.ok()) << a.error().Text();
  ASSERT_TRUE(b.ok()) << b.error().Text();
  ASSERT_EQ(a->patient.organs.size(), b->patient.organs.size());
  for (std::size_t i = 0; i < a->patient.organs.size(); ++i)
    EXPECT_EQ(a->patient.organs[i].mesh.positions, b->patient.organs[i].mesh.positions);
}

// What the contour window writes for somebody's own pictures: contours, and nothing else.
TEST_F(BuildFromVolume, ContoursAloneMakeAPatientThatTheScenesCanUse) {
  auto points = contours::ReadControlPoints(stack_.control_points);
  ASSERT_TRUE(points.ok());
  points->tubes.clear(), points->landmarks.clear(), points->origin_landmark.clear();
  ASSERT_TRUE(contours::WriteControlPoints(stack_.control_points, *points).ok());
  const auto report = BuildPatient(stack_);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  const patient::Patient& patient = report->patient;
  for (const LintFinding& finding : LintPatient(patient).findings)
    ADD_FAILURE() << finding.code << " " << finding.where << ": " << finding.text;
  EXPECT_LT(Distance(patient.FindLandmark("fundus")->position, {-0.075, 0.095, -0.070}), 1e-9);
  // liver and gallbladder are outlined, everything round them is the template's, and the ports say so
  EXPECT_GE(patient.neighbours.size(), 8u);
  EXPECT_EQ(patient.neighbours.size(), report->neighbours.size());
  for (const patient::Neighbour& neighbour : patient.neighbours)
    EXPECT_FALSE(neighbour.is_seen) << neighbour.name;
  ASSERT_EQ(patient.ports.size(), patient::kPortUseCount);
  EXPECT_NE(patient.ports[1].reason.find("say nothing of this body"), std::string::npos);
  EXPECT_TRUE(patient.table.has_value());
  stack_.has_surroundings = false;
  const auto bare = BuildPatient(stack_);
  ASSERT_TRUE(bare.ok()) << bare.error().Text();
  EXPECT_TRUE(bare->patient.neighbours.empty() && bare->patient.ports.empty() && !bare->patient.table);
  EXPECT_GE(patient.tubes.size(), 5u);
  for (const patient::Tube& tube : patient.tubes) EXPECT_FALSE(tube.is_seen) << tube.name;
  // an umbilicus that is placed is the origin, and not there twice
  points->landmarks.push_back({"umbilicus", static_cast<double>(points->first_slice), {40.0, 30.0}});
  ASSERT_TRUE(contours::WriteControlPoints(stack_.control_points, *points).ok());
  const auto placed = BuildPatient(stack_);
  ASSERT_TRUE(placed.ok()) << placed.error().Text();
  EXPECT_EQ(placed->patient.FindLandmark("umbilicus")->position, math::Vec3());
  EXPECT_GT(
      Distance(placed->patient.FindLandmark("fundus")->position, patient.FindLandmark("fundus")->position),
      0.01);
}

TEST_F(BuildFromVolume, RefusesAVolumeThatLiesOtherwiseThanThePoints) {
  auto points = contours::ReadControlPoints(volume_.control_points);
  ASSERT_TRUE(points.ok());
  points->axes[0] = points->axes[0] == "left" ? "right" : "left";
  ASSERT_TRUE(contours::WriteControlPoints(volume_.control_points, *points).ok());
  EXPECT_EQ(BuildPatient(volume_).error().code, ErrorCode::kImageGeometryInvalid);
}

}  // namespace
}  // namespace trocar::anatomy
