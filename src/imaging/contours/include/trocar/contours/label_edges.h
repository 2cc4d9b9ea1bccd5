// SPDX-License-Identifier: Apache-2.0
/// \file label_edges.h  How far a label map's borders lie from the edges that the pictures show, and by what
/// shift of the whole map they would agree better: what an edge follower can be judged against.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::contours {

/// Distances between a label's border and the visible edge along the border's normal, over all slices.
struct LabelEdgeReport {
  std::string name;                   ///< of the structure
  std::size_t places = 0;             ///< on the border, 2 pixels apart
  double seen = 0;                    ///< share of them with an edge within reach [-]
  double mean_mm = 0, median_mm = 0;  ///< of the distances
  double signed_mean_mm = 0;          ///< > 0: the edge lies outside the label
  double within_1mm = 0;              ///< share of the seen places with the edge within 1 mm [-]
  /// Mean distance to the label of the contours drawn in the control points; 0 where there are none.
  double drawn_mm = 0;
};

struct LabelEdges {
  std::vector<LabelEdgeReport> as_given, shifted;  ///< one a structure with a reference label
  /// By which all labels together would fit the edges best: along columns, rows and slices [mm].
  std::array<double, 3> shift_mm = {0, 0, 0};
};

struct LabelEdgeOptions {
  std::filesystem::path control_points, images, reference;
  int every = 5;        ///< slices from one measured slice to the next, 1 to 1000
  double reach_mm = 8;  ///< how far from the label an edge is looked for, 1 to 30
  int most_slices = 4;  ///< the shift along the stack is sought up to so many slices, 0 to 20
};

/// Looks along the normals of every label's outline for the path on which the colours become unlike those
/// inside (edge_cost.h), no place within reach being preferred, and solves for the shift in least squares,
/// again and again from where it led, for each shift along the stack. Slices in reference_left_out are left
/// out.
/// \return kUsage for options out of range or control points without a reference label, and the errors of
/// reading
base::Result<LabelEdges> MeasureLabelEdges(const LabelEdgeOptions& options,
                                           const images::Progress& progress = {});

/// A row an organ and map for a person, below a row of headings in English.
std::vector<std::vector<std::string>> Tabulate(const LabelEdges& edges);
std::string FormatJson(const LabelEdges& edges);

}  // namespace trocar::contours
