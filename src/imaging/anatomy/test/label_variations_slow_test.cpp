// SPDX-License-Identifier: Apache-2.0
// Label maps that are not the generator's ideal: coarse, flat and oblique voxels, cropped, warped smoothly. Each must
// give a patient in which the check finds nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/anatomy/phantom.h"
#include "trocar/math/random.h"
#include "trocar/math/vector.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using images::LabelVolume;

/// What is done to a body before its voxels are drawn again.
struct Variation {
  const char* name;
  math::Vec3 step_mm;
  double tilt_deg = 0;    ///< of the lattice, about the first axis, then half of it about the third
  double cropped_mm = 0;  ///< of the cranial end
  double warp_mm = 0;     ///< largest displacement
};

constexpr Variation kVariations[] = {{"1.5 mm", {1.5, 1.5, 1.5}},
                                     {"3 mm", {3, 3, 3}},
                                     {"5 mm", {5, 5, 5}},
                                     {"flat", {0.9, 0.9, 5}},
                                     {"oblique", {3, 3, 3}, 14},
                                     {"cropped", {3, 3, 3}, 0, 55},
                                     {"warped", {3, 3, 3}, 0, 0, 15},
                                     {"fine and warped", {2, 2, 2}, 0, 0, 15}};

/// Displacement by six long waves of random directions.
class Warp {
 public:
  Warp(double largest_mm, std::uint64_t seed) {
    constexpr double kWavelengthMm = 250.0;
    constexpr int kWaves = 6;
    math::Random random(seed);
    const auto direction = [&] {
      return Normalized(math::Vec3{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)});
    };
    for (int i = 0; i < kWaves; ++i) {
      waves_.push_back({random.Uniform(0.5, 2) * 2 * M_PI / kWavelengthMm * direction(),
                        largest_mm / kWaves * direction(), random.Uniform(0, 2 * M_PI)});
    }
  }
  math::Vec3 At(const math::Vec3& place) const {
    math::Vec3 moved;
    for (const Wave& wave : waves_)
      moved += std::sin(Dot(place, wave.frequency) + wave.phase) * wave.amplitude;
    return moved;
  }

 private:
  struct Wave {
    math::Vec3 frequency, amplitude;
    double phase;
  };
  std::vector<Wave> waves_;
};

math::Vec3 AsVector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// Liver and gallbladder of `body`, whose axes are at right angles, drawn again on another lattice by its nearest
/// voxels.
LabelVolume Draw(const LabelVolume& body, const Variation& variation) {
  const math::Vec3 steps[3] = {AsVector(body.direction[0]), AsVector(body.direction[1]),
                               AsVector(body.direction[2])};
  const math::Vec3 origin = AsVector(body.origin);
  const auto label_at = [&](const math::Vec3& place) -> std::int32_t {
    std::array<long, 3> index{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index[axis] = std::lround(Dot(place - origin, steps[axis]) / SquaredNorm(steps[axis]));
      if (index[axis] < 0 || index[axis] >= body.size[axis]) return 0;
    }
    const std::int32_t label =
        body.labels[static_cast<std::size_t>((index[2] * body.size[1] + index[1]) * body.size[0] + index[0])];
    return label <= kGallbladderLabel ? label : 0;
  };
  const double a = variation.tilt_deg * M_PI / 180, b = 0.5 * a;
  const math::Vec3 axes[3] = {{std::cos(b), std::sin(b), 0},
                              {-std::sin(b) * std::cos(a), std::cos(b) * std::cos(a), std::sin(a)},
                              {std::sin(b) * std::sin(a), -std::cos(b) * std::sin(a), std::cos(a)}};
  // the box of the body along the new axes
  math::Vec3 low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -1.0 * low;
  std::size_t at = 0;
  for (int k = 0; k < body.size[2]; ++k) {
    for (int j = 0; j < body.size[1]; ++j) {
      for (int i = 0; i < body.size[0]; ++i, ++at) {
        if (body.labels[at] == 0 || body.labels[at] > kGallbladderLabel) continue;
        const math::Vec3 place = origin + i * steps[0] + j * steps[1] + k * steps[2];
        const math::Vec3 along = {Dot(place, axes[0]), Dot(place, axes[1]), Dot(place, axes[2])};
        low = {std::min(low.x, along.x), std::min(low.y, along.y), std::min(low.z, along.z)};
        high = {std::max(high.x, along.x), std::max(high.y, along.y), std::max(high.z, along.z)};
      }
    }
  }
  const double margin = 6.0 + variation.warp_mm;
  const math::Vec3 begin = low - math::Vec3{margin, margin, margin};
  const math::Vec3 end =
      high + math::Vec3{margin, margin, variation.cropped_mm > 0 ? -variation.cropped_mm : margin};
  const double step[3] = {variation.step_mm.x, variation.step_mm.y, variation.step_mm.z};
  const math::Vec3 side = end - begin;
  LabelVolume drawn;
  const auto count = [](double length, double of) { return static_cast<int>(std::ceil(length / of)) + 1; };
  drawn.size = {count(side.x, step[0]), count(side.y, step[1]), count(side.z, step[2])};
  const math::Vec3 first = begin.x * axes[0] + begin.y * axes[1] + begin.z * axes[2];
  drawn.origin = {first.x, first.y, first.z};
  for (std::size_t axis = 0; axis < 3; ++axis)
    drawn.direction[axis] = {step[axis] * axes[axis].x, step[axis] * axes[axis].y, step[axis] * axes[axis].z};
  const Warp warp(variation.warp_mm, 7);
  for (int k = 0; k < drawn.size[2]; ++k) {
    for (int j = 0; j < drawn.size[1]; ++j) {
      for (int i = 0; i < drawn.size[0]; ++i) {
        const math::Vec3 place =
            first + i * step[0] * axes[0] + j * step[1] * axes[1] + k * step[2] * axes[2];
        drawn.labels.push_back(label_at(place + warp.At(place)));
      }
    }
  }
  drawn.names = {{"liver", kLiverLabel}, {"gallbladder", kGallbladderLabel}};
  return drawn;
}

