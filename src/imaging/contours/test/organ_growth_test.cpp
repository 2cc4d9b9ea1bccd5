// SPDX-License-Identifier: Apache-2.0
// Regions grown in volumes whose shapes are known: balls, with noise, neighbours and bridges.
#include "trocar/contours/organ_growth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "trocar/contours/contour_spline.h"
#include "trocar/contours/grow_contours.h"
#include "trocar/math/random.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using math::Vec3;
using Distance = std::function<double(const Vec3& mm)>;  // < 0 inside

constexpr double kOrgan = 150, kSurroundings = 90, kNeighbour = 132;  // [grey levels]
constexpr std::array<int, 3> kSize = {100, 100, 28};
constexpr std::array<double, 3> kStep = {0.7, 0.7, 3.0};  // 70 x 70 x 84 mm

struct Body {
  Distance shape;
  double grey;
};

/// Later bodies lie over earlier ones; voxels that a border cuts hold the mean of what lies in them.
GreyVolume Draw(const std::vector<Body>& bodies, double noise, std::uint64_t seed = 3) {
  GreyVolume volume{kSize, kStep, {}};
  math::Random random(seed);
  for (int k = 0; k < kSize[2]; ++k) {
    for (int j = 0; j < kSize[1]; ++j) {
      for (int i = 0; i < kSize[0]; ++i) {
        double sum = 0;
        for (int s = 0; s < 5; ++s) {
          const Vec3 p = {i * kStep[0], j * kStep[1], (k + 0.2 * (s - 2)) * kStep[2]};
          double grey = kSurroundings;
          for (const Body& body : bodies) {
            if (body.shape(p) < 0) grey = body.grey;
          }
          sum += grey / 5;
        }
        // the sum of twelve even numbers is nearly normal, of variance one
        double normal = -6;
        for (int n = 0; n < 12; ++n) normal += random.Uniform();
        volume.values.push_back(static_cast<float>(std::clamp(sum + noise * normal, 0.0, 255.0)));
      }
    }
  }
  return volume;
}

Distance Ball(const Vec3& centre, double radius) {
  return [=](const Vec3& p) { return math::Distance(p, centre) - radius; };
}

double Dice(const GreyVolume& volume, const std::vector<std::uint8_t>& inside, const Distance& truth) {
  double both = 0, sum = 0;
  for (int k = 0; k < kSize[2]; ++k) {
    for (int j = 0; j < kSize[1]; ++j) {
      for (int i = 0; i < kSize[0]; ++i) {
        const bool is_true = truth({i * kStep[0], j * kStep[1], k * kStep[2]}) < 0;
        const bool is_grown = inside[volume.Index(i, j, k)] != 0;
        both += is_true && is_grown, sum += is_true + is_grown;
      }
    }
  }
  return 2 * both / sum;
}

std::array<int, 3> VoxelAt(const Vec3& mm) {
  return {static_cast<int>(std::lround(mm.x / kStep[0])), static_cast<int>(std::lround(mm.y / kStep[1])),
          static_cast<int>(std::lround(mm.z / kStep[2]))};
}

GrowthSettings Settings() {
  GrowthSettings settings;
  settings.prior.closing_mm = 2;
  return settings;
}

TEST(GrowRegion, FindsABallInNoise) {
  const Vec3 centre{35, 35, 42};
  const Distance ball = Ball(centre, 22);
  for (const double noise : {0.0, 8.0, 16.0}) {
    const GreyVolume volume = Draw({{ball, kOrgan}}, noise);
    for (const Vec3& click : {centre, centre + Vec3{12, -6, 9}}) {
      const auto grown = GrowRegion(volume, VoxelAt(click), Settings());
      ASSERT_TRUE(grown.ok()) << grown.error().Text();
      EXPECT_GT(Dice(volume, grown->inside, ball), 0.97) << "noise " << noise;
      EXPECT_NEAR(grown->volume_ml, 4.0 / 3 * M_PI * 22 * 22 * 22 / 1000, 2.0) << "noise " << noise;
      EXPECT_NEAR(grown->grey, kOrgan, 3.0);
    }
  }
}

TEST(GrowRegion, KeepsTouchingBallsOfNearGreyApart) {
  const Vec3 left{22, 35, 42}, right{52, 35, 42};
  const Distance a = Ball(left, 15.5), b = Ball(right, 15.5);  // they overlap by a millimetre
  const GreyVolume volume = Draw({{b, kNeighbour}, {a, kOrgan}}, 6);
  const auto grown = GrowRegion(volume, VoxelAt(left), Settings());
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  EXPECT_GT(Dice(volume, grown->inside, a), 0.95);
  EXPECT_EQ(grown->inside[volume.Index(74, 50, 14)], 0);
}

