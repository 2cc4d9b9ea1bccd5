// SPDX-License-Identifier: Apache-2.0
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "processor_time.h"
#include "trocar/bench/benchmark.h"
#include "trocar/contours/contour_fit.h"
#include "trocar/contours/mesh_job.h"

namespace trocar::bench {
namespace {

using contours::MeshLevel;
using contours::OrganMesh;
using images::ColorImage;
using math::Vec2;

constexpr int kPoints = 12;

/// A disc with a soft border on a grainy ground.
ColorImage DrawDisc(int width, int height, const Vec2& centre, double radius) {
  ColorImage image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  std::uint32_t grain = 12345;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double part = std::clamp(0.5 + 0.4 * (radius - std::hypot(x - centre.x, y - centre.y)), 0.0, 1.0);
      const double shade[3] = {190 - 80 * part, 160 - 120 * part, 130 - 100 * part};
      grain = grain * 1664525u + 1013904223u;
      for (int c = 0; c < 3; ++c) image.At(x, y)[c] = static_cast<std::uint8_t>(shade[c] + (grain >> 28));
    }
  }
  return image;
}

/// Shortest time by the clock and, of all threads together, on processors: the second one other programs hardly
/// lengthen, and on an idle computer the first one does not exceed it.
struct Times {
  double clock_s = 0, processor_s = 0;
};

template <typename Restore, typename Run>
Times TimeBoth(int repeats, const Restore& restore, const Run& run) {
  Times times;
  times.processor_s = std::numeric_limits<double>::infinity();
  times.clock_s = TimeShortest(repeats, restore, [&] {
    const WorkStopwatch processor(1);
    run();
    times.processor_s = std::min(times.processor_s, processor.Seconds());
  });
  return times;
}

void AddTimes(const std::string& name, const Times& times, BenchmarkResult& result) {
  result.cases.push_back({name, 1e3 * times.clock_s, "ms"});
  result.cases.push_back({name + ", processor time", 1e3 * times.processor_s, "ms"});
}

std::vector<Vec2> PlacePoints(const Vec2& centre, double radius) {
  std::vector<Vec2> points;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * M_PI * i / kPoints;
    points.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return points;
}

base::Status AddFitCase(const BenchmarkOptions& options, BenchmarkResult& result) {
  const Vec2 centre{560, 350};
  const double radius = 200;
  const contours::EdgeField field(DrawDisc(1280, 720, centre, radius));
  std::vector<Vec2> points = PlacePoints(centre, radius + 2);
  contours::ContourFit fit;
  double turn = 0;
  const Times times = TimeBoth(
      options.repeats,
      [&] {
        points[0] = centre + Vec2{radius + std::cos(turn), std::sin(turn)}, turn += 0.5;
      },
      [&] { fit = contours::FitContourToEdges(field, points); });
  for (const Vec2& p : fit.spline) {
    if (std::fabs(Norm(p - centre) - radius) > 1.5)
      return WrongAnswer("refit", "the curve left the disc's edge");
  }
  AddTimes("refit of a contour while a point is dragged, 1280 x 720", times, result);
  return {};
}

base::Status AddPreviewCases(const BenchmarkOptions& options, BenchmarkResult& result) {
  // a ball of 118 mm in a series of 512 x 512 x 250, contours in every 8th slice
  constexpr double kPixelMm = 0.75, kSliceMm = 1.0, kRadiusMm = 118;
  const Vec2 centre{256, 256};
  const auto radius_px = [&](int slice) {
    const double height = (slice - 125) * kSliceMm;
    return std::sqrt(std::max(0.0, kRadiusMm * kRadiusMm - height * height)) / kPixelMm;
  };
  const auto store = std::make_shared<contours::SliceStore>(
      [&](int slice) -> base::Result<ColorImage> { return DrawDisc(512, 512, centre, radius_px(slice)); });
  contours::MeshRequest request;
  request.pixel_mm = kPixelMm, request.slice_mm = kSliceMm;
  request.content.name = "ball";
  request.content.triangle_budget = 5000;
  for (int slice = 9; slice <= 241; slice += 8) {
    request.content.slices.push_back({slice, {PlacePoints(centre, radius_px(slice) + 2)}, {}, {}});
  }
  for (const auto& slice : request.content.slices) {
    if (auto field = store->Field(slice.slice, request.content.adaption.blur_px); !field)
      return field.error();
  }
  const double ball_ml = 4.0 / 3.0 * M_PI * std::pow(kRadiusMm, 3) / 1000;
  auto fits = std::make_unique<contours::SliceFits>(store);
  base::Result<OrganMesh> mesh = base::Error{};
  double turn = 0;
  for (const MeshLevel level : {MeshLevel::kCoarse, MeshLevel::kFine}) {
    const Times times = TimeBoth(
        options.repeats,
        [&] {
          request.content.slices[15].contours[0][0] =
              centre + Vec2{radius_px(129) + std::cos(turn += 0.5), 0};
        },
        [&] { mesh = contours::MakePreviewMesh(request, *fits, level); });
    if (!mesh) return mesh.error();
    if (!mesh->is_closed || !mesh->is_manifold) return WrongAnswer("preview", "the surface is not closed");
    if (std::fabs(mesh->volume_ml / ball_ml - 1) > 0.02)
      return WrongAnswer("preview", "the ball has another volume");
    AddTimes(std::string(level == MeshLevel::kCoarse ? "coarse" : "fine") +
                 " preview of one organ after an edit, 512 x 512 x 250",
             times, result);
  }
  const Times all = TimeBoth(
      options.repeats, [&] { fits = std::make_unique<contours::SliceFits>(store); },
      [&] { mesh = contours::MakePreviewMesh(request, *fits, MeshLevel::kFine); });
  AddTimes("fine preview of one organ with all 30 contours fitted anew", all, result);
  return {};
}

}  // namespace

base::Result<BenchmarkResult> RunContoursBenchmark(const BenchmarkOptions& options) {
  const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(options.threads));
  BenchmarkResult result;
  if (auto status = AddFitCase(options, result); !status) return status.error();
  if (auto status = AddPreviewCases(options, result); !status) return status.error();
  return result;
}

}  // namespace trocar::bench
