// SPDX-License-Identifier: Apache-2.0
// Poses of the laparoscope about a made-up tube.
#include "view_planner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/instrument/camera.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::agent {

using instrument::TrocarJoints;
using math::Pose;
using math::Vec3;

namespace {

/// A trocar 18 cm above the origin with a telescope of 30 degrees; the tube lies along x.
scene::LaparoscopeSetup Angled() {
  scene::LaparoscopeSetup setup;
  setup.p_world_port = {0, 0, 0.18};
  setup.view_angle = 30 * M_PI / 180;
  return setup;
}

/// About the tube, 0 from above.
double Azimuth(const Vec3& eye) {
  return std::atan2(eye.y, eye.z);
}

struct Field {
  scene::LaparoscopeSetup setup = Angled();
  ViewField field;
  Field() {
    field.setup = &setup;
    field.axis = {1, 0, 0};
    field.shows = [this](const Pose& X_world_lens) {
      return instrument::IsInView(X_world_lens, setup.field_of_view, field.middle);
    };
  }
  Pose LensOf(const TrocarJoints& joints) const { return scene::CalcLaparoscopePose(setup, joints); }
};

TEST(FindSideView, LooksFromTheSideAskedForAndShowsTheMiddle) {
  const Field about;
  for (const int side : {+1, -1}) {
    const auto view = FindSideView(about.field, Azimuth, side, 0.3);
    ASSERT_TRUE(view) << side;
    const Pose X_world_lens = about.LensOf(*view);
    EXPECT_GE(side * Azimuth(X_world_lens.translation), 0.3);
    EXPECT_TRUE(about.field.shows(X_world_lens));
  }
}

TEST(FindSideView, IsNothingWhereAnOrganIsBeforeIt) {
  Field about;
  about.field.shows = [](const Pose&) { return false; };
  EXPECT_FALSE(FindSideView(about.field, Azimuth, 1, 0.4));
  // or where the picture does not get so far round
  about.field.shows = [](const Pose&) { return true; };
  EXPECT_FALSE(FindSideView(about.field, Azimuth, 1, 3.0));
}

TEST(FindViewPastShaft, TurnsThePictureAwayFromAShaftThatLiesBeforeThePoint) {
  const Field about;
  const Vec3 shaft = math::Normalized(about.setup.p_world_port);
  Pose over_shaft;
  over_shaft.translation = 0.085 * shaft;
  const auto view = FindViewPastShaft(about.field, over_shaft, 0.15 * shaft);
  ASSERT_TRUE(view);
  EXPECT_GT(math::AngleBetween(about.LensOf(*view).translation, shaft), 0.25);
}

TEST(FindViewPastShaft, LeavesAPictureThatShowsThePointWell) {
  const Field about;
  Pose lens;
  lens.translation = {0, 0, 0.085};
  const Vec3 shaft{0.15, 0, 0.02};
  ASSERT_TRUE(about.field.shows(lens));
  EXPECT_FALSE(FindViewPastShaft(about.field, lens, shaft));
}

}  // namespace
}  // namespace trocar::agent
