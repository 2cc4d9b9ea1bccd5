// SPDX-License-Identifier: Apache-2.0
#include "trocar/meshing/volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "banded_distance.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/random.h"
#include "trocar/meshing/marching_cubes.h"

namespace trocar::meshing {
namespace {

using math::Vec2;
using Polygon = std::vector<Vec2>;

/// Whether an odd number of sides crosses the ray from p to the right.
bool IsInPolygon(const Polygon& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y > p.y) != (b.y > p.y)) inside ^= p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
  }
  return inside;
}

/// Pixels whose centres lie in one of the polygons and in no hole, in a rectangle one pixel wider than they are.
images::Mask FillPolygons(const std::vector<Polygon>& polygons, const std::vector<Polygon>& holes) {
  Vec2 low = polygons[0][0], high = low;
  for (const Polygon& polygon : polygons) {
    for (const Vec2& p : polygon) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  images::Mask mask;
  mask.x0 = static_cast<int>(std::floor(low.x)) - 1, mask.y0 = static_cast<int>(std::floor(low.y)) - 1;
  mask.width = static_cast<int>(std::ceil(high.x)) + 2 - mask.x0;
  mask.height = static_cast<int>(std::ceil(high.y)) + 2 - mask.y0;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const Vec2 p{mask.x0 + x + 1.3e-7, mask.y0 + y + 2.9e-7};  // no corner lies in a centre's row
      const auto holds = [&](const Polygon& polygon) { return IsInPolygon(polygon, p); };
      mask.inside.push_back(std::any_of(polygons.begin(), polygons.end(), holds) &&
                            std::none_of(holes.begin(), holes.end(), holds));
    }
  }
  return mask;
}

images::Mask MakeDisc(double cx, double cy, double radius) {
  std::vector<Vec2> circle;
  for (int i = 0; i < 90; ++i)
    circle.push_back({cx + radius * std::cos(i * M_PI / 45), cy + radius * std::sin(i * M_PI / 45)});
  return FillPolygons({circle}, {});
}

double VolumeOf(const ScalarVolume& volume) {
  const auto mesh = MarchCubes(volume);
  return geometry::CalcVolume(mesh.positions, mesh.triangles);
}

TEST(CalcSquaredDistances, EqualsBruteForce) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    math::Random random(seed);
    const int width = 1 + static_cast<int>(random.Uniform(0, 20)),
              height = 1 + static_cast<int>(random.Uniform(0, 20));
    std::vector<std::uint8_t> set(static_cast<std::size_t>(width) * height);
    const double share = random.Uniform(0.01, 0.5);
    for (auto& s : set) s = random.Uniform() < share;
    const auto distances = CalcSquaredDistances(set, width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double nearest = std::numeric_limits<double>::infinity();
        for (int v = 0; v < height; ++v) {
          for (int u = 0; u < width; ++u) {
            if (set[static_cast<std::size_t>(v) * width + u])
              nearest = std::min<double>(nearest, (x - u) * (x - u) + (y - v) * (y - v));
          }
        }
        ASSERT_EQ(distances[static_cast<std::size_t>(y) * width + x], nearest) << "seed " << seed;
      }
    }
  }
}

// Oracle: the unbounded transform.
TEST(CalcBandedDistances, EqualsTheExactOnesWithinTheBand) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    math::Random random(seed);
    const int width = 1 + static_cast<int>(random.Uniform(0, 150)),
              height = 1 + static_cast<int>(random.Uniform(0, 40));
    std::vector<std::uint8_t> set(static_cast<std::size_t>(width) * height);
    const double share = seed % 2 == 0 ? random.Uniform(0.001, 0.02) : random.Uniform(0.98, 1.0);
    for (auto& s : set) s = random.Uniform() < share;
    const int band = seed == 0 ? kWidestBand : 1 + static_cast<int>(random.Uniform(0, 12));
    const auto exact = CalcSignedDistances(set, width, height);
    const auto banded = CalcBandedDistances(set, width, height, band);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double expected = std::clamp(exact[i], -band - 0.5, band + 0.5);
      ASSERT_NEAR(banded[i], expected, 1e-5) << "seed " << seed << ", pixel " << i;
    }
  }
}

