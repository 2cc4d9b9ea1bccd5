// SPDX-License-Identifier: Apache-2.0
/// \file tissue_colours.h  Distribution of one tissue's colours, and the distance of a colour from it.
/// Source: Mahalanobis, "On the generalised distance in statistics", 1936.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "trocar/contours/edge_field.h"

namespace trocar::contours {

/// Sums of colours and of their products, from which single places can be taken out again.
struct ColourMoments {
  double count = 0;
  std::array<double, 3> sum = {};
  std::array<double, 6> products = {};  ///< xx xy xz yy yz zz

  void Add(const Colour& c) {
    count += 1;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += c[i];
    products[0] += static_cast<double>(c[0]) * c[0], products[1] += static_cast<double>(c[0]) * c[1];
    products[2] += static_cast<double>(c[0]) * c[2], products[3] += static_cast<double>(c[1]) * c[1];
    products[4] += static_cast<double>(c[1]) * c[2], products[5] += static_cast<double>(c[2]) * c[2];
  }
  /// \param sign  1 adds, -1 takes away
  void Add(const ColourMoments& other, double sign);
};

/// A normal distribution of colours.
class TissueColours {
 public:
  /// \pre moments.count > 0
  explicit TissueColours(const ColourMoments& moments);

  /// Mahalanobis distance of a colour from the tissue [standard deviations].
  double Distance(const Colour& colour) const {
    const double x = colour[0] - mean_[0], y = colour[1] - mean_[1], z = colour[2] - mean_[2];
    const double squared = inverse_[0] * x * x + inverse_[3] * y * y + inverse_[5] * z * z +
                           2 * (inverse_[1] * x * y + inverse_[2] * x * z + inverse_[4] * y * z);
    return std::sqrt(std::max(0.0, squared));
  }

 private:
  std::array<double, 3> mean_;
  std::array<double, 6> inverse_;  // of the covariance
};

}  // namespace trocar::contours
