// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_fill.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

// Pixel centres are moved by less than any contour's accuracy, so that no corner lies exactly on a centre's
// row or column and the walls along rows and columns agree.
constexpr double kNudgeX = 1.3e-7;  // pixels
constexpr double kNudgeY = 2.9e-7;  // pixels

/// Toggles, for every integer line `v = k` that side a-b crosses, the wall after the last centre before the
/// crossing.
template <typename Toggle>
void VisitCrossings(double ua, double va, double ub, double vb, Toggle toggle) {
  if (va > vb) std::swap(ua, ub), std::swap(va, vb);
  for (int k = base::CeilTo<int>(va); k < vb; ++k) {
    if (k < va) continue;
    toggle(base::FloorTo<int>(ua + (ub - ua) * ((k - va) / (vb - va))), k);
  }
}

}  // namespace

void FillContour(std::span<const Vec2> contour, images::Mask& mask) {
  TROCAR_ASSERT(contour.size() >= 3);
  const int width = mask.width, height = mask.height;
  const auto index = [width](int x, int y) { return static_cast<std::size_t>(y) * width + x; };
  constexpr std::uint8_t kRight = 1, kBelow = 2, kVisited = 4, kInside = 8;
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(width) * height, 0);

  // walls between each pixel and its right and lower neighbour
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const Vec2 &p = contour[i], &q = contour[(i + 1) % contour.size()];
    const double ax = p.x - mask.x0 - kNudgeX, ay = p.y - mask.y0 - kNudgeY;
    const double bx = q.x - mask.x0 - kNudgeX, by = q.y - mask.y0 - kNudgeY;
    TROCAR_ASSERT(ax > 0 && ay > 0 && ax < width - 1 && ay < height - 1);
    VisitCrossings(ax, ay, bx, by, [&](int x, int y) { cells[index(x, y)] ^= kRight; });
    VisitCrossings(ay, ax, by, bx, [&](int y, int x) { cells[index(x, y)] ^= kBelow; });
  }

  // flood from the corner; a step through a wall changes sides
  std::vector<std::size_t> stack = {0};
  cells[0] |= kVisited;
  const auto step = [&](std::size_t from, std::size_t to, bool wall) {
    if (cells[to] & kVisited) return;
    const bool is_inside = ((cells[from] & kInside) != 0) != wall;
    cells[to] |= kVisited | (is_inside ? kInside : 0);
    stack.push_back(to);
  };
  while (!stack.empty()) {
    const std::size_t here = stack.back();
    stack.pop_back();
    const int x = static_cast<int>(here % width), y = static_cast<int>(here / width);
    if (x + 1 < width) step(here, here + 1, cells[here] & kRight);
    if (x > 0) step(here, here - 1, cells[here - 1] & kRight);
    if (y + 1 < height) step(here, here + width, cells[here] & kBelow);
    if (y > 0) step(here, here - width, cells[here - width] & kBelow);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] & kInside) mask.inside[i] = 1;
  }
}

images::Mask FillArea(const std::vector<std::vector<Vec2>>& contours,
                      const std::vector<std::vector<Vec2>>& holes) {
  double low_x = std::numeric_limits<double>::max(), low_y = low_x;
  double high_x = std::numeric_limits<double>::lowest(), high_y = high_x;
  for (const auto* group : {&contours, &holes}) {
    for (const auto& contour : *group) {
      for (const Vec2& p : contour) {
        low_x = std::min(low_x, p.x), low_y = std::min(low_y, p.y);
        high_x = std::max(high_x, p.x), high_y = std::max(high_y, p.y);
      }
    }
  }
  images::Mask area;
  if (low_x > high_x) return area;
  area.x0 = base::FloorTo<int>(low_x) - 2;
  area.y0 = base::FloorTo<int>(low_y) - 2;
  area.width = base::CeilTo<int>(high_x) + 3 - area.x0;
  area.height = base::CeilTo<int>(high_y) + 3 - area.y0;
  area.inside.assign(static_cast<std::size_t>(area.width) * area.height, 0);
  for (const auto& contour : contours) FillContour(contour, area);
  images::Mask removed = area;
  std::fill(removed.inside.begin(), removed.inside.end(), 0);
  for (const auto& hole : holes) FillContour(hole, removed);
  for (std::size_t i = 0; i < area.inside.size(); ++i) {
    if (removed.inside[i]) area.inside[i] = 0;
  }
  return area;
}

}  // namespace trocar::contours
