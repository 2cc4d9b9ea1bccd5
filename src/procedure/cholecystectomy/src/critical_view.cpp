// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/critical_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "trocar/base/assert.h"
#include "trocar/base/state_archive.h"

namespace trocar::cholecystectomy {
namespace {

constexpr double kHalf = 0.5;  // of a criterion: then it counts as met in part

/// 0, 1 or 2 for a share of what is wanted. A share that is no number is none.
int Grade(double value, double wanted) noexcept {
  if (value >= wanted) return 2;
  return value >= kHalf * wanted ? 1 : 0;
}

/// Of a tube that enters [m].
double WantedOf(const DissectionFacts& facts, std::size_t tube, double skeletonised) noexcept {
  return std::min(skeletonised, facts.exposable[tube]);
}

/// Two structures, both freed; in part: two, not yet freed.
int GradeStructures(const DissectionFacts& facts, double skeletonised) noexcept {
  TROCAR_ASSERT(facts.exposable.size() == facts.skeletonised.size());
  const bool are_two = facts.structures_entering == 2 && facts.skeletonised.size() == 2;
  if (!are_two) return 0;
  const auto grade = [&](std::size_t tube) {
    return Grade(facts.skeletonised[tube], WantedOf(facts, tube, skeletonised));
  };
  return std::min(grade(0), grade(1));
}

std::string Percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

}  // namespace

void CriticalView::Update(const DissectionFacts& facts, double seconds) noexcept {
  score_.criteria = {Grade(facts.cleared_share, settings_.cleared_share),
                     Grade(facts.detached_share, settings_.detached_share),
                     GradeStructures(facts, settings_.skeletonised)};
  if (score_.Sum() < 6) {
    front_seconds_ = behind_seconds_ = 0;
  } else if (facts.is_triangle_in_view && std::isfinite(facts.view_azimuth)) {
    // the two views lie to either side of the plane through duct and bed
    const double side = kHalf * settings_.azimuth_apart;
    if (facts.view_azimuth <= -side) front_seconds_ += seconds;
    if (facts.view_azimuth >= side) behind_seconds_ += seconds;
  }
  score_.is_seen_from_front = front_seconds_ >= settings_.seen_seconds;
  score_.is_seen_from_behind = behind_seconds_ >= settings_.seen_seconds;
}

std::vector<std::string> ExplainCriticalView(const DissectionFacts& facts, const CriticalViewScore& score,
                                             const CriticalViewSettings& settings) {
  std::vector<std::string> reasons;
  if (score.criteria[0] < 2) {
    reasons.push_back("The hepatocystic triangle is not clear: " + Percent(1.0 - facts.cleared_share) +
                      " of the fat over its window is left, " + Percent(1.0 - settings.cleared_share) +
                      " may be.");
  }
  if (score.criteria[1] < 2) {
    reasons.push_back("The gallbladder is still on the cystic plate: " + Percent(facts.detached_share) +
                      " of the bed is free from the infundibulum on, a third is needed.");
  }
  if (score.criteria[2] < 2) {
    if (facts.structures_entering != 2) {
      reasons.push_back(std::to_string(facts.structures_entering) +
                        " structures enter the gallbladder; there must be two and only two.");
    } else {
      const auto lacks = [&](std::size_t tube) {
        return WantedOf(facts, tube, settings.skeletonised) - facts.skeletonised[tube];
      };
      const std::size_t tube = lacks(0) > lacks(1) ? 0 : 1;
      char text[160];
      std::snprintf(
          text, sizeof text,
          "Two structures enter the gallbladder, but one is freed over %.0f mm only; %.0f mm are needed.",
          1e3 * facts.skeletonised[tube], 1e3 * WantedOf(facts, tube, settings.skeletonised));
      reasons.emplace_back(text);
    }
  }
  if (score.Sum() == 6) {
    if (!score.is_seen_from_front) reasons.emplace_back("Look at it from the front for a second.");
    if (!score.is_seen_from_behind)
      reasons.emplace_back("Flip the infundibulum and look at it from behind for a second.");
  }
  return reasons;
}

void VisitState(base::StateArchive& archive, DissectionFacts& facts) {
  archive.Field("cleared_share", facts.cleared_share);
  archive.Field("detached_share", facts.detached_share);
  archive.Field("structures_entering", facts.structures_entering);
  archive.Field("skeletonised", facts.skeletonised);
  archive.Field("exposable", facts.exposable);
  archive.Field("is_triangle_in_view", facts.is_triangle_in_view);
  archive.Field("view_azimuth", facts.view_azimuth);
}

void CriticalView::VisitState(base::StateArchive& archive) {
  archive.Field("criteria", score_.criteria);
  archive.Field("is_seen_from_front", score_.is_seen_from_front);
  archive.Field("is_seen_from_behind", score_.is_seen_from_behind);
  archive.Field("front_seconds", front_seconds_);
  archive.Field("behind_seconds", behind_seconds_);
}

}  // namespace trocar::cholecystectomy
