// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/canvas_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trocar::editor {

using math::Vec2;

namespace {

constexpr double kMargin = 0.96;  // of the canvas that a fitted picture takes

double SignX(const CanvasView& view) {
  return view.is_mirrored_x ? -1.0 : 1.0;
}
double SignY(const CanvasView& view) {
  return view.is_mirrored_y ? -1.0 : 1.0;
}

/// Letter of the end of an axis that grows to `direction`.
std::string Letter(const std::string& direction, bool is_far_end) {
  constexpr const char* kEnds[][2] = {{"left", "right"}, {"superior", "inferior"}, {"anterior", "posterior"}};
  for (const auto& ends : kEnds) {
    for (int i = 0; i < 2; ++i) {
      if (direction != ends[i]) continue;
      const char letter = ends[is_far_end ? i : 1 - i][0];
      return std::string(1, static_cast<char>(letter - 'a' + 'A'));
    }
  }
  return {};
}

}  // namespace

Vec2 ToCanvas(const CanvasView& view, const CanvasSize& size, const Vec2& p) noexcept {
  return {0.5 * size.width + SignX(view) * view.zoom * (p.x - view.centre.x),
          0.5 * size.height + SignY(view) * view.zoom * (p.y - view.centre.y)};
}

Vec2 ToPicture(const CanvasView& view, const CanvasSize& size, const Vec2& at) noexcept {
  return {view.centre.x + SignX(view) * (at.x - 0.5 * size.width) / view.zoom,
          view.centre.y + SignY(view) * (at.y - 0.5 * size.height) / view.zoom};
}

void ZoomAt(CanvasView& view, const CanvasSize& size, const Vec2& at, double factor) noexcept {
  const Vec2 under = ToPicture(view, size, at);
  view.zoom = std::clamp(view.zoom * factor, kLeastZoom, kMostZoom);
  const Vec2 now = ToPicture(view, size, at);
  view.centre = view.centre + (under - now);
}

void PanBy(CanvasView& view, double dx, double dy, int picture_width, int picture_height) noexcept {
  view.centre.x = std::clamp(view.centre.x - SignX(view) * dx / view.zoom, 0.0, picture_width - 1.0);
  view.centre.y = std::clamp(view.centre.y - SignY(view) * dy / view.zoom, 0.0, picture_height - 1.0);
}

void FitPicture(CanvasView& view, const CanvasSize& size, int picture_width, int picture_height) noexcept {
  // pixel centres are whole numbers, so the picture begins half a pixel before the first
  FitBox(view, size, {-0.5, -0.5}, {picture_width - 0.5, picture_height - 0.5});
}

void FitBox(CanvasView& view, const CanvasSize& size, const Vec2& low, const Vec2& high) noexcept {
  const double width = std::max(high.x - low.x, 1.0), height = std::max(high.y - low.y, 1.0);
  view.zoom = std::clamp(kMargin * std::min(size.width / width, size.height / height), kLeastZoom, kMostZoom);
  view.centre = 0.5 * (low + high);
}

void MirrorForRadiology(CanvasView& view, const std::array<std::string, 3>& axes) noexcept {
  view.is_mirrored_x = axes[0] == "right" || axes[0] == "anterior";
  view.is_mirrored_y = axes[1] == "anterior" || axes[1] == "superior";
}

EdgeLetters FindEdgeLetters(const CanvasView& view, const std::array<std::string, 3>& axes) {
  return {Letter(axes[0], view.is_mirrored_x), Letter(axes[0], !view.is_mirrored_x),
          Letter(axes[1], view.is_mirrored_y), Letter(axes[1], !view.is_mirrored_y)};
}

std::optional<std::size_t> HitPoint(const CanvasView& view, const CanvasSize& size,
                                    std::span<const Vec2> points, const Vec2& at, double reach) noexcept {
  std::optional<std::size_t> nearest;
  double best = reach;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = Norm(ToCanvas(view, size, points[i]) - at);
    if (distance <= best) best = distance, nearest = i;
  }
  return nearest;
}

std::optional<CurveHit> HitCurve(const CanvasView& view, const CanvasSize& size, std::span<const Vec2> curve,
                                 const Vec2& at, double reach) noexcept {
  std::optional<CurveHit> nearest;
  double best = reach;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Vec2 a = curve[i], chord = curve[(i + 1) % curve.size()] - a;
    const double length = Dot(chord, chord);
    const double t =
        length > 0 ? std::clamp(Dot(ToPicture(view, size, at) - a, chord) / length, 0.0, 1.0) : 0.0;
    const Vec2 here = a + t * chord;
    const double distance = Norm(ToCanvas(view, size, here) - at);
    if (distance <= best) best = distance, nearest = CurveHit{here, i, distance};
  }
  return nearest;
}

std::size_t FindInsertion(std::span<const Vec2> curve, std::span<const Vec2> controls,
                          std::size_t side) noexcept {
  // the place of each control point along the curve, in order from the first one on
  const std::size_t m = curve.size();
  std::vector<std::size_t> place(controls.size());
  for (std::size_t i = 0; i < controls.size(); ++i) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < m; ++k) {
      const double distance = Norm(curve[k] - controls[i]);
      if (distance < best) best = distance, place[i] = k;
    }
  }
  const auto after_first = [&](std::size_t k) { return (k + m - place[0]) % m; };
  std::size_t before = controls.size();
  for (std::size_t i = 1; i < controls.size(); ++i) {
    if (after_first(place[i]) > after_first(side)) {
      before = i;
      break;
    }
  }
  return before;
}

double ChooseScaleBar(double zoom, double pixel_mm, double pixels) noexcept {
  const double wanted = pixels / zoom * pixel_mm;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0}) {
    if (wanted >= step * power) return step * power;
  }
  return power;
}

}  // namespace trocar::editor