TEST(MakeVolume, RecoversABallFromSparseSlices) {
  // slices every 4 mm through a ball of 30 mm, pixels of 0.5 mm
  std::vector<FilledSlice> slices;
  for (int z = -28; z <= 28; z += 4)
    slices.push_back({100.0 + z, MakeDisc(120, 130, std::sqrt(900.0 - z * z) / 0.5)});
  const auto volume = MakeVolume(slices, 0.5, 1.0);
  ASSERT_TRUE(volume.ok());
  const double expected = 4.0 / 3.0 * M_PI * 27000.0;
  EXPECT_NEAR(VolumeOf(*volume), expected, 0.02 * expected);
  const auto mesh = MarchCubes(*volume);
  const auto report = geometry::InspectMesh(mesh);
  EXPECT_EQ(report.components, 1u);
  EXPECT_EQ(report.genus, 0);
  // closed above the last slice, within half a gap
  const auto box = geometry::CalcBox(mesh.positions);
  EXPECT_GT(box.max.z, 128.2);
  EXPECT_LE(box.max.z, 130.0);
}

TEST(MakeVolume, MovesASlantedTubeSmoothly) {
  // the centre moves by 3 mm a slice of 5 mm: the volume between is still that of the tube
  std::vector<FilledSlice> slices;
  for (int i = 0; i <= 6; ++i) slices.push_back({5.0 * i, MakeDisc(40 + 3 * i, 40, 12)});
  const auto volume = MakeVolume(slices, 1.0, 1.0);
  ASSERT_TRUE(volume.ok());
  const double area = M_PI * 144;
  for (int k = 0; k < volume->size[2]; ++k) {
    const double z = volume->first[2] + k;
    if (z < 1 || z > 29) continue;
    double inside = 0;
    for (int j = 0; j < volume->size[1]; ++j) {
      for (int i = 0; i < volume->size[0]; ++i) inside += volume->values[volume->Index(i, j, k)] > 0;
    }
    EXPECT_NEAR(inside, area, 0.06 * area) << "at " << z;
  }
}

TEST(InsertSlices, MovesTheEndOfAThinLobeEvenly) {
  // a plate 4 pixels thick that ends 20 pixels further in the second slice
  const auto plate = [](double end) {
    return FillPolygons({{{10.5, 10.5}, {end + 0.5, 10.5}, {end + 0.5, 14.5}, {10.5, 14.5}}}, {});
  };
  const auto dense = InsertSlices(std::vector<FilledSlice>{{0, plate(30)}, {10, plate(50)}}, 1.0);
  ASSERT_EQ(dense.size(), 11u);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_DOUBLE_EQ(dense[i].position_mm, i);
    // 4 rows from 11 to the end
    EXPECT_NEAR(static_cast<double>(dense[i].mask.Count()) / 4.0, 20 + 2.0 * i, 1.3) << i;
  }
}

TEST(InsertSlices, KeepsWhatIsSharedAndShrinksWhatIsAlone) {
  const auto square = [](double x) {
    return std::vector<Vec2>{{x, 10.5}, {x + 10, 10.5}, {x + 10, 20.5}, {x, 20.5}};
  };
  const std::vector<FilledSlice> slices = {{0, FillPolygons({square(10.5), square(40.5)}, {})},
                                           {4, FillPolygons({square(10.5)}, {})}};
  const auto dense = InsertSlices(slices, 1.0);
  ASSERT_EQ(dense.size(), 5u);
  for (const auto& slice : dense) EXPECT_EQ(slice.mask.At(15 - slice.mask.x0, 15 - slice.mask.y0), 1);
  for (std::size_t i = 1; i < dense.size(); ++i) EXPECT_LE(dense[i].mask.Count(), dense[i - 1].mask.Count());
  EXPECT_EQ(dense[3].mask.Count(), 100u);
}

