// SPDX-License-Identifier: Apache-2.0
/// \file critical_view.h  The critical view of safety, computed, with its reasons in plain words.
///
/// Source: Strasberg's three criteria, made computable as in the domain facts, section 1.2: the hepatocystic
/// triangle is cleared of fat and fibrous tissue; the lower third of the gallbladder is off the liver, so that the
/// cystic plate shows; two and only two structures enter the gallbladder. All three must have been seen together,
/// from the front and from behind.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trocar/base/state_archive.h"

namespace trocar::cholecystectomy {

/// Facts of the dissection in a tick, all from geometry and from the graph of tubes.
struct DissectionFacts {
  double cleared_share =
      0;  ///< of the fat over the triangle's window at the start: see TriangleWindow, 0 to 1 [-]
  double detached_share =
      0;  ///< of the bed's length, counted from the infundibulum without a gap, 0 to 1 [-]
  int structures_entering = 0;  ///< tubes that enter the gallbladder and are not cut
  /// Freed of strands all around, next to the gallbladder, of each tube that enters [m].
  std::vector<double> skeletonised;
  /// (skeletonised) As much of it as may be asked for: what lies beside a main duct or artery need not be exposed [m].
  std::vector<double> exposable;
  bool is_triangle_in_view = false;  ///< unoccluded, in the picture, wholly
  /// Direction of sight about the cystic duct, in the frame of the gallbladder's neck: from -pi to pi; views to either
  /// side of 0, the view at the start, show its front and its back [rad].
  double view_azimuth = 0;
};

void VisitState(base::StateArchive& archive, DissectionFacts& facts);

struct CriticalViewSettings {
  double cleared_share = 0.9;
  double detached_share = 1.0 / 3;
  double skeletonised = 0.010;  ///< of each that enters, or what is exposable of it [m]
  double seen_seconds = 1.0;    ///< of each view [s]
  double azimuth_apart = 0.5;   ///< that front and back views differ by at least [rad]
};

/// How far each criterion is met: 0 not, 1 in part, 2 whole; as in the published score (0 to 6).
struct CriticalViewScore {
  std::array<int, 3> criteria{};  ///< triangle, plate, two structures
  bool is_seen_from_front = false, is_seen_from_behind = false;

  int Sum() const { return criteria[0] + criteria[1] + criteria[2]; }
  /// Every criterion whole, and both views seen.
  bool IsAchieved() const { return Sum() == 6 && is_seen_from_front && is_seen_from_behind; }
};

/// Follows a dissection. Views count only while the three criteria are whole, and what was seen is forgotten when
/// one of them no longer is.
class CriticalView {
 public:
  explicit CriticalView(const CriticalViewSettings& settings = {}) : settings_(settings) {}

  /// One tick.
  /// \param seconds  > 0
  /// \note Real-time safe.
  void Update(const DissectionFacts& facts, double seconds) noexcept;
  const CriticalViewScore& Score() const noexcept { return score_; }
  void VisitState(base::StateArchive& archive);

 private:
  CriticalViewSettings settings_;
  CriticalViewScore score_;
  double front_seconds_ = 0, behind_seconds_ = 0;
};

/// Explains the parts of the critical view that are still missing, a sentence each; empty when achieved.
std::vector<std::string> ExplainCriticalView(const DissectionFacts& facts, const CriticalViewScore& score,
                                             const CriticalViewSettings& settings = {});

}  // namespace trocar::cholecystectomy
