// SPDX-License-Identifier: Apache-2.0
// Label maps that cannot be a person's, each with the likely reason, and what is said of those that are taken.
#include "label_plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace trocar::anatomy {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kLiver = 5, kGallbladder = 4, kSpleen = 1;

/// Voxels along (left, cranial, anterior) of 4 mm, as a map in LPS: a liver with a thick right and a thin left lobe,
/// a gallbladder below it, and room for a spleen.
class Body {
 public:
  Body() {
    volume_.size = {70, 50, 40};
    volume_.labels.assign(70u * 50u * 40u, 0);
    SetStep(4.0);
    Fill(kLiver, {-40, 20, 0}, {75, 70, 60});
    Fill(kLiver, {60, 35, 15}, {60, 25, 20});
    Fill(kGallbladder, {-30, -55, 20}, {16, 24, 16});
  }

  /// An ellipsoid about a place [mm] from the middle, over what is there.
  void Fill(int label, const math::Vec3& centre, const math::Vec3& radii) {
    ForEach([&](std::int32_t& voxel, const math::Vec3& place) {
      const math::Vec3 d = place - centre;
      const double x = d.x / radii.x, y = d.y / radii.y, z = d.z / radii.z;
      if (x * x + y * y + z * z < 1) voxel = label;
    });
  }
  /// The voxels from `first` to `last`, both of them [mm].
  void FillBox(int label, const math::Vec3& first, const math::Vec3& last) {
    ForEach([&](std::int32_t& voxel, const math::Vec3& p) {
      if (p.x >= first.x && p.x <= last.x && p.y >= first.y && p.y <= last.y && p.z >= first.z &&
          p.z <= last.z)
        voxel = label;
    });
  }
  /// Clears what lies where `is_there` says so.
  template <typename IsThere>
  void Clear(const IsThere& is_there) {
    ForEach([&](std::int32_t& voxel, const math::Vec3& place) {
      if (is_there(place)) voxel = 0;
    });
  }
  void SetStep(double step) { volume_.direction = {{{step, 0, 0}, {0, 0, step}, {0, -step, 0}}}; }
  void Turn(std::size_t axis) {
    for (double& part : volume_.direction[axis]) part = -part;
  }

  base::Status Check(bool is_mirrored = false, int liver = kLiver, int gallbladder = kGallbladder) const {
    const auto frame = MakeVoxelFrame(volume_, is_mirrored);
    EXPECT_TRUE(frame.ok());
    return CheckBody(MeasureOrgans(volume_, {liver, gallbladder, kSpleen, ""}, *frame), is_mirrored);
  }
  std::string Refusal(bool is_mirrored = false, int liver = kLiver, int gallbladder = kGallbladder) const {
    const auto status = Check(is_mirrored, liver, gallbladder);
    EXPECT_FALSE(status.ok());
    if (status.ok()) return "";
    EXPECT_EQ(status.error().code, base::ErrorCode::kLabelsMismatch);
    return status.error().message;
  }
  LabelMeasures Measure(int label) const {
    return MeasureLabel(volume_, label, *MakeVoxelFrame(volume_, false));
  }

 private:
  template <typename Use>
  void ForEach(const Use& use) {
    std::size_t at = 0;
    for (int k = 0; k < volume_.size[2]; ++k) {
      for (int j = 0; j < volume_.size[1]; ++j) {
        for (int i = 0; i < volume_.size[0]; ++i)
          use(volume_.labels[at++], math::Vec3{4.0 * (i - 35), 4.0 * (j - 25), 4.0 * (k - 20)});
      }
    }
  }

  images::LabelVolume volume_;
};

TEST(MeasureLabel, SaysWhereItLies) {
  Body body;
  // 5 x 10 x 3 voxels of 64 mm3
  body.FillBox(9, {-100, 20, -20}, {-84, 56, -12});
  const LabelMeasures box = body.Measure(9);
  EXPECT_NEAR(box.volume_ml, 150 * 0.064, 1e-9);
  // from the centre of the first voxel, which is (-140, -100, -80) here
  EXPECT_NEAR(Distance(box.centre, {-92 + 140, 38 + 100, -16 + 80}), 0, 1e-9);
  EXPECT_NEAR(Distance(box.max - box.min, {16, 36, 8}), 0, 1e-9);
  EXPECT_NEAR(box.skewness_left, 0, 1e-9);
  EXPECT_THAT(box.cuts, IsEmpty());
  // two voxels at 0 and one at d: the third moment is that of 1/3 : 2/3
  body.FillBox(10, {-100, 80, -20}, {-100, 84, -20});
  body.FillBox(10, {-80, 80, -20}, {-80, 80, -20});
  EXPECT_NEAR(body.Measure(10).skewness_left, 1 / std::sqrt(2.0), 1e-9);
  EXPECT_GT(body.Measure(kLiver).skewness_left, 0.3);
  EXPECT_EQ(body.Measure(77).volume_ml, 0);

  body.FillBox(8, {-140, 20, 0}, {-132, 36, 8});
  const LabelMeasures cut = body.Measure(8);
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(cut.cuts[0].side, "right");
  EXPECT_NEAR(cut.cuts[0].area_mm2, 5 * 3 * 16, 1e-9);
}