TEST(InsertSlices, OpensTheGapOfASplittingContourEvenly) {
  // a bar of 60 x 10 pixels that splits into two squares 20 pixels apart, and the other way round
  const auto bar = [](double from, double to) {
    return std::vector<Vec2>{{from + 0.5, 10.5}, {to + 0.5, 10.5}, {to + 0.5, 20.5}, {from + 0.5, 20.5}};
  };
  const FilledSlice whole{0, FillPolygons({bar(10, 70)}, {})},
      split{10, FillPolygons({bar(10, 30), bar(50, 70)}, {})};
  const auto splitting = InsertSlices(std::vector<FilledSlice>{whole, split}, 1.0);
  const auto merging = InsertSlices(std::vector<FilledSlice>{{0, split.mask}, {10, whole.mask}}, 1.0);
  ASSERT_EQ(splitting.size(), 11u);
  for (int i = 0; i <= 10; ++i) {
    // the gap grows from its middle: 20 t wide
    EXPECT_NEAR(static_cast<double>(splitting[i].mask.Count()) / 10.0, 60 - 2.0 * i, 2.0) << i;
    EXPECT_NEAR(static_cast<double>(merging[i].mask.Count()) / 10.0, 40 + 2.0 * i, 2.0) << i;
  }
}

TEST(InsertSlices, WidensAHoleEvenly) {
  const auto circle = [](double radius) {
    std::vector<Vec2> points;
    for (int i = 0; i < 360; ++i)
      points.push_back({60 + radius * std::cos(i * M_PI / 180), 60 + radius * std::sin(i * M_PI / 180)});
    return points;
  };
  const auto dense = InsertSlices(std::vector<FilledSlice>{{0, FillPolygons({circle(40)}, {circle(8)})},
                                                           {10, FillPolygons({circle(40)}, {circle(20)})}},
                                  1.0);
  ASSERT_EQ(dense.size(), 11u);
  for (int i = 0; i <= 10; ++i) {
    const double radius = 8 + 1.2 * i, expected = M_PI * (40 * 40 - radius * radius);
    EXPECT_NEAR(static_cast<double>(dense[i].mask.Count()), expected, 2 * M_PI * radius * 0.8) << i;
  }
}

// Properties that hold for any two slices, by looking at every pixel of every slice.
TEST(InsertSlices, NeverInventsOrForgetsAndChangesEachPixelOnce) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    math::Random random(seed);
    const auto make = [&] {
      std::vector<std::vector<Vec2>> squares;
      const int count = 1 + static_cast<int>(random.Uniform(0, 3));
      for (int i = 0; i < count; ++i) {
        const double x = std::floor(random.Uniform(0, 40)) + 0.5, y = std::floor(random.Uniform(0, 40)) + 0.5;
        const double w = std::floor(random.Uniform(3, 18)), h = std::floor(random.Uniform(3, 18));
        squares.push_back({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
      }
      const auto& first = squares.front();
      const Vec2 middle = 0.5 * (first[0] + first[2]);
      return FillPolygons(squares, {{{middle.x - 1, middle.y - 1},
                                     {middle.x + 1, middle.y - 1},
                                     {middle.x + 1, middle.y + 1},
                                     {middle.x - 1, middle.y + 1}}});
    };
    const std::vector<FilledSlice> slices = {{0, make()}, {6, make()}};
    const auto dense = InsertSlices(slices, 1.0);
    ASSERT_EQ(dense.size(), 7u);
    const auto is_in = [](const images::Mask& mask, int x, int y) {
      x -= mask.x0, y -= mask.y0;
      return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.At(x, y) != 0;
    };
    for (int y = -3; y < 65; ++y) {
      for (int x = -3; x < 65; ++x) {
        int changes = 0;
        for (std::size_t i = 1; i < dense.size(); ++i)
          changes += is_in(dense[i].mask, x, y) != is_in(dense[i - 1].mask, x, y);
        const bool differs = is_in(slices[0].mask, x, y) != is_in(slices[1].mask, x, y);
        ASSERT_EQ(changes, differs ? 1 : 0) << "seed " << seed << " at " << x << ", " << y;
      }
    }
  }
}

