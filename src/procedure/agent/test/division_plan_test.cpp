// SPDX-License-Identifier: Apache-2.0
// Where clips and cuts are planned: on straight tubes, beside others, and on generated patients.
#include "division_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/files/scene_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::agent {

using files::ReadScene;
using instrument::kRight;
using math::Vec3;

namespace {

using Kind = DivisionStep::Kind;

/// A tube along x in the plane z = 0, 2 mm between its points.
TubeLine Straight(double length, double radius, const Vec3& start = {}) {
  TubeLine line;
  const int count = static_cast<int>(std::lround(length / 0.002));
  for (int i = 0; i <= count; ++i) {
    line.points.push_back(start + Vec3{length * i / count, 0, 0});
    line.radii.push_back(radius);
  }
  return line;
}

/// Seen from a port 15 cm above, nothing else around.
DivisionField FieldOver(const TubeLine& tube) {
  DivisionField field;
  field.tube = &tube;
  field.port = {0.5 * tube.Length(), 0, 0.15};
  field.applier = instrument::FindTool("clip_applier");
  field.scissors = instrument::FindTool("scissors");
  field.clearance = [](const collision::Segment&) { return 0.05; };
  return field;
}

/// Follows the plan with a hand that never misses. \return clips, ascending; cut < 0 where it gave up
struct Divided {
  std::vector<double> clips;
  double cut = -1;
};
Divided Follow(const DivisionField& field) {
  Divided done;
  for (int step = 0; step < 8; ++step) {
    const DivisionStep next = FindNextStep(field, done.clips, {});
    if (next.kind == Kind::kCut) done.cut = next.arc;
    if (next.kind != Kind::kClip) break;
    done.clips.push_back(next.arc);
    std::sort(done.clips.begin(), done.clips.end());
  }
  return done;
}

void ExpectSafe(const Divided& done, double length) {
  ASSERT_GE(done.cut, 0.0) << "no plan";
  const auto distal =
      std::count_if(done.clips.begin(), done.clips.end(), [&](double clip) { return clip < done.cut; });
  EXPECT_EQ(distal, 1);
  EXPECT_EQ(done.clips.size(), 3u);
  for (std::size_t i = 0; i < done.clips.size(); ++i) {
    EXPECT_GT(done.clips[i], 0.0);
    EXPECT_LT(done.clips[i], length);
    EXPECT_GE(std::fabs(done.clips[i] - done.cut), kLeastGap - 1e-12);
    if (i == 0) continue;
    EXPECT_GE(done.clips[i] - done.clips[i - 1], kLeastGap - 1e-12) << "no clip over another";
  }
}

TEST(TubeLine, MeasuresAlongItself) {
  const TubeLine line = Straight(0.030, 0.0012);
  EXPECT_NEAR(line.Length(), 0.030, 1e-12);
  EXPECT_NEAR(line.At(0.0071).x, 0.0071, 1e-12);
  EXPECT_NEAR(line.At(1.0).x, 0.030, 1e-12);
  EXPECT_NEAR(line.DirectionAt(0.01).x, 1.0, 1e-12);
  const auto near = line.FindNearest(Vec3{0.0123, 0.004, -0.003});
  EXPECT_NEAR(near.arc, 0.0123, 1e-12);
  EXPECT_NEAR(near.distance, 0.005, 1e-12);
}

TEST(DivisionPlan, PutsOneClipBeforeTheCutAndTwoBehind) {
  const TubeLine tube = Straight(0.034, 0.00125);
  ExpectSafe(Follow(FieldOver(tube)), tube.Length());
}

TEST(DivisionPlan, FitsIntoAShortDuctAndGivesUpOnAShorterOne) {
  const TubeLine tube = Straight(0.012, 0.001), stump = Straight(0.006, 0.001);
  ExpectSafe(Follow(FieldOver(tube)), tube.Length());
  EXPECT_EQ(FindNextStep(FieldOver(stump), {}, {}).kind, Kind::kNone);
}

TEST(DivisionPlan, GoesOnFromTheClipsThatLieThere) {
  const TubeLine tube = Straight(0.034, 0.00125);
  const DivisionField field = FieldOver(tube);
  // a clip that landed elsewhere counts; one that is missing is placed anew
  const std::vector<double> clips = {0.010, 0.020};
  const DivisionStep next = FindNextStep(field, clips, {});
  ASSERT_EQ(next.kind, Kind::kClip);
  std::vector<double> more = clips;
  more.push_back(next.arc);
  std::sort(more.begin(), more.end());
  const DivisionStep cut = FindNextStep(field, more, {});
  ASSERT_EQ(cut.kind, Kind::kCut);
  EXPECT_EQ(std::count_if(more.begin(), more.end(), [&](double clip) { return clip > cut.arc; }), 2);
  // where it has failed it is not tried again
  const std::vector<double> avoid = {cut.arc};
  const DivisionStep other = FindNextStep(field, more, avoid);
  EXPECT_GT(std::fabs(other.arc - cut.arc), 0.0006);
}

TEST(DivisionPlan, LeavesOtherVesselsAlone) {
  const TubeLine tube = Straight(0.034, 0.00125);
  // one that runs right behind: legs that reach through would close around it
  const TubeLine behind = Straight(0.034, 0.00125, {0, 0, -0.0050});
  DivisionField field = FieldOver(tube);
  ASSERT_EQ(FindClip(field, 0.017), 0.5);
  field.others = {&behind};
  const auto shallow = FindClip(field, 0.017);
  ASSERT_TRUE(shallow) << "taken near the tips, it can be clipped alone";
  EXPECT_LT(*shallow, 0.5);
  // one that lies on it cannot be told apart
  const TubeLine on_it = Straight(0.034, 0.00125, {0, 0, -0.0010});
  field.others = {&on_it};
  EXPECT_FALSE(FindClip(field, 0.017));
  EXPECT_FALSE(FindCut(field, 0.017));
  EXPECT_EQ(FindNextStep(field, {}, {}).kind, Kind::kNone);
}

TEST(DivisionPlan, NeedsClearanceForTheShaft) {
  const TubeLine tube = Straight(0.034, 0.00125);
  DivisionField field = FieldOver(tube);
  // a wall along x = 8 mm, on the gallbladder's side
  field.clearance = [](const collision::Segment& segment) {
    return std::max(0.0, std::min(segment.start.x, segment.end.x) - 0.008);
  };
  EXPECT_FALSE(FindClip(field, 0.010)) << "the shaft is 5 mm thick";
  EXPECT_TRUE(FindClip(field, 0.016));
}

TEST(DivisionPlan, BladesHaveNotClosedUpToTheVesselBefore) {
  for (const double radius : {0.0005, 0.001, 0.0024}) {
    const TubeLine tube = Straight(0.034, radius);
    const DivisionField field = FieldOver(tube);
    const auto pose = FindCut(field, 0.017);
    ASSERT_TRUE(pose);
    const double length = field.scissors->jaw_length, at = (1.0 - pose->beyond) * length;
    // the piece between the blades starts here, and they reach around the vessel
    EXPECT_LT(length * (1.0 - pose->jaw / field.scissors->max_jaw), at);
    EXPECT_GT(at * std::sin(0.5 * pose->jaw), radius);
  }
}

/// Ducts and arteries of a patient from nowhere, before anything is dissected.
TEST(DivisionPlan, IsFoundInGeneratedPatients) {
  auto scene = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  ASSERT_TRUE(scene.ok());
  for (const std::uint64_t seed : {3, 8, 22}) {
    const auto patient = anatomy::GeneratePatient(seed);
    ASSERT_TRUE(patient.ok());
    std::vector<collision::TriangleTree> trees;
    for (const auto& organ : patient->organs)
      trees.push_back(*collision::TriangleTree::Make(organ.mesh.positions, organ.mesh.triangles));
    std::vector<TubeLine> lines;
    for (const patient::Tube& tube : patient->tubes) {
      lines.push_back({tube.line.points, tube.line.radii});
      if (tube.to != "gallbladder") continue;
      std::reverse(lines.back().points.begin(), lines.back().points.end());
      std::reverse(lines.back().radii.begin(), lines.back().radii.end());
    }
    int entering = 0;
    for (std::size_t t = 0; t < lines.size(); ++t) {
      if (patient->tubes[t].from != "gallbladder" && patient->tubes[t].to != "gallbladder") continue;
      DivisionField field = FieldOver(lines[t]);
      field.port = scene->instruments[kRight].p_world_port;
      for (std::size_t other = 0; other < lines.size(); ++other)
        if (other != t) field.others.push_back(&lines[other]);
      field.clearance = [&](const collision::Segment& segment) {
        double least = 0.03;
        for (std::size_t i = 0; i < trees.size(); ++i) {
          const auto nearest =
              trees[i]
                  .FindNearestToSegment(patient->organs[i].mesh.positions, segment, {.max_distance = least})
                  .nearest;
          if (nearest.Found()) least = std::min(least, std::sqrt(nearest.squared_distance));
        }
        return least;
      };
      ++entering;
      SCOPED_TRACE("seed " + std::to_string(seed) + ", " + patient->tubes[t].name);
      ExpectSafe(Follow(field), lines[t].Length());
    }
    EXPECT_GE(entering, 2);
  }
}

}  // namespace
}  // namespace trocar::agent
