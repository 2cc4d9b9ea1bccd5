// SPDX-License-Identifier: Apache-2.0
/// \file agreement.h  How well raters agree: intraclass correlation.
/// Source: Shrout, Fleiss, "Intraclass correlations: uses in assessing rater reliability", Psychological Bulletin 86 (1979) 420-428;
/// the intervals of the cases with random raters: McGraw, Wong, Psychological Methods 1 (1996) 30-46.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::report {

/// One coefficient with the confidence interval that was asked for.
struct Icc {
  double value = 0, low = 0, high = 0;  ///< at most 1; may be negative
};

struct Agreement {
  std::size_t subjects = 0, raters = 0;
  double confidence = 0.95;
  Icc one_random;        ///< ICC(1,1): each subject was seen by other raters
  Icc two_random;        ///< ICC(2,1): raters are a sample of raters, absolute agreement
  Icc three_fixed;       ///< ICC(3,1): these raters and no others, consistency
  Icc one_random_mean;   ///< ICC(1,k): the same of the mean of all raters
  Icc two_random_mean;   ///< ICC(2,k)
  Icc three_fixed_mean;  ///< ICC(3,k)
};

/// \param ratings     (subjects * raters) rater by rater for each subject; finite
/// \param raters      >= 2; ratings.size() is a multiple of it, and there are at least two subjects
/// \param confidence  of the intervals, 0 to 1, both excluded
/// \return kRatingInvalid where the ratings are too few or not finite, or nothing varies
base::Result<Agreement> CalcAgreement(std::span<const double> ratings, std::size_t raters,
                                      double confidence = 0.95);

/// In words, of ICC(2,1) and the like: "poor" below 0.5, "moderate" below 0.75, "good" below 0.9, "excellent".
/// Source: Koo, Li, Journal of Chiropractic Medicine 15 (2016) 155-163.
std::string_view DescribeAgreement(double icc) noexcept;

}  // namespace trocar::report