TEST(MakeVolume, ClosesItsEndsWhereItIsTold) {
  std::vector<Vec2> circle;
  for (int i = 0; i < 180; ++i)
    circle.push_back({40 + 20 * std::cos(i * M_PI / 90), 40 + 20 * std::sin(i * M_PI / 90)});
  const images::Mask disc = FillPolygons({circle}, {});
  const std::vector<FilledSlice> slices = {{0, disc}, {1, disc}, {2, disc}};
  const auto highest = [](const ScalarVolume& volume) {
    double z = -1e9;
    for (int k = 0; k < volume.size[2]; ++k) {
      for (int j = 0; j < volume.size[1]; ++j) {
        for (int i = 0; i < volume.size[0]; ++i) {
          if (volume.values[volume.Index(i, j, k)] > 0) z = std::max(z, volume.Position(i, j, k).z);
        }
      }
    }
    return z;
  };
  const auto close = MakeVolume(slices, 1.0, 0.5), far = MakeVolume(slices, 1.0, 0.5, std::array{0.5, 6.0});
  ASSERT_TRUE(close.ok() && far.ok());
  EXPECT_LE(highest(*close), 2.5);
  EXPECT_NEAR(highest(*far), 8.0, 0.6);
}

TEST(OpenMask, CutsThinTipsOnly) {
  // a square of 20 pixels with a spike 2 pixels thick
  images::Mask mask = FillPolygons({{{10.5, 10.5},
                                     {30.5, 10.5},
                                     {30.5, 19.5},
                                     {45.5, 19.5},
                                     {45.5, 21.5},
                                     {30.5, 21.5},
                                     {30.5, 30.5},
                                     {10.5, 30.5}}},
                                   {});
  EXPECT_EQ(mask.Count(), 430u);
  OpenMask(mask, 3.0);
  EXPECT_NEAR(static_cast<double>(mask.Count()), 400.0, 14.0);
  EXPECT_EQ(mask.At(40 - mask.x0, 20 - mask.y0), 0);
  // a straight border stays where it is for every radius, only corners are rounded
  for (double radius = 0.5; radius < 6; radius += 0.3) {
    images::Mask square = FillPolygons({{{10.5, 10.5}, {40.5, 10.5}, {40.5, 40.5}, {10.5, 40.5}}}, {});
    OpenMask(square, radius);
    EXPECT_GE(square.Count(), 892u - static_cast<unsigned>(4 * radius * radius)) << radius;
  }
  images::Mask thin = FillPolygons({{{10.5, 10.5}, {30.5, 10.5}, {30.5, 12.5}, {10.5, 12.5}}}, {});
  OpenMask(thin, 3.0);
  EXPECT_EQ(thin.Count(), 40u);
}

TEST(MakeVolume, RefusesAnEmptySlice) {
  const std::vector<FilledSlice> slices = {{0, MakeDisc(20, 20, 5)},
                                           {1, images::Mask{0, 0, 4, 4, std::vector<std::uint8_t>(16, 0)}}};
  const auto volume = MakeVolume(slices, 1, 1);
  ASSERT_FALSE(volume.ok());
  EXPECT_EQ(volume.error().code, base::ErrorCode::kContourEmpty);
}

