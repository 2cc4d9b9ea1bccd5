// SPDX-License-Identifier: Apache-2.0
#include "figure_strokes.h"

#include <algorithm>
#include <cmath>

namespace trocar::render {
namespace {

using math::Vec2;
using math::Vec3;

constexpr double kNearShare = 0.02, kFarShare = 40.0;  // of the camera's distance
constexpr double kTowardsLens = 0.9992;  // of their depth, at which marks lie: they win against their surface
constexpr double kCornerPixels = 62, kAxisPixels = 36, kLetterPixels = 11;

float F(double value) {
  return static_cast<float>(value);
}
std::array<float, 3> ToFloats(const SrgbColour& colour) {
  return {F(colour[0]), F(colour[1]), F(colour[2])};
}

/// A rectangle about the segment a-b given in clip space, `half` pixels to either side.
struct ClipPoint {
  double x, y, z, w;
};

class Pen {
 public:
  Pen(int width, int height) : width_(width), height_(height) {}

  void Line(std::vector<StrokeVertex>& out, const ClipPoint& a, const ClipPoint& b, double half,
            const SrgbColour& colour) const {
    const Vec2 from = ToPixel(a), to = ToPixel(b);
    const double length = std::max(std::hypot(to.x - from.x, to.y - from.y), 1e-9);
    const Vec2 along = (1.0 / length) * (to - from);
    const Vec2 across = {-along.y * half, along.x * half};
    // a little longer, so that the pieces of a polyline overlap
    const Vec2 cap = (0.5 * half) * along;
    Rectangle(out,
              {Shift(a, Vec2{-1, -1}, across, cap), Shift(a, Vec2{1, -1}, across, cap),
               Shift(b, Vec2{1, 1}, across, cap), Shift(b, Vec2{-1, 1}, across, cap)},
              colour, 0);
  }
  void Disc(std::vector<StrokeVertex>& out, const ClipPoint& p, double radius,
            const SrgbColour& colour) const {
    const Vec2 x = {radius, 0}, y = {0, radius};
    Rectangle(out,
              {Shift(p, Vec2{-1, -1}, x, y), Shift(p, Vec2{1, -1}, x, y), Shift(p, Vec2{1, 1}, x, y),
               Shift(p, Vec2{-1, 1}, x, y)},
              colour, 1);
  }

 private:
  Vec2 ToPixel(const ClipPoint& p) const { return {0.5 * width_ * p.x / p.w, 0.5 * height_ * p.y / p.w}; }
  ClipPoint Shift(ClipPoint p, const Vec2& weights, const Vec2& u, const Vec2& v) const {
    const Vec2 away = weights.x * u + weights.y * v;
    p.x += 2.0 * away.x / width_ * p.w;
    p.y += 2.0 * away.y / height_ * p.w;
    return p;
  }
  static void Rectangle(std::vector<StrokeVertex>& out, const std::array<ClipPoint, 4>& corners,
                        const SrgbColour& colour, float kind) {
    constexpr std::array<std::array<float, 2>, 4> kLocal = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (const int i : {0, 1, 2, 0, 2, 3}) {
      const ClipPoint& p = corners[i];
      out.push_back({{F(p.x), F(p.y), F(p.z), F(p.w)}, ToFloats(colour), {kLocal[i][0], kLocal[i][1], kind}});
    }
  }

  double width_, height_;
};

class Projector {
 public:
  Projector(const OrbitCamera& camera, int width, int height)
      : to_camera_(math::Inverse(camera.R_world_camera)),
        position_(camera.Position()),
        range_(CalcDepthRange(camera)),
        focal_(1.0 / std::tan(0.5 * camera.field_of_view)),
        aspect_(static_cast<double>(width) / height) {}

  Vec3 ToCamera(const Vec3& p_world) const { return math::Rotate(to_camera_, p_world - position_); }
  bool IsInFront(const Vec3& p) const { return -p.z > range_.near; }
  double NearZ() const { return -1.0001 * range_.near; }
  /// \param p  camera frame
  ClipPoint ToClip(Vec3 p) const {
    p *= kTowardsLens;
    const double a = (range_.far + range_.near) / (range_.near - range_.far);
    const double b = 2.0 * range_.far * range_.near / (range_.near - range_.far);
    return {focal_ / aspect_ * p.x, focal_ * p.y, a * p.z + b, -p.z};
  }

