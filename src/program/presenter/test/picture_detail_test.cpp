// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/picture_detail.h"

#include <gtest/gtest.h>

#include "trocar/math/random.h"

namespace trocar::presenter {
namespace {

using render::Quality;

/// A computer: what a picture takes whatever its size, and what its pixels take at the lowest quality [s].
struct Computer {
  double fixed = 0.005, pixels = 0.030, high = 2;
  double whole = 0;  // besides, where every pixel is drawn
  double Take(const PictureDetail::Step& step) const {
    return fixed + pixels * step.resolution * step.resolution * (step.quality == Quality::kHigh ? high : 1) +
           (step.resolution == 1 ? whole : 0);
  }
};

/// Draws so many pictures; times tremble by a tenth. \return how often the step changed
int Draw(PictureDetail& detail, const Computer& computer, int pictures) {
  math::Random random(5);
  int changes = 0;
  for (int i = 0; i < pictures; ++i) {
    const PictureDetail::Step before = detail.Now();
    detail.AddPicture(computer.Take(before) * random.Uniform(0.9, 1.1));
    changes += detail.Now() == before ? 0 : 1;
  }
  return changes;
}

TEST(PictureDetail, BeginsFinelyAndStaysThereWhereThereIsTime) {
  PictureDetail detail;
  EXPECT_EQ(Draw(detail, {.fixed = 0.001, .pixels = 0.002}, 2000), 0);
  EXPECT_EQ(detail.Now(), (PictureDetail::Step{Quality::kHigh, 1}));
}

TEST(PictureDetail, FindsWithinSomePicturesWhatFits) {
  PictureDetail detail(true);
  EXPECT_EQ(detail.Now(), (PictureDetail::Step{Quality::kLow, 1}));
  const Computer slow{.fixed = 0.010, .pixels = 0.080};
  Draw(detail, slow, 40);
  EXPECT_LE(slow.Take(detail.Now()), 1.0 / 30);
  EXPECT_GE(detail.Now().resolution, 0.5) << "and no coarser than that";
}

TEST(PictureDetail, TriesLessAndLessOftenWhatDidNotFit) {
  PictureDetail detail(true);
  // by its pixels the finest step would fit
  const Computer treacherous{.fixed = 0, .pixels = 0.030, .whole = 0.010};
  Draw(detail, treacherous, 100);
  ASSERT_EQ(detail.Now().resolution, 0.8);
  const int changes = Draw(detail, treacherous, 9000);
  EXPECT_GE(changes, 4) << "it is tried";
  EXPECT_LE(changes, 12);
}

TEST(PictureDetail, ComesBackWhenTheComputerIsFree) {
  PictureDetail detail(true);
  Draw(detail, {.fixed = 0.010, .pixels = 0.150}, 200);
  EXPECT_EQ(detail.Now().resolution, 0.4) << "the coarsest";
  Draw(detail, {.fixed = 0.002, .pixels = 0.010}, 2000);
  EXPECT_EQ(detail.Now(), (PictureDetail::Step{Quality::kLow, 1})) << "the finest where the processor draws";
}

// Much of a picture's time is the toolkit's own: by its pixels alone no finer step would ever seem to fit.
TEST(PictureDetail, LearnsWhatPixelsDoNotCost) {
  PictureDetail detail(true);
  Draw(detail, {.fixed = 0.100, .pixels = 0.150}, 40);  // the first pictures compile shaders
  ASSERT_EQ(detail.Now().resolution, 0.4);
  const Computer steady{.fixed = 0.016, .pixels = 0.022};
  Draw(detail, steady, 2000);
  EXPECT_EQ(detail.Now().resolution, 0.8);
  EXPECT_LE(steady.Take(detail.Now()), 1.0 / 30);
}

TEST(PictureDetail, OneSlowPictureIsNoReason) {
  PictureDetail detail;
  for (int i = 0; i < 100; ++i) detail.AddPicture(i % 9 == 0 ? 0.5 : 0.004);
  EXPECT_EQ(detail.Now().quality, Quality::kHigh);
}

}  // namespace
}  // namespace trocar::presenter
