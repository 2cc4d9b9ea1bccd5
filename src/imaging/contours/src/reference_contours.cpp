// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/reference_contours.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

/// Label axes may differ from the series' extent by this much [mm].
constexpr double kExtentTolerance = 1.5;
/// Weights of a Gaussian of one voxel at distances 0, 1, 2, 3.
constexpr std::array<float, 4> kBlur = {0.39905f, 0.24204f, 0.05401f, 0.00443f};

/// Share of the label about every voxel of one slice [0, 1], with a border of empty voxels.
std::vector<float> BlurLabel(const images::LabelVolume& labels, int label, int k, int margin) {
  const int width = labels.size[0] + 2 * margin, height = labels.size[1] + 2 * margin;
  std::vector<float> mask(static_cast<std::size_t>(width) * height, 0.0f), rows(mask.size(), 0.0f);
  for (int j = 0; j < labels.size[1]; ++j) {
    for (int i = 0; i < labels.size[0]; ++i) {
      const std::size_t voxel = (static_cast<std::size_t>(k) * labels.size[1] + j) * labels.size[0] + i;
      if (labels.labels[voxel] == label)
        mask[static_cast<std::size_t>(j + margin) * width + i + margin] = 1.0f;
    }
  }
  const auto blur = [&](const std::vector<float>& from, std::vector<float>& to, int dx, int dy) {
    for (int y = 3; y + 3 < height; ++y) {
      for (int x = 3; x + 3 < width; ++x) {
        float sum = 0;
        for (int d = -3; d <= 3; ++d)
          sum += kBlur[std::abs(d)] * from[static_cast<std::size_t>(y + d * dy) * width + x + d * dx];
        to[static_cast<std::size_t>(y) * width + x] = sum;
      }
    }
  };
  blur(mask, rows, 1, 0);
  std::fill(mask.begin(), mask.end(), 0.0f);
  blur(rows, mask, 0, 1);
  return mask;
}

double DistanceToSide(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double squared = Dot(side, side);
  const double t = squared > 0 ? std::clamp(Dot(p - a, side) / squared, 0.0, 1.0) : 0.0;
  return Norm(p - a - t * side);
}

}  // namespace

base::Result<std::array<double, 3>> FindLabelStep(const images::LabelVolume& labels,
                                                  const ControlPoints& points) {
  const auto mismatch = [](const std::string& why) {
    return base::Error{
        base::ErrorCode::kLabelsMismatch,
        "the reference labels do not belong to these images: " + why + "; name the labels of this series"};
  };
  // the axes: world left, cranial, anterior against LPS left, posterior, superior
  const auto directions = AxisDirections(points);
  std::array<double, 3> step;  // mm
  for (int axis = 0; axis < 3; ++axis) {
    const auto& d = directions[axis];
    const double lps[3] = {d[0], -d[2], d[1]};
    double along = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
      const double part = labels.direction[axis][k];
      along += lps[k] * part, length += part * part;
    }
    step[axis] = std::sqrt(length);
    if (std::fabs(along - step[axis]) > 1e-3)
      return mismatch("axis " + std::to_string(axis + 1) + " points elsewhere");
  }
  const double extents[3] = {points.width * points.pixel_mm, points.height * points.pixel_mm,
                             (points.last_slice - points.first_slice + 1) * points.slice_mm};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::fabs(labels.size[axis] * step[axis] - extents[axis]) > kExtentTolerance) {
      return mismatch("axis " + std::to_string(axis + 1) + " covers " +
                      std::to_string(labels.size[axis] * step[axis]) + " mm, the images " +
                      std::to_string(extents[axis]) + " mm");
    }
  }
  return step;
}

std::vector<Outline> TraceLabel(const images::LabelVolume& labels, const ControlPoints& points,
                                const std::array<double, 3>& step, int label, int slice) {
  const int k = base::FloorTo<int>((slice - points.first_slice + 0.5) * points.slice_mm / step[2]);
  if (k < 0 || k >= labels.size[2]) return {};
  constexpr int kMargin = 4;
  const int width = labels.size[0] + 2 * kMargin, height = labels.size[1] + 2 * kMargin;
  const auto share = BlurLabel(labels, label, k, kMargin);
  const auto at = [&](int x, int y) { return share[static_cast<std::size_t>(y) * width + x]; };

  // sides of the outline by the lattice edge that they start at: 2 * sample for the edge to the right of it,
  // 2 * sample + 1 for the edge below
  struct Side {
    std::size_t to;
    Vec2 from_point;
  };
  std::map<std::size_t, Side> sides;
  const auto edge_right = [&](int x, int y) { return 2 * (static_cast<std::size_t>(y) * width + x); };
  const auto edge_below = [&](int x, int y) { return edge_right(x, y) + 1; };
  const auto place = [&](std::size_t edge) {
    const int x = static_cast<int>(edge / 2 % width), y = static_cast<int>(edge / 2 / width);
    const bool is_below = edge % 2 == 1;
    const float a = at(x, y), b = is_below ? at(x, y + 1) : at(x + 1, y);
    const double part = (0.5 - a) / (b - a);
    const double i = x - kMargin + (is_below ? 0.0 : part), j = y - kMargin + (is_below ? part : 0.0);
    return Vec2{((i + 0.5) * step[0]) / points.pixel_mm - 0.5, ((j + 0.5) * step[1]) / points.pixel_mm - 0.5};
  };
  for (int y = 0; y + 1 < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const bool in[4] = {at(x, y) > 0.5f, at(x + 1, y) > 0.5f, at(x + 1, y + 1) > 0.5f, at(x, y + 1) > 0.5f};
      if (in[0] == in[1] && in[1] == in[2] && in[2] == in[3]) continue;
      const std::size_t edges[4] = {edge_right(x, y), edge_below(x + 1, y), edge_right(x, y + 1),
                                    edge_below(x, y)};
      // corner c lies between edge c - 1 and edge c; a run of corners inside is cut off from edge to edge,
      // and two opposite corners inside stay apart
      for (int c = 0; c < 4; ++c) {
        if (!in[c] || in[(c + 3) % 4]) continue;
        int last = c;
        while (in[(last + 1) % 4]) last = (last + 1) % 4;
        sides[edges[last]] = {edges[(c + 3) % 4], place(edges[last])};
      }
    }
  }
  std::vector<Outline> outlines;
  while (!sides.empty()) {
    Outline outline;
    for (auto side = sides.begin(); side != sides.end();) {
      const std::size_t to = side->second.to;
      outline.points.push_back(side->second.from_point);
      sides.erase(side);
      side = sides.find(to);
    }
    const std::size_t n = outline.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 &p = outline.points[i], &q = outline.points[(i + 1) % n];
      outline.area_px += 0.5 * (p.x * q.y - q.x * p.y);
      outline.length_px += Norm(q - p);
    }
    if (n >= 3) outlines.push_back(std::move(outline));
  }
  std::stable_sort(outlines.begin(), outlines.end(), [](const Outline& a, const Outline& b) {
    return std::fabs(a.area_px) > std::fabs(b.area_px);
  });
  return outlines;
}

double DistanceToOutlines(const Vec2& p, std::span<const Outline> outlines) {
  TROCAR_ASSERT(!outlines.empty());
  double nearest = std::numeric_limits<double>::max();
  for (const Outline& outline : outlines) {
    const std::size_t n = outline.points.size();
    for (std::size_t i = 0; i < n; ++i)
      nearest = std::min(nearest, DistanceToSide(p, outline.points[i], outline.points[(i + 1) % n]));
  }
  return nearest;
}

}  // namespace trocar::contours
