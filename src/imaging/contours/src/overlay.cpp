// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kPlaced = {255, 40, 40}, kAdapted = {255, 230, 0}, kInserted = {40, 230, 255},
                 kCurve = {40, 255, 80}, kTube = {80, 160, 255}, kReference = {255, 60, 255};
constexpr Colour kTint = {255, 255, 255};
constexpr double kTintShare = 0.15;
constexpr int kMargin = 30;  // photograph's pixels around the contours

void Put(images::ColorImage& image, int x, int y, const Colour& colour) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  std::copy(colour.begin(), colour.end(), image.At(x, y));
}

void DrawSquare(images::ColorImage& image, const Vec2& p, int half, const Colour& colour) {
  const int cx = base::RoundTo<int>(p.x), cy = base::RoundTo<int>(p.y);
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) Put(image, cx + x, cy + y, colour);
  }
}

void DrawLine(images::ColorImage& image, const Vec2& a, const Vec2& b, const Colour& colour) {
  const int steps = std::max(1, base::CeilTo<int>(2 * Norm(b - a)));
  for (int i = 0; i <= steps; ++i) {
    const Vec2 p = a + (static_cast<double>(i) / steps) * (b - a);
    Put(image, base::RoundTo<int>(p.x), base::RoundTo<int>(p.y), colour);
  }
}

}  // namespace

images::ColorImage DrawOverlay(const images::ColorImage& photograph, const Overlay& overlay, int scale) {
  TROCAR_ASSERT(scale >= 1 && scale <= 8);
  double low_x = photograph.width, low_y = photograph.height, high_x = 0, high_y = 0;
  const auto include = [&](const std::vector<Vec2>& points) {
    for (const Vec2& p : points) {
      low_x = std::min(low_x, p.x), low_y = std::min(low_y, p.y);
      high_x = std::max(high_x, p.x), high_y = std::max(high_y, p.y);
    }
  };
  for (const ContourStages& contour : overlay.contours) include(contour.placed), include(contour.curve);
  include(overlay.tube_points);
  if (low_x > high_x) low_x = low_y = 0, high_x = photograph.width - 1, high_y = photograph.height - 1;
  const int x0 = std::max(0, base::TruncateTo<int>(low_x) - kMargin),
            y0 = std::max(0, base::TruncateTo<int>(low_y) - kMargin);
  const int x1 = std::min(photograph.width - 1, base::TruncateTo<int>(high_x) + kMargin);
  const int y1 = std::min(photograph.height - 1, base::TruncateTo<int>(high_y) + kMargin);

  images::ColorImage picture{(x1 - x0 + 1) * scale, (y1 - y0 + 1) * scale, {}};
  picture.samples.resize(static_cast<std::size_t>(picture.width) * picture.height * 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const int px = x0 + x / scale, py = y0 + y / scale;
      const bool is_tinted =
          std::any_of(overlay.areas.begin(), overlay.areas.end(), [&](const images::Mask& m) {
            const int mx = px - m.x0, my = py - m.y0;
            return mx >= 0 && my >= 0 && mx < m.width && my < m.height && m.At(mx, my) != 0;
          });
      for (int c = 0; c < 3; ++c) {
        const double value = photograph.At(px, py)[c];
        const double drawn = is_tinted ? (1 - kTintShare) * value + kTintShare * kTint[c] : value;
        picture.At(x, y)[c] = base::TruncateTo<std::uint8_t>(drawn);
      }
    }
  }
  // pixel centres of the photograph lie in the middle of scale x scale squares
  const auto place = [&](const Vec2& p) {
    return Vec2{(p.x - x0 + 0.5) * scale - 0.5, (p.y - y0 + 0.5) * scale - 0.5};
  };
  const auto draw_closed = [&](const std::vector<Vec2>& line, const Colour& colour) {
    for (std::size_t i = 0; i < line.size(); ++i)
      DrawLine(picture, place(line[i]), place(line[(i + 1) % line.size()]), colour);
  };
  for (const auto& outline : overlay.reference) draw_closed(outline, kReference);
  for (const ContourStages& contour : overlay.contours) {
    draw_closed(contour.curve, kCurve);
    for (const Vec2& p : contour.placed) DrawSquare(picture, place(p), 1, kPlaced);
    for (const Vec2& p : contour.adapted) DrawSquare(picture, place(p), 1, kAdapted);
    for (const Vec2& p : contour.inserted) DrawSquare(picture, place(p), 1, kInserted);
  }
  for (const Vec2& p : overlay.tube_points) {
    const Vec2 at = place(p);
    DrawLine(picture, {at.x - 4, at.y}, {at.x + 4, at.y}, kTube);
    DrawLine(picture, {at.x, at.y - 4}, {at.x, at.y + 4}, kTube);
  }
  return picture;
}

}  // namespace trocar::contours