TEST(Subtract, LeavesTheGap) {
  const std::vector<FilledSlice> big = {
      {0, MakeDisc(40, 40, 20)}, {10, MakeDisc(40, 40, 20)}, {20, MakeDisc(40, 40, 20)}};
  const std::vector<FilledSlice> small = {
      {5, MakeDisc(55, 40, 8)}, {10, MakeDisc(55, 40, 8)}, {15, MakeDisc(55, 40, 8)}};
  auto volume = MakeVolume(big, 1, 1);
  const auto other = MakeVolume(small, 1, 1);
  ASSERT_TRUE(volume.ok() && other.ok());
  Subtract(*volume, *other, 1.0);
  const auto value = [&](int x, int y, int z) {
    return volume->values[volume->Index(x - volume->first[0], y - volume->first[1], z - volume->first[2])];
  };
  EXPECT_LT(value(50, 40, 10), 0.0f);          // was inside both
  EXPECT_NEAR(value(46, 40, 10), 0.0f, 0.6f);  // a millimetre before the small one's border at 47
  EXPECT_GT(value(44, 40, 10), 0.5f);
}

// Oracle: flood fill of each side, sample by sample.
TEST(KeepLargestPart, KeepsWhatAFloodReaches) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    math::Random random(seed);
    ScalarVolume volume{1.0, {0, 0, 0}, {9, 8, 7}, std::vector<float>(504)};
    const double share = random.Uniform(0.3, 0.7);
    for (float& value : volume.values) value = random.Uniform() < share ? 1.0f : -1.0f;
    const auto largest_part = [&](const std::vector<float>& values, bool inside) {
      std::vector<char> seen(values.size(), 0);
      std::vector<std::size_t> best;
      for (std::size_t start = 0; start < values.size(); ++start) {
        if (seen[start] || (values[start] > 0) != inside) continue;
        std::vector<std::size_t> part = {start};
        seen[start] = 1;
        for (std::size_t n = 0; n < part.size(); ++n) {
          const int i = static_cast<int>(part[n] % 9), j = static_cast<int>(part[n] / 9 % 8),
                    k = static_cast<int>(part[n] / 72);
          const int next[6][3] = {{i - 1, j, k}, {i + 1, j, k}, {i, j - 1, k},
                                  {i, j + 1, k}, {i, j, k - 1}, {i, j, k + 1}};
          for (const auto& [x, y, z] : next) {
            if (x < 0 || y < 0 || z < 0 || x >= 9 || y >= 8 || z >= 7) continue;
            const std::size_t to = volume.Index(x, y, z);
            if (seen[to] || (values[to] > 0) != inside) continue;
            seen[to] = 1;
            part.push_back(to);
          }
        }
        if (part.size() > best.size()) best = part;
      }
      return best;
    };
    std::vector<float> expected(504, -1.0f);
    for (const auto v : largest_part(volume.values, true)) expected[v] = 1.0f;
    std::vector<float> filled(504, 1.0f);
    for (const auto v : largest_part(expected, false)) filled[v] = -1.0f;
    KeepLargestPart(volume);
    for (std::size_t v = 0; v < 504; ++v) EXPECT_EQ(volume.values[v] > 0, filled[v] > 0) << "seed " << seed;
  }
}

TEST(KeepLargestPart, DropsIslandsAndFillsCavities) {
  ScalarVolume volume{1.0, {0, 0, 0}, {12, 12, 12}, std::vector<float>(1728, -1.0f)};
  for (int k = 1; k < 8; ++k) {
    for (int j = 1; j < 8; ++j) {
      for (int i = 1; i < 8; ++i) volume.values[volume.Index(i, j, k)] = 1.0f;
    }
  }
  volume.values[volume.Index(4, 4, 4)] = -1.0f;
  volume.values[volume.Index(10, 10, 10)] = 1.0f;
  KeepLargestPart(volume);
  EXPECT_GT(volume.values[volume.Index(4, 4, 4)], 0.0f);
  EXPECT_LT(volume.values[volume.Index(10, 10, 10)], 0.0f);
  const auto report = geometry::InspectMesh(MarchCubes(volume));
  EXPECT_EQ(report.components, 1u);
}

}  // namespace
}  // namespace trocar::meshing