 private:
  math::Quaternion to_camera_;
  Vec3 position_;
  DepthRange range_;
  double focal_, aspect_;
};

/// Strokes of a letter in a box of height 1, from its lower left corner.
std::vector<std::vector<Vec2>> LetterStrokes(char letter) {
  switch (letter) {
    case 'L':
      return {{{0, 1}, {0, 0}, {0.6, 0}}};
    case 'A':
      return {{{0, 0}, {0.36, 1}, {0.72, 0}}, {{0.13, 0.36}, {0.59, 0.36}}};
    default:
      return {{{0.62, 0.84},
               {0.48, 0.98},
               {0.16, 0.98},
               {0.02, 0.84},
               {0.02, 0.66},
               {0.16, 0.54},
               {0.48, 0.46},
               {0.62, 0.34},
               {0.62, 0.15},
               {0.48, 0.02},
               {0.16, 0.02},
               {0.02, 0.15}}};
  }
}

}  // namespace

DepthRange CalcDepthRange(const OrbitCamera& camera) {
  return {kNearShare * camera.distance, kFarShare * camera.distance};
}

Strokes MakeStrokes(const FigureMarks& marks, const OrbitCamera& camera, int width, int height,
                    double scale) {
  const Pen pen(width, height);
  const Projector projector(camera, width, height);
  Strokes strokes;
  for (const FigureLine& line : marks.lines) {
    auto& out = line.is_on_top ? strokes.on_top : strokes.hidden;
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      Vec3 a = projector.ToCamera(line.points[i]), b = projector.ToCamera(line.points[i + 1]);
      const bool has_a = projector.IsInFront(a), has_b = projector.IsInFront(b);
      if (!has_a && !has_b) continue;
      // what reaches behind the lens is cut where the picture begins
      if (!has_a) a = math::Lerp(b, a, (projector.NearZ() - b.z) / (a.z - b.z));
      if (!has_b) b = math::Lerp(a, b, (projector.NearZ() - a.z) / (b.z - a.z));
      pen.Line(out, projector.ToClip(a), projector.ToClip(b), 0.5 * scale * line.width, line.colour);
    }
  }
  for (const FigurePoint& point : marks.points) {
    const Vec3 p = projector.ToCamera(point.position);
    if (!projector.IsInFront(p)) continue;
    pen.Disc(point.is_on_top ? strokes.on_top : strokes.hidden, projector.ToClip(p),
             0.5 * scale * point.diameter, point.colour);
  }
  return strokes;
}

std::vector<StrokeVertex> MakeAxes(const OrbitCamera& camera, int width, int height, double scale) {
  struct Axis {
    Vec3 direction;
    char letter;
    SrgbColour colour;
    Vec3 seen;
  };
  std::array<Axis, 3> axes = {{{{1, 0, 0}, 'L', {0.93, 0.42, 0.38}, {}},
                               {{0, 1, 0}, 'S', {0.47, 0.82, 0.45}, {}},
                               {{0, 0, 1}, 'A', {0.43, 0.66, 0.98}, {}}}};
  const math::Quaternion to_camera = math::Inverse(camera.R_world_camera);
  for (Axis& axis : axes) axis.seen = math::Rotate(to_camera, axis.direction);
  // the axis that comes nearest to the viewer is drawn last
  std::stable_sort(axes.begin(), axes.end(),
                   [](const Axis& a, const Axis& b) { return a.seen.z < b.seen.z; });
  const Pen pen(width, height);
  const auto at = [&](const Vec2& pixel) {
    return ClipPoint{2.0 * scale * pixel.x / width - 1.0, 2.0 * scale * pixel.y / height - 1.0, 0, 1};
  };
  std::vector<StrokeVertex> out;
  const Vec2 corner = {kCornerPixels, kCornerPixels};
  for (const Axis& axis : axes) {
    const Vec2 direction = {axis.seen.x, axis.seen.y};
    pen.Line(out, at(corner), at(corner + kAxisPixels * direction), 1.2 * scale, axis.colour);
    const Vec2 letter =
        corner + (kAxisPixels + kLetterPixels) * direction - Vec2{0.33 * kLetterPixels, 0.5 * kLetterPixels};
    for (const auto& stroke : LetterStrokes(axis.letter)) {
      for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
        pen.Line(out, at(letter + kLetterPixels * stroke[i]), at(letter + kLetterPixels * stroke[i + 1]),
                 0.8 * scale, axis.colour);
      }
    }
  }
  return out;
}

}  // namespace trocar::render
