// SPDX-License-Identifier: Apache-2.0
/// \file rating.h  Ratings of an attempt by people, on established scales of surgery: GOALS and the global rating scale of OSATS.
/// Files: assets/rating/*.json (schemas/rating-form.schema.json); schemas/rating.schema.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/report/agreement.h"
#include "trocar/report/document.h"

namespace trocar::report {

struct RatingItem {
  std::string key;                      ///< "depth_perception"
  std::string name;                     ///< "Depth perception"
  std::string lowest, middle, highest;  ///< what the least, the middle and the most points are given for
};

/// Every item is given kLeastPoints to kMostPoints.
struct RatingForm {
  std::string key;   ///< "goals"
  std::string name;  ///< "GOALS"
  std::string about, source;
  std::vector<RatingItem> items;
};
inline constexpr int kLeastPoints = 1, kMostPoints = 5;

/// One person's rating of one attempt.
struct Rating {
  std::string form;                                 ///< key
  std::string attempt;                              ///< what was rated: the recording's file name
  std::string rater;                                ///< pseudonym
  std::string rated;                                ///< date, RFC 3339; may be empty
  std::string remarks;                              ///< may be empty
  std::vector<std::pair<std::string, int>> points;  ///< of each item, in the form's order

  int Sum() const;
};

/// Keys of the delivered forms.
std::vector<std::string> ListRatingForms();
/// A delivered form, or a file. \return kUnknownName with those known; the file's error with its JSON path
base::Result<RatingForm> FindRatingForm(const std::string& key_or_path);
base::Result<RatingForm> ReadRatingForm(const std::filesystem::path& path);

/// "depth_perception=4" for each item.
/// \return kRatingInvalid where an item is missing, unknown, given twice, or out of range
base::Result<std::vector<std::pair<std::string, int>>> ParsePoints(const RatingForm& form,
                                                                   const std::vector<std::string>& words);

/// \return the file's error; kRatingInvalid where it does not fit its form
base::Result<Rating> ReadRating(const std::filesystem::path& path);
/// As ReadRating reads it.
std::string FormatRating(const Rating& rating);

/// To be printed and filled in by hand.
Document MakeRatingSheet(const RatingForm& form);

/// Agreement on the sum and on each item.
struct FormAgreement {
  std::vector<std::string> attempts, raters;  ///< that were compared, in alphabetical order
  std::vector<std::pair<std::string, Agreement>>
      of;  ///< "sum", then items; those that do not vary are left out
};
/// \param ratings  of one form; every rater rated every attempt, once
/// \return kRatingInvalid where they did not, naming what is missing
base::Result<FormAgreement> CompareRatings(const RatingForm& form, const std::vector<Rating>& ratings,
                                           double confidence = 0.95);

}  // namespace trocar::report