TEST(CheckBody, TakesAPerson) {
  Body body;
  EXPECT_TRUE(body.Check().ok()) << body.Check().error().Text();
  body.Fill(kSpleen, {110, 30, -40}, {20, 30, 20});
  EXPECT_TRUE(body.Check().ok());
}

TEST(CheckBody, NamesTheUnitThatIsWrong) {
  Body body;
  const auto with_step = [&](double step) {
    body.SetStep(step);
    return body.Refusal();
  };
  EXPECT_THAT(with_step(0.4), HasSubstr("centimetres"));
  EXPECT_THAT(with_step(4 / 25.4), HasSubstr("inches"));
  // 20 mm is the largest voxel that is read at all: five times the right one
  EXPECT_THAT(with_step(20), HasSubstr("another organ"));
}

TEST(CheckBody, NamesVoxelsTenTimesTooLarge) {
  images::LabelVolume volume;
  volume.size = {57, 57, 57};
  volume.labels.assign(57u * 57u * 57u, kLiver);
  volume.labels[0] = kGallbladder;
  for (std::size_t axis = 0; axis < 3; ++axis) volume.direction[axis][axis] = 20;
  const auto frame = MakeVoxelFrame(volume, false);
  ASSERT_TRUE(frame.ok());
  const auto status = CheckBody(MeasureOrgans(volume, {kLiver, kGallbladder, 0, ""}, *frame), false);
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("ten times too large"));
}

TEST(CheckBody, NamesSwappedLabels) {
  EXPECT_THAT(Body().Refusal(false, kGallbladder, kLiver),
              testing::AllOf(HasSubstr("swapped"), HasSubstr("--liver 5 --gallbladder 4")));
}

TEST(CheckBody, NamesAGallbladderThatIsNone) {
  const auto is_below = [](const math::Vec3& place) { return place.y < -30; };
  Body fragment;
  fragment.Clear(is_below);
  fragment.Fill(kGallbladder, {-30, -48, 20}, {5, 5, 5});
  EXPECT_THAT(fragment.Refusal(), HasSubstr("the gallbladder has"));
  Body away;
  away.Clear(is_below);
  away.Fill(kGallbladder, {110, -88, -68}, {12, 12, 10});
  EXPECT_THAT(away.Refusal(), HasSubstr("different images"));
}

TEST(CheckBody, NamesWhichWayRoundTheMapIs) {
  Body upside_down;
  upside_down.Turn(1);
  EXPECT_THAT(upside_down.Refusal(), HasSubstr("wrong order"));

  // by the liver's shape, and by the spleen where there is one
  Body mirrored;
  mirrored.Turn(0);
  EXPECT_THAT(mirrored.Refusal(), testing::AllOf(HasSubstr("thin lobe"), HasSubstr("situs inversus")));
  EXPECT_TRUE(mirrored.Check(true).ok());
  mirrored.Fill(kSpleen, {110, 30, -40}, {20, 30, 20});
  EXPECT_THAT(mirrored.Refusal(), HasSubstr("the spleen lies to the right"));
  EXPECT_TRUE(mirrored.Check(true).ok());
  EXPECT_THAT(Body().Refusal(true), HasSubstr("leave --mirrored out"));
}

TEST(CheckParts, RefusesToLoseALargeOne) {
  EXPECT_TRUE(CheckParts("liver", {1500}, false).ok());
  EXPECT_TRUE(CheckParts("liver", {1500, 20, 1}, false).ok());
  const auto two = CheckParts("liver", {1200, 300}, false);
  ASSERT_FALSE(two.ok());
  EXPECT_EQ(two.error().code, base::ErrorCode::kLabelsMismatch);
  EXPECT_THAT(two.error().message,
              testing::AllOf(HasSubstr("1200 mL"), HasSubstr("300 mL"), HasSubstr("--largest-part")));
  EXPECT_TRUE(CheckParts("liver", {1200, 300}, true).ok());
}

TEST(DescribeLosses, SaysWhatIsLeftOutAndWhatIsCutOff) {
  EXPECT_THAT(DescribeLosses("liver", {1500, 0.1}, {{"cranial", 20}}), IsEmpty());
  const auto notes = DescribeLosses("liver", {1500, 20, 1}, {{"cranial", 4200}, {"left", 50}});
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_THAT(notes[0], testing::AllOf(HasSubstr("3 parts"), HasSubstr("21 mL are left out")));
  EXPECT_THAT(notes[1], testing::AllOf(HasSubstr("cranial border"), HasSubstr("42 cm2")));
}

}  // namespace
}  // namespace trocar::anatomy