// two balls of the very same grey, joined by a bridge one voxel thick
TEST(GrowRegion, CutsThinBridgesByItsPriorAlone) {
  const Vec3 left{20, 35, 42}, right{52, 35, 42};
  const Distance a = Ball(left, 13), b = Ball(right, 13);
  const Distance bridge = [](const Vec3& p) {
    return p.x > 20 && p.x < 52 && std::fabs(p.y - 35) < 0.36 && std::fabs(p.z - 42) < 1.6 ? -1.0 : 1.0;
  };
  const GreyVolume volume = Draw({{a, kOrgan}, {b, kOrgan}, {bridge, kOrgan}}, 0);
  GrowthSettings settings = Settings();
  const auto grown = GrowRegion(volume, VoxelAt(left), settings);
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  EXPECT_GT(Dice(volume, grown->inside, a), 0.95);
  // a broad one, that the median deviation cannot tell from the organ either: what the opening is for
  const Distance broad = [](const Vec3& p) {
    return p.x > 20 && p.x < 52 && std::fabs(p.y - 35) < 2.0 && std::fabs(p.z - 42) < 3.1 ? -1.0 : 1.0;
  };
  const GreyVolume joined = Draw({{a, kOrgan}, {b, kOrgan}, {broad, kOrgan}}, 0);
  const auto held = GrowRegion(joined, VoxelAt(left), settings);
  ASSERT_TRUE(held.ok()) << held.error().Text();
  EXPECT_GT(Dice(joined, held->inside, a), 0.93);
  EXPECT_EQ(held->inside[VoxelAt(right)[0] + kSize[0] * (50 + kSize[1] * 14)], 0);
  // control: without the prior it runs over into the other ball
  settings.uses_prior = false;
  const auto leaked = GrowRegion(joined, VoxelAt(left), settings);
  ASSERT_TRUE(leaked.ok()) << leaked.error().Text();
  EXPECT_LT(Dice(joined, leaked->inside, a), 0.75);
}

// the diaphragm: between organ and fat in its grey, and no thicker than two or three voxels
TEST(GrowRegion, KeepsAThinLayerOut) {
  const Vec3 centre{35, 35, 42};
  const Distance all = [](const Vec3&) { return -1.0; }, organ = Ball(centre, 21);
  const GreyVolume volume = Draw({{all, 30}, {Ball(centre, 24.5), 122}, {organ, kOrgan}}, 4);
  const auto grown = GrowRegion(volume, VoxelAt(centre), Settings());
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  EXPECT_GT(Dice(volume, grown->inside, organ), 0.97);
  // control: the border is that of the organ, not of the layer around it
  EXPECT_LT(Dice(volume, grown->inside, Ball(centre, 24.5)), 0.85);
}

// a thin plate of the organ's grey, as partial volume makes between bright and dark
TEST(GrowRegion, TakesThinTipsOff) {
  const Vec3 centre{35, 35, 42};
  const Distance ball = Ball(centre, 18);
  const Distance plate = [](const Vec3& p) {
    return p.x > 35 && p.x < 60 && std::fabs(p.y - 35) < 1.2 && std::fabs(p.z - 42) < 10 ? -1.0 : 1.0;
  };
  const GreyVolume volume = Draw({{ball, kOrgan}, {plate, kOrgan}}, 0);
  const std::size_t on_plate = volume.Index(VoxelAt({56, 35, 42})[0], 50, 14);
  GrowthSettings settings = Settings();
  settings.prior.tip_mm = 2;
  const auto blunt = GrowRegion(volume, VoxelAt(centre), settings);
  ASSERT_TRUE(blunt.ok()) << blunt.error().Text();
  EXPECT_EQ(blunt->inside[on_plate], 0);
  EXPECT_GT(Dice(volume, blunt->inside, ball), 0.97);
  settings.prior.tip_mm = 0;
  const auto sharp = GrowRegion(volume, VoxelAt(centre), settings);
  ASSERT_TRUE(sharp.ok()) << sharp.error().Text();
  EXPECT_EQ(sharp->inside[on_plate], 1) << "the control has no tip";
}

