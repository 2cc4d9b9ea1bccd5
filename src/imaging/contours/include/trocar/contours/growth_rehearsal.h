// SPDX-License-Identifier: Apache-2.0
/// \file growth_rehearsal.h  A simulated user who lets liver and gallbladder grow from a click each, and corrects what he
/// sees to be wrong.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/contour_workspace.h"
#include "trocar/images/image_stack.h"

namespace trocar::contours {

/// How the simulated user goes on from what grew: from the slice that is most wrong to the next.
struct GrowingUser {
  int clicks = 5;          ///< at most, where the one before was refused, >= 1
  double wrong_mm = 3.0;   ///< a point further than this from the organ's border is dragged to it, > 0
  double miss_mm = 1.0;    ///< by which every place misses that is clicked or dragged to, >= 0
  double poor = 0.85;      ///< a slice that overlaps less is drawn anew by 12 points [-]
  int drags = 25;          ///< points that are dragged at most in an organ
  int draws = 5;           ///< slices that are drawn anew, or emptied, at most in an organ
  bool uses_prior = true;  ///< off: growth without what is known of the organ's shape, for comparison
};

struct GrowthTrial {
  std::string organ;
  int clicks = 0;       ///< until it grew
  std::string refusal;  ///< of the last click, where none grew; then all numbers are 0
  std::size_t slices = 0, points = 0;
  int dragged = 0, drawn = 0;  ///< points and slices that were corrected
  double dice_grown = 0;       ///< of all slices, those without contours interpolated by shape [-]
  double dice_corrected = 0;   ///< after the corrections [-]
  double dice_contours = 0;    ///< of the contoured slices alone, after the corrections [-]
  double seconds = 0;          ///< that growing took
};

/// Grows and corrects liver and gallbladder, in this order, in the workspace's document.
///
/// A click lies in a slice that shows at least half the organ's largest area, at most half way from the place that is
/// deepest inside to the border.
/// \param reference  1 or "liver" and 2 or "gallbladder"; brought onto the series by AlignLabels
/// \return kLabelsMismatch for a reference of other images or without the organs; kCancelled; what reading returns
base::Result<std::vector<GrowthTrial>> RehearseGrowth(ContourWorkspace& workspace,
                                                      const images::LabelVolume& reference,
                                                      const GrowingUser& user, std::uint64_t seed,
                                                      std::stop_token stop = {},
                                                      const images::Progress& progress = {});

/// Dice of a structure's contours, filled, against a label; slices between them are interpolated by shape.
/// \param labels  a voxel a pixel, as AlignLabels makes it
double CalcFilledDice(const ControlPoints& points, const Structure& structure,
                      const images::LabelVolume& labels, int label);

}  // namespace trocar::contours
