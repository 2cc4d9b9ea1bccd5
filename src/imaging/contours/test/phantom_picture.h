// SPDX-License-Identifier: Apache-2.0
/// \file phantom_picture.h  Pictures of a known shape, with a soft border and noise, for the contour tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "trocar/images/image_stack.h"
#include "trocar/math/random.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

struct PhantomPicture {
  int width = 160, height = 160;
  std::array<double, 3> inside = {110, 30, 25}, outside = {200, 170, 140};  // [grey levels]
  double softness = 1.2;                                                    // of the border [pixels]
  double noise = 6.0;                                                       // largest [grey levels]
  std::uint64_t seed = 1;
};

/// \param distance  signed distance to the border [pixels], > 0 outside
inline images::ColorImage DrawPhantom(const PhantomPicture& settings,
                                      const std::function<double(double x, double y)>& distance) {
  math::Random random(settings.seed);
  images::ColorImage image{settings.width, settings.height, {}};
  image.samples.resize(static_cast<std::size_t>(settings.width) * settings.height * 3);
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; ++x) {
      const double share = 0.5 * (1 + std::erf(distance(x, y) / (settings.softness * std::sqrt(2.0))));
      for (int c = 0; c < 3; ++c) {
        const double value = settings.inside[c] + share * (settings.outside[c] - settings.inside[c]) +
                             settings.noise * (random.Uniform() + random.Uniform() - 1);
        image.At(x, y)[c] = static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
      }
    }
  }
  return image;
}

/// Points of a curve given in polar form about a centre.
inline std::vector<math::Vec2> MakePolar(const math::Vec2& centre, int n,
                                         const std::function<double(double angle)>& radius) {
  std::vector<math::Vec2> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n;
    points.push_back(
        {centre.x + radius(angle) * std::cos(angle), centre.y + radius(angle) * std::sin(angle)});
  }
  return points;
}

}  // namespace trocar::contours
