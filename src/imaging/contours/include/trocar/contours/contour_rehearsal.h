// SPDX-License-Identifier: Apache-2.0
/// \file contour_rehearsal.h  A simulated user: clicks on a reference's outline with a shaking hand, and what
/// the contour chain makes of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/reference_contours.h"
#include "trocar/images/image_stack.h"
#include "trocar/math/random.h"

namespace trocar::contours {

/// How the simulated user clicks.
struct ClickSettings {
  int every = 8;                        ///< slices from one contoured slice to the next, >= 1
  std::array<int, 2> points = {8, 12};  ///< fewest and most points on a slice's longest outline, >= 3
  double noise_mm = 3.0;                ///< each point is moved by this much in a random direction, >= 0
  double reach_mm = 5.0;                ///< how far the edge adaption may move a point, >= 0
  double skipped_mm = 2.0;              ///< and the contour of a skipped slice, >= 0
};

/// Points on an outline as a person would click them.
///
/// They lie at equal steps along the outline from a random start; then each moves by exactly `noise_px`, in a
/// direction drawn evenly from the full circle. A polygon that crosses itself is drawn anew, up to 100 times.
/// \param count  >= 3
/// \return `count` points inside the picture [pixels]
std::vector<math::Vec2> SimulateClicks(const Outline& outline, int count, double noise_px,
                                       const ControlPoints& series, math::Random& random);

/// One structure of the series clicked anew: every n-th slice from a random first one.
///
/// Every outline gets points: the longest of the slice between points[0] and points[1], the others in
/// proportion to their length, at least 4. Outlines on which 8 points would lie closer together than the
/// noise are left out, for nobody could click them; holes are clicked like contours. Slices where the
/// reference is known to be wrong are left out; the slices before and after are clicked in their place.
/// \return the structure; without slices where the reference has none
Structure SimulateUser(const images::LabelVolume& labels, const ControlPoints& series,
                       const Structure& structure, const ClickSettings& settings, std::uint64_t seed);

/// Result of one simulated user with one organ.
struct RehearsalRun {
  std::uint64_t seed = 0;
  std::size_t slices = 0, points = 0, inserted = 0, notes = 0;
  double error_placed_mm = 0,
         error_adapted_mm = 0;               ///< mean distance of the points to the reference's outline
  double dice_placed = 0, dice_adapted = 0;  ///< of the meshes from clicked and from adapted points [-]
};

struct OrganRehearsal {
  std::string name;
  std::vector<RehearsalRun> runs;
};

struct RehearsalOptions {
  std::filesystem::path
      control_points;               ///< for the series' geometry and the organs' names, labels and budgets
  std::filesystem::path images;     ///< folder of slices
  std::filesystem::path reference;  ///< label map
  std::string organ;                ///< only this one; empty: all with a reference label
  ClickSettings clicks;
  std::uint64_t seed = 1;                         ///< of the first run; the next runs count on
  int runs = 5;                                   ///< >= 1
  std::optional<std::filesystem::path> overlays;  ///< pictures of the first run, one a slice
};

/// Runs the chain of BuildOrgans on simulated clicks, once as clicked and once adapted.
/// \return kUsage for options out of range or an unknown organ, and the errors of reading, building and
/// judging
base::Result<std::vector<OrganRehearsal>> RehearseContours(const RehearsalOptions& options,
                                                           const images::Progress& progress = {});

/// Means and deviations over the runs for a person, a row an organ below a row of headings in English; every organ has a run.
std::vector<std::vector<std::string>> Tabulate(const std::vector<OrganRehearsal>& organs);
/// Every run, and the spread of its measures.
std::string FormatJson(const std::vector<OrganRehearsal>& organs);

}  // namespace trocar::contours