TEST(GrowRegion, SaysWhatIsWrongWithAClick) {
  const Vec3 centre{35, 35, 42};
  const auto refusal = [&](const GreyVolume& volume, const Vec3& click, const GrowthSettings& settings) {
    const auto grown = GrowRegion(volume, VoxelAt(click), settings);
    EXPECT_FALSE(grown.ok());
    if (grown.ok()) return std::string();
    EXPECT_EQ(grown.error().code, base::ErrorCode::kEditRefused);
    return grown.error().message;
  };
  const auto says = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  GrowthSettings settings = Settings();
  EXPECT_TRUE(says(refusal(Draw({{Ball(centre, 20), 0}}, 0), centre, settings), "in air"));
  EXPECT_TRUE(says(refusal(Draw({{Ball(centre, 20), 255}}, 0), centre, settings), "in bone"));
  const GreyVolume volume = Draw({{Ball(centre, 20), kOrgan}}, 4);
  EXPECT_TRUE(says(refusal(volume, centre + Vec3{20, 0, 0}, settings), "border"));
  // opened by 4 mm nothing remains of it; the clicked neighbourhood lies inside
  settings.prior.click_mm = 2;
  EXPECT_TRUE(says(refusal(Draw({{Ball(centre, 3.0), kOrgan}}, 0), centre, settings), "thin"));
  settings = Settings();
  settings.prior.most_ml = 20;
  EXPECT_TRUE(says(refusal(volume, centre, settings), "too much"));
  settings.prior.most_ml = 1e9, settings.prior.least_ml = 100;
  EXPECT_TRUE(says(refusal(volume, centre, settings), "too little"));
  settings.prior.least_ml = 0, settings.prior.most_mm[1] = 30;
  EXPECT_TRUE(says(refusal(volume, centre, settings), "too long"));
  settings = Settings(), settings.greys = {0, 100};
  EXPECT_TRUE(says(refusal(volume, centre, settings), "too bright"));
}

TEST(GrowRegion, GivesUpWhenToldTo) {
  const GreyVolume volume = Draw({{Ball({35, 35, 42}, 20), kOrgan}}, 4);
  std::stop_source stop;
  GrowthSettings settings = Settings();
  settings.stop = stop.get_token();
  int reports = 0;
  const auto grown = GrowRegion(volume, VoxelAt({35, 35, 42}), settings, {}, [&](std::string_view, double) {
    if (++reports == 3) stop.request_stop();
  });
  ASSERT_FALSE(grown.ok());
  EXPECT_EQ(grown.error().code, base::ErrorCode::kCancelled);
  EXPECT_EQ(reports, 3);
}

TEST(CalcDistances, AgreesWithBruteForce) {
  const std::array<int, 3> size = {9, 7, 5};
  const std::array<double, 3> step = {0.7, 1.1, 3.0};
  std::vector<std::uint8_t> set(9 * 7 * 5, 0);
  math::Random random(8);
  for (auto& each : set) each = random.Uniform() < 0.03;
  set[100] = 1;
  const auto distances = CalcDistances(set, size, step);
  const auto place = [&](std::size_t i) {
    return Vec3{step[0] * (i % 9), step[1] * (i / 9 % 7), step[2] * (i / 63)};
  };
  for (std::size_t i = 0; i < set.size(); ++i) {
    double nearest = 1e300;
    for (std::size_t j = 0; j < set.size(); ++j) {
      if (set[j] != 0) nearest = std::min(nearest, math::Distance(place(i), place(j)));
    }
    EXPECT_NEAR(distances[i], nearest, 1e-4);
  }
}

TEST(ChooseFewPoints, FollowsAnOutline) {
  std::vector<Vec2> outline;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * M_PI * i / 400, r = 40 + 8 * std::cos(3 * angle);
    outline.push_back({80 + r * std::cos(angle), 80 + r * std::sin(angle)});
  }
  const auto few = ChooseFewPoints(outline, 1.0, 28);
  EXPECT_LE(few.size(), 18u);
  const auto curve = FitContour(few);
  for (const Vec2& p : outline) {
    double nearest = 1e300;
    for (const Vec2& q : curve) nearest = std::min(nearest, Norm(p - q));
    EXPECT_LT(nearest, 1.01);
  }
  EXPECT_EQ(ChooseFewPoints(outline, 0.001, 9).size(), 9u);
}

// a ball that pictures show, as contours of a document
GrowthRequest BallRequest() {
  GrowthRequest request;
  request.points.width = request.points.height = 128;
  request.points.pixel_mm = 0.7, request.points.slice_mm = 3;
  request.points.first_slice = 1, request.points.last_slice = 30;
  request.points.axes = {"left", "posterior", "inferior"};
  request.points.structures.resize(2);
  request.points.structures[0].name = "liver";
  request.points.structures[1].name = "gallbladder";
  request.structure = 1;
  request.slice = 15, request.click = {60, 64};
  for (int i = 1; i <= 30; ++i) request.slices.push_back(i);
  request.read = [](int slice) -> base::Result<images::ColorImage> {
    images::ColorImage image{128, 128, {}};
    math::Random random(static_cast<std::uint64_t>(slice));
    for (int y = 0; y < 128; ++y) {
      for (int x = 0; x < 128; ++x) {
        const double away = std::hypot(0.7 * (x - 60), 0.7 * (y - 64), 3.0 * (slice - 15));
        const double grey = (away < 20 ? 100 : 150) + 10 * (random.Uniform() + random.Uniform() - 1);
        image.samples.insert(image.samples.end(), 3, static_cast<std::uint8_t>(grey));
      }
    }
    return image;
  };
  return request;
}

