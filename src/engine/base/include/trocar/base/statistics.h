// SPDX-License-Identifier: Apache-2.0
/// \file statistics.h  Percentiles of measured times.
#pragma once

#include <vector>

namespace trocar::base {

/// Percentile by linear interpolation between the two nearest ranks (Hyndman and Fan 1996, type 7).
///
/// \param values    any order, any unit; copied because it is sorted
/// \param fraction  [-] in [0, 1]; 0.5 is the median
/// \return the percentile in the unit of the values; 0 for no values
double CalcPercentile(std::vector<double> values, double fraction);

}  // namespace trocar::base
