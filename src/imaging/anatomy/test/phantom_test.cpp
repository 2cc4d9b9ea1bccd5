// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/phantom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "trocar/anatomy/build_patient.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;

const patient::Patient& SomePatient() {
  static const patient::Patient patient = [] {
    auto made = GeneratePatient(11);
    EXPECT_TRUE(made.ok());
    return std::move(made).value();
  }();
  return patient;
}

PhantomOptions Coarse() {
  PhantomOptions options;
  options.seed = 11;
  options.pixel_mm = 2;
  options.slice_mm = 4;
  options.every = 3;
  return options;
}

Phantom MakePhantom(const PhantomOptions& options) {
  auto phantom = Phantom::Make(SomePatient(), options);
  EXPECT_TRUE(phantom.ok()) << phantom.error().Text();
  return std::move(phantom).value();
}

TEST(Phantom, LabelsHoldTheMeshesVolumeAtTheirPlaceInTheWorld) {
  const Phantom phantom = MakePhantom(Coarse());
  const images::LabelVolume labels = phantom.MakeLabels();
  const double voxel = 2 * 2 * 4 * 1e-9;
  std::array<double, 5> volume{};
  math::Vec3 centre;
  for (int k = 0; k < labels.size[2]; ++k) {
    for (int j = 0; j < labels.size[1]; ++j) {
      for (int i = 0; i < labels.size[0]; ++i) {
        const auto label =
            labels.labels[(static_cast<std::size_t>(k) * labels.size[1] + j) * labels.size[0] + i];
        volume[label] += voxel;
        if (label != kGallbladderLabel) continue;
        math::Vec3 lps;
        for (int axis = 0; axis < 3; ++axis)
          lps[axis] = labels.origin[axis] + i * labels.direction[0][axis] + j * labels.direction[1][axis] +
                      k * labels.direction[2][axis];
        centre += voxel * math::Vec3{1e-3 * lps.x, 1e-3 * lps.z, -1e-3 * lps.y};
      }
    }
  }
  const patient::Patient& patient = SomePatient();
  const auto& liver = patient.organs[patient.FindOrgan("liver")].mesh;
  const auto& gallbladder = patient.organs[patient.FindOrgan("gallbladder")].mesh;
  EXPECT_NEAR(volume[kLiverLabel] / geometry::CalcVolume(liver.positions, liver.triangles), 1, 0.01);
  EXPECT_NEAR(volume[kGallbladderLabel] / geometry::CalcVolume(gallbladder.positions, gallbladder.triangles),
              1, 0.05);
  EXPECT_GT(volume[kDuctLabel], 0);
  EXPECT_GT(volume[kArteryLabel], 0);
  const auto box = geometry::CalcBox(gallbladder.positions);
  EXPECT_NEAR(Distance(centre / volume[kGallbladderLabel], 0.5 * (box.min + box.max)), 0, 0.012);
}

// mean colour of the pixels that carry a label
std::array<double, 3> MeanColour(const Phantom& phantom, int slice, std::uint8_t label) {
  const images::ColorImage image = phantom.DrawSlice(slice);
  const auto labels = phantom.LabelSlice(slice);
  std::array<double, 3> sum{};
  double count = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != label) continue;
    ++count;
    for (int k = 0; k < 3; ++k) sum[k] += image.samples[3 * i + k];
  }
  for (double& each : sum) each /= std::max(count, 1.0);
  return sum;
}

int MiddleSliceOf(const Phantom& phantom, std::uint8_t label) {
  std::vector<int> slices;
  for (int slice = 1; slice <= phantom.SliceCount(); ++slice) {
    const auto labels = phantom.LabelSlice(slice);
    if (std::count(labels.begin(), labels.end(), label) > 20) slices.push_back(slice);
  }
  return slices.empty() ? 1 : slices[slices.size() / 2];
}

TEST(Phantom, TissuesHaveTheirColours) {
  const Phantom phantom = MakePhantom(Coarse());
  const int slice = MiddleSliceOf(phantom, kGallbladderLabel);
  const auto liver = MeanColour(phantom, slice, kLiverLabel);
  const auto gallbladder = MeanColour(phantom, slice, kGallbladderLabel);
  // brown against green
  EXPECT_GT(liver[0], 1.5 * liver[1]);
  EXPECT_GT(gallbladder[1], 0.8 * gallbladder[0]);
  // the block around the body is blue, fat is bright and yellow
  const images::ColorImage image = phantom.DrawSlice(slice);
  const auto* corner = image.At(2, 2);
  EXPECT_GT(corner[2], corner[0] + 30);
  std::size_t fat = 0, gas = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto* p = image.At(x, y);
      fat += p[0] > 170 && p[1] > 130 && p[2] < p[1];
      // blue within the body: gas-filled bowel
      gas += p[2] > p[0] + 30 && std::abs(x - image.width / 2) < image.width / 4 &&
             std::abs(y - image.height / 2) < image.height / 4;
    }
  }
  EXPECT_GT(fat, static_cast<std::size_t>(image.width * image.height / 20));
  EXPECT_GT(gas, 10u);
}

