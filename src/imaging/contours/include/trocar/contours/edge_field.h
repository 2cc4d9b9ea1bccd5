// SPDX-License-Identifier: Apache-2.0
/// \file edge_field.h  A picture made ready for finding edges: computed once a slice, read while points drag.
#pragma once

#include <array>
#include <vector>

#include "trocar/images/image_stack.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// Red, green and blue [grey levels]; the fourth number is 0 and lets the compiler work on all at once.
using Colour = std::array<float, 4>;

/// Picture blurred by a Gaussian.
class EdgeField {
 public:
  /// \param blur_px  standard deviation of the Gaussian [pixels], > 0
  /// \pre the picture has at least one pixel (TROCAR_ASSERT)
  explicit EdgeField(const images::ColorImage& image, double blur_px = 1.5);

  int Width() const { return width_; }
  int Height() const { return height_; }
  double BlurPx() const { return blur_px_; }

  const Colour& At(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  /// Colour between pixels, bilinear; beyond the picture its border repeats.
  /// \param p  finite [pixels]
  Colour Sample(const math::Vec2& p) const;
  /// As Sample, from the original image without the blur.
  Colour SampleSharp(const math::Vec2& p) const;

 private:
  int width_, height_;
  double blur_px_;
  std::vector<Colour> pixels_;         // (height * width)
  std::vector<std::uint8_t> samples_;  // (height * width * 3) of the picture
};

}  // namespace trocar::contours