double MlOf(const LabelVolume& volume, int label, const math::Vec3& step_mm) {
  const auto count = std::count(volume.labels.begin(), volume.labels.end(), label);
  return static_cast<double>(count) * step_mm.x * step_mm.y * step_mm.z / 1000;
}

void ExpectSoundPatients(const LabelVolume& body) {
  const test::TemporaryFolder folder;
  for (const Variation& variation : kVariations) {
    SCOPED_TRACE(variation.name);
    const LabelVolume drawn = Draw(body, variation);
    LabelOptions options;
    options.labels = folder.Path() / "drawn.nrrd";
    ASSERT_TRUE(WriteLabelVolume(options.labels, drawn).ok());
    const auto report = BuildPatientFromLabels(options);
    ASSERT_TRUE(report.ok()) << report.error().Text();
    for (const LintFinding& finding : LintPatient(report->patient).findings)
      ADD_FAILURE() << finding.code << " " << finding.where << ": " << finding.text;
    ASSERT_EQ(report->organs.size(), 2u);
    for (const contours::OrganReport& organ : report->organs) {
      EXPECT_GT(organ.min_angle_deg, 5) << organ.name;
      EXPECT_EQ(organ.genus, 0) << organ.name;
    }
    // the liver gives the gallbladder 0.7 mm of room
    EXPECT_NEAR(report->organs[0].volume_ml / MlOf(drawn, kLiverLabel, variation.step_mm), 1, 0.01);
    EXPECT_NEAR(report->organs[1].volume_ml / MlOf(drawn, kGallbladderLabel, variation.step_mm), 1, 0.01);
    EXPECT_EQ(report->notes.size(), variation.cropped_mm > 0 ? 1u : 0u);
  }
}

TEST(LabelVariationsSlow, OfGeneratedPatientsAreSound) {
  for (const std::uint64_t seed : {1u, 3u, 5u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto patient = GeneratePatient(seed);
    ASSERT_TRUE(patient.ok());
    PhantomOptions options;
    options.pixel_mm = 1.0, options.slice_mm = 1.5;
    const auto phantom = Phantom::Make(*patient, options);
    ASSERT_TRUE(phantom.ok());
    ExpectSoundPatients(phantom->MakeLabels());
  }
}

TEST(LabelVariationsSlow, OfTheVisibleHumanAreSound) {
  const fs::path labels = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/reference/labels.nii.gz";
  if (!fs::exists(labels)) GTEST_SKIP() << labels.parent_path() << " is not there";
  const auto body = images::ReadLabelVolume(labels);
  ASSERT_TRUE(body.ok()) << body.error().Text();
  ExpectSoundPatients(*body);
}

}  // namespace
}  // namespace trocar::anatomy
