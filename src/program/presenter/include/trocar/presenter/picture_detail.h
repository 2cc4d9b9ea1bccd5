// SPDX-License-Identifier: Apache-2.0
/// \file picture_detail.h  How finely the window draws: chosen by how long pictures take, from the first one on.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "trocar/render/frame.h"

namespace trocar::presenter {

/// Steps down as soon as pictures take longer than there is time for, and up again only where the finer step would fit, too;
/// where that was wrong, it waits longer the next time.
class PictureDetail {
 public:
  struct Step {
    render::Quality quality = render::Quality::kHigh;
    double resolution = 1;  ///< as render::Frame's

    friend bool operator==(const Step&, const Step&) = default;
  };

  /// \param is_drawn_by_processor  begins with the lowest quality, and never takes the other
  explicit PictureDetail(bool is_drawn_by_processor = false);

  /// After each picture. \param seconds  that it took, from its beginning until it is on the screen
  void AddPicture(double seconds);
  const Step& Now() const;

 private:
  void Go(std::size_t step);
  double CalcFiner(double median) const;

  std::size_t finest_, step_;
  std::vector<double> recent_;     // [s] of the pictures of this step, the last kJudged
  std::optional<double> coarser_;  // [s] what the next coarser step took, where this one was reached from it
  std::size_t calm_ = 0;           // pictures since the last change
  std::size_t calm_wanted_;        // before a finer step is tried
  bool is_tried_ = false;          // the finer step was taken by trial, and has not stood the test yet
};

}  // namespace trocar::presenter
