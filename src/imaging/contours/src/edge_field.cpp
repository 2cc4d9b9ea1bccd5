// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/edge_field.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::contours {

using math::Vec2;

namespace {

std::vector<float> MakeGaussian(double sigma) {
  const int radius = base::CeilTo<int>(3.0 * sigma);
  std::vector<float> kernel(2 * static_cast<std::size_t>(radius) + 1);
  float sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    kernel[i + radius] = static_cast<float>(math::Exp(-0.5 * i * i / (sigma * sigma)));
    sum += kernel[i + radius];
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

void AddScaled(Colour& sum, float weight, const Colour& value) {
  for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * value[c];
}

/// Bilinear.
/// \param pixel  gives the colour at an index
template <typename Pixel>
Colour Interpolate(const Vec2& p, int width, int height, Pixel pixel) {
  const double x = std::clamp(p.x, 0.0, width - 1.0), y = std::clamp(p.y, 0.0, height - 1.0);
  const int ix = std::min(base::TruncateTo<int>(x), std::max(0, width - 2));
  const int iy = std::min(base::TruncateTo<int>(y), std::max(0, height - 2));
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const std::size_t right = width > 1 ? 1 : 0, below = height > 1 ? static_cast<std::size_t>(width) : 0;
  const std::size_t at =
      static_cast<std::size_t>(iy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(ix);
  const Colour corner = pixel(at), beside = pixel(at + right), under = pixel(at + below),
               across = pixel(at + below + right);
  Colour value;
  for (std::size_t c = 0; c < 4; ++c) {
    const float top = corner[c] + fx * (beside[c] - corner[c]);
    const float low = under[c] + fx * (across[c] - under[c]);
    value[c] = top + fy * (low - top);
  }
  return value;
}

}  // namespace

EdgeField::EdgeField(const images::ColorImage& image, double blur_px)
    : width_(image.width), height_(image.height), blur_px_(blur_px), samples_(image.samples) {
  TROCAR_ASSERT(width_ > 0 && height_ > 0 && blur_px > 0);
  const auto kernel = MakeGaussian(blur_px);
  const int radius = static_cast<int>(kernel.size() / 2);
  const auto row_length = static_cast<std::size_t>(width_);

  // along rows, one row at a time with its border repeated
  std::vector<Colour> padded(row_length + 2 * static_cast<std::size_t>(radius)), rows(row_length * height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = -radius; x < width_ + radius; ++x) {
      const auto* sample = image.At(std::clamp(x, 0, width_ - 1), y);
      padded[x + radius] = {static_cast<float>(sample[0]), static_cast<float>(sample[1]),
                            static_cast<float>(sample[2]), 0.0f};
    }
    for (int x = 0; x < width_; ++x) {
      Colour sum = {};
      for (std::size_t k = 0; k < kernel.size(); ++k) AddScaled(sum, kernel[k], padded[x + k]);
      rows[y * row_length + x] = sum;
    }
  }
  // along columns, a whole row at a time
  pixels_.assign(row_length * height_, Colour{});
  for (int y = 0; y < height_; ++y) {
    Colour* to = &pixels_[y * row_length];
    for (int k = -radius; k <= radius; ++k) {
      const Colour* from = &rows[std::clamp(y + k, 0, height_ - 1) * row_length];
      for (int x = 0; x < width_; ++x) AddScaled(to[x], kernel[k + radius], from[x]);
    }
  }
}

Colour EdgeField::Sample(const Vec2& p) const {
  return Interpolate(p, width_, height_, [&](std::size_t at) { return pixels_[at]; });
}

Colour EdgeField::SampleSharp(const Vec2& p) const {
  return Interpolate(p, width_, height_, [&](std::size_t at) {
    const std::uint8_t* sample = &samples_[3 * at];
    return Colour{static_cast<float>(sample[0]), static_cast<float>(sample[1]), static_cast<float>(sample[2]),
                  0.0f};
  });
}

}  // namespace trocar::contours
