// SPDX-License-Identifier: Apache-2.0
/// \file edge_cost.h  How much each place of a straightened band looks like the border between the band's two sides.
/// Source: Fisher, "The use of multiple measurements in taxonomic problems", 1936, for the combination of the colour
/// channels; the region term is that of Chan and Vese, "Active contours without edges", IEEE TIP 2001, along each
/// normal.
#pragma once

#include <vector>

#include "edge_strip.h"

namespace trocar::anatomy {

/// Of every row and shift of a band.
struct EdgeEvidence {
  int reach = 0;                ///< shifts to either side [columns]
  std::vector<float> gradient;  ///< (rows * Columns()) fall of the combined channels outwards [grey levels / pixel]
  std::vector<float> region;    ///< (rows * Columns()) cost of the colours on either side if the border were there,
                                ///< least 0 in every row, about 1 a pixel on the wrong side [-]

  int Columns() const { return 2 * reach + 1; }
};

/// \param strip       band that is wider than the shifts on both sides
/// \param reach_px    largest shift [pixels]
/// \param row_px      distance of the strip's rows [pixels]
EdgeEvidence CalcEdgeEvidence(const EdgeStrip& strip, double reach_px, double row_px);

}  // namespace trocar::anatomy
