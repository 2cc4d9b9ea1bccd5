// SPDX-License-Identifier: Apache-2.0
/// \file procedure_snapshot.h  How a procedure stands after a tick: phase, measures and the view that has to be reached, by the rows
/// of its tables (scene/procedure.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace trocar::scene {

/// The view that has to be reached before what leaves the body is divided.
struct ViewScore {
  std::vector<std::uint8_t> criteria;  ///< (Procedure::criteria) 0 not met, 1 in part, 2 whole
  std::vector<std::uint8_t> sights;    ///< (Procedure::sights) 1: seen from there for long enough

  int Sum() const noexcept { return std::accumulate(criteria.begin(), criteria.end(), 0); }
  /// 0 of a criterion that there is not.
  int Points(std::size_t criterion) const noexcept {
    return criterion < criteria.size() ? criteria[criterion] : 0;
  }
  bool IsWhole(std::size_t criterion) const noexcept { return Points(criterion) == kWhole; }
  bool IsSeen(std::size_t sight) const noexcept { return sight < sights.size() && sights[sight] != 0; }
  bool AreCriteriaWhole() const noexcept {
    return !criteria.empty() &&
           std::all_of(criteria.begin(), criteria.end(), [](std::uint8_t grade) { return grade == kWhole; });
  }
  /// Every criterion whole, and every sight seen; never of a procedure that asks for no view.
  bool IsAchieved() const noexcept {
    return AreCriteriaWhole() &&
           std::all_of(sights.begin(), sights.end(), [](std::uint8_t is_seen) { return is_seen != 0; });
  }
  static constexpr std::uint8_t kWhole = 2;
};

/// Sizes stay while a scene runs, so that copying allocates nothing.
struct ProcedureSnapshot {
  std::uint8_t phase = 0;        ///< row of Procedure::phases
  std::vector<double> measures;  ///< (Procedure::measures)
  ViewScore view;

  /// 0 of a row that there is not.
  double Measure(std::size_t row) const noexcept { return row < measures.size() ? measures[row] : 0.0; }
};

}  // namespace trocar::scene
