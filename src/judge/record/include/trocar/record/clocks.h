// SPDX-License-Identifier: Apache-2.0
/// \file clocks.h  The wall clock beside the one that only runs forward: somebody sets the first, and nobody the second.
#pragma once

#include <optional>
#include <string>

namespace trocar::record {

/// Both clocks at one moment.
struct ClockReading {
  double steady = 0;  ///< since an arbitrary start, never set; it stands while the computer sleeps [s]
  double wall = 0;    ///< since 1970-01-01T00:00:00Z [s]
};

ClockReading ReadClocks();

/// Local time with its offset: "2026-11-24T22:50:20+01:00" (RFC 3339).
std::string FormatWallClock(double wall);

/// Notices that the wall clock was set, or that the computer slept.
class ClockWatch {
 public:
  explicit ClockWatch(ClockReading start) : last_(start) {}

  /// Call it often: what a clock is slewed by between two calls is no jump, for it is less than half a second.
  /// \return by how much the wall clock went other than time did since the last call [s]; nothing where it did not jump
  std::optional<double> See(ClockReading now);

 private:
  ClockReading last_;
};

}  // namespace trocar::record