TEST(GrowOrgan, DrawsContoursThatAreOneStep) {
  const GrowthRequest request = BallRequest();
  const auto grown = GrowOrgan(request);
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  // the ball with its wall
  EXPECT_NEAR(grown->volume_ml, 4.0 / 3 * M_PI * 22 * 22 * 22 / 1000, 4.0);
  ASSERT_GE(grown->slices.size(), 6u);
  for (const SliceContours& slice : grown->slices) {
    ASSERT_EQ(slice.contours.size(), 1u);
    EXPECT_LE(slice.contours[0].size(), 28u);
    if (std::abs(slice.slice - 15) > 5) continue;
    const double radius = std::sqrt(22.0 * 22 - std::pow(3.0 * (slice.slice - 15), 2)) / 0.7;
    for (const Vec2& p : slice.contours[0]) EXPECT_NEAR(Norm(p - Vec2{60, 64}), radius, 2.0) << slice.slice;
  }
  ContourDocument document(request.points);
  ASSERT_TRUE(document.AddPoint(1, 15, {3, 3}).ok());
  const std::string before = document.Text();
  ASSERT_TRUE(ApplyGrowth(document, *grown).ok());
  EXPECT_EQ(document.ContouredSlices(1).size(), grown->slices.size());
  EXPECT_EQ(document.At(1, 15).open.size(), 1u);
  EXPECT_EQ(document.Points().structures[1].adaption.max_shift_px, 0);
  // growing again changes nothing, and is no error
  ASSERT_TRUE(ApplyGrowth(document, *grown).ok());
  while (document.Text() != before && document.CanUndo()) document.Undo();
  EXPECT_EQ(document.Text(), before);
  document.Redo();
  EXPECT_EQ(document.ContouredSlices(1).size(), grown->slices.size());
  ASSERT_TRUE(document.RenameStructure(1, "kidney").ok());
  EXPECT_EQ(ApplyGrowth(document, *grown).error().code, base::ErrorCode::kEditRefused);
}

TEST(GrowOrgan, RefusesWhatItCannotGrow) {
  const auto refused = [](const GrowthRequest& request) {
    const auto grown = GrowOrgan(request);
    return !grown.ok() && grown.error().code == base::ErrorCode::kEditRefused;
  };
  GrowthRequest request = BallRequest();
  request.points.structures[1].name = "kidney";
  EXPECT_TRUE(refused(request));
  request = BallRequest();
  request.click = {-4, 3};
  EXPECT_TRUE(refused(request));
  request = BallRequest();
  request.structure = 0;  // so small a liver there is not
  EXPECT_TRUE(refused(request));
  // a gallbladder far from the liver that is drawn
  request = BallRequest();
  request.points.structures[0].slices = {{15, {{{120, 1}, {126, 1}, {126, 6}}}, {}, {}}};
  request.points.pixel_mm = 1.4;
  EXPECT_TRUE(refused(request));
  // photographs
  request = BallRequest();
  request.read = [](int) -> base::Result<images::ColorImage> {
    images::ColorImage image{128, 128, std::vector<std::uint8_t>(3 * 128 * 128, 90)};
    for (std::size_t i = 0; i < image.samples.size(); i += 3) image.samples[i] = 160;
    return image;
  };
  EXPECT_TRUE(refused(request));
}

// what is drawn already stays another organ's
TEST(GrowOrgan, LeavesOtherOrgansContoursAlone) {
  GrowthRequest request = BallRequest();
  const double right = 66;
  for (int slice = 5; slice <= 25; slice += 5)
    request.points.structures[0].slices.push_back(
        {slice, {{{right, 30}, {right, 64}, {right, 98}, {110, 98}, {110, 64}, {110, 30}}}, {}, {}});
  const auto grown = GrowOrgan(request);
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  for (const SliceContours& slice : grown->slices) {
    if (slice.slice < 6 || slice.slice > 24) continue;
    for (const Vec2& p : slice.contours[0]) {
      if (std::fabs(p.y - 64) >= 25) continue;
      EXPECT_LT(p.x, right + 3) << slice.slice;
    }
  }
}

}  // namespace
}  // namespace trocar::contours