TEST(Phantom, NoiseAddsGrainAndNothingElseChanges) {
  PhantomOptions options = Coarse();
  options.noise = 0;
  const Phantom clean = MakePhantom(options);
  options.noise = 2;
  const Phantom noisy = MakePhantom(options);
  const int slice = MiddleSliceOf(clean, kLiverLabel);
  EXPECT_EQ(clean.LabelSlice(slice), noisy.LabelSlice(slice));
  const auto deviation = [&](const Phantom& phantom) {
    const images::ColorImage image = phantom.DrawSlice(slice);
    double sum = 0;
    int count = 0;
    // in the even gel at the border
    for (int x = 1; x < image.width; ++x, ++count)
      sum += std::pow(image.At(x, 1)[1] - image.At(x - 1, 1)[1], 2);
    return std::sqrt(0.5 * sum / count);
  };
  EXPECT_LT(deviation(clean), 1.5);
  EXPECT_NEAR(deviation(noisy), 2 * 2.6 * std::sqrt(1.25), 1.5);
}

TEST(Phantom, SameSeedGivesTheSamePixels) {
  const Phantom a = MakePhantom(Coarse()), b = MakePhantom(Coarse());
  EXPECT_EQ(a.DrawSlice(20).samples, b.DrawSlice(20).samples);
  PhantomOptions other = Coarse();
  other.seed = 12;
  EXPECT_NE(a.DrawSlice(20).samples, MakePhantom(other).DrawSlice(20).samples);
}

TEST(Phantom, ControlPointsSlipAsFarAsAsked) {
  PhantomOptions options = Coarse();
  options.slip_mm = 0;
  const contours::ControlPoints exact = MakePhantom(options).MakeControlPoints();
  options.slip_mm = 5;
  const contours::ControlPoints slipped = MakePhantom(options).MakeControlPoints();
  for (std::size_t s = 0; s < exact.structures.size(); ++s) {
    const auto &a = exact.structures[s], &b = slipped.structures[s];
    ASSERT_EQ(a.slices.size(), b.slices.size());
    ASSERT_GE(a.slices.size(), 3u);
    EXPECT_EQ(a.slices[1].slice - a.slices[0].slice, options.every);
  }
  EXPECT_TRUE(contours::ParseControlPoints(contours::FormatControlPoints(slipped), "phantom").ok());
}

TEST(Phantom, RefusesWhatItCannotDraw) {
  patient::Patient without = SomePatient();
  without.organs.pop_back();
  auto phantom = Phantom::Make(without, Coarse());
  ASSERT_FALSE(phantom.ok());
  EXPECT_EQ(phantom.error().code, base::ErrorCode::kPatientInvalid);
  for (const auto& spoil : std::vector<void (*)(PhantomOptions&)>{
           [](PhantomOptions& o) { o.pixel_mm = 0; }, [](PhantomOptions& o) { o.slice_mm = NAN; },
           [](PhantomOptions& o) { o.noise = -1; }, [](PhantomOptions& o) { o.every = 0; },
           [](PhantomOptions& o) { o.points = 3; }, [](PhantomOptions& o) { o.slip_mm = 1e9; }}) {
    PhantomOptions options = Coarse();
    spoil(options);
    const auto refused = Phantom::Make(SomePatient(), options);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, base::ErrorCode::kUsage);
  }
}

class PhantomFolder : public testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path() / "phantom";
};

TEST_F(PhantomFolder, GoesThroughTheWholeChain) {
  ASSERT_TRUE(WritePhantom(folder_, SomePatient(), Coarse()).ok());
  const auto labels = images::ReadLabelVolume(folder_ / "labels.nrrd");
  ASSERT_TRUE(labels.ok()) << labels.error().Text();
  const images::LabelVolume truth = MakePhantom(Coarse()).MakeLabels();
  EXPECT_EQ(labels->labels, truth.labels);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(labels->origin[axis], truth.origin[axis], 1e-9);
  EXPECT_EQ(labels->names, truth.names);
  BuildOptions build;
  build.control_points = folder_ / "control_points.json";
  build.images = folder_ / "slices";
  build.reference = folder_ / "labels.nrrd";
  build.spacing_mm = 2;
  const auto report = BuildPatient(build);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  // pictures of 2 mm pixels and 12 mm between contours: coarse, so the limits are too
  EXPECT_GT(report->organs[0].judgement->dice, 0.90);
  EXPECT_GT(report->organs[1].judgement->dice, 0.70);
  // the fundus is where it was
  EXPECT_NEAR(Distance(report->patient.FindLandmark("fundus")->position,
                       SomePatient().FindLandmark("fundus")->position),
              0, 1e-9);
}

TEST_F(PhantomFolder, NeverWritesIntoSomebodysFolder) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "mine.txt") << "mine";
  const auto status = WritePhantom(folder_, SomePatient(), Coarse());
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace trocar::anatomy
