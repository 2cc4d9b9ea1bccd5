// SPDX-License-Identifier: Apache-2.0
/// \file edge_cost.h  How much each place of a straightened band looks like the border of what lies inside.
///
/// The colours inside are learned along the contour: mean and covariance, so that the combination of channels
/// that tells the organ from its surroundings counts, and a step from liver to muscle, small but surer than
/// the noise, as much as one from muscle to fat.
/// Source: Mahalanobis, "On the generalised distance in statistics", 1936; the region term is that of Chan
/// and Vese, "Active contours without edges", IEEE TIP 2001, along each normal.
#pragma once

#include <vector>

#include "edge_strip.h"

namespace trocar::contours {

/// Of every row and shift of a band.
struct EdgeEvidence {
  int reach = 0;  ///< shifts to either side [columns]
  std::vector<float>
      gradient;             ///< (rows * Columns()) change of colour along the normal [grey levels / pixel]
  std::vector<float> rise;  ///< (rows * Columns()) how fast the colours become unlike the inside [1 / pixel]
  std::vector<float> region;  ///< (rows * Columns()) cost of the colours on either side if the border were
                              ///< there, least 0 in every row, up to 1 a pixel on the wrong side [-]

  int Columns() const { return 2 * reach + 1; }
};

/// \param strip       band that is wider than the shifts on both sides
/// \param reach_px    largest shift [pixels]
/// \param row_px      distance of the strip's rows [pixels]
/// \param depth_px    what lies deeper below the curve may be its other side [pixels]
EdgeEvidence CalcEdgeEvidence(const EdgeStrip& strip, double reach_px, double row_px, double depth_px);

}  // namespace trocar::contours
