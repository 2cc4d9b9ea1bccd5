// SPDX-License-Identifier: Apache-2.0
/// \file heat_memory.h  A surgeon's memory of the places where current has flowed: a place that is warm is left alone.
#pragma once

#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/math/state_fields.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

class HeatMemory {
 public:
  void VisitState(base::StateArchive& archive) { archive.Field("warmths", warmths_); }
  /// Current has flowed at a place. \param seconds  >= 0
  void Add(const math::Vec3& place, double seconds);
  /// Time has passed: a place forgets all but 1 / e of its heat in kCools.
  void Cool(double seconds);
  /// Current that has flowed within kReach of a place and is not forgotten [s].
  double At(const math::Vec3& place) const;

  static constexpr double kCools = 6.0;     ///< [s]
  static constexpr double kReach = 0.0025;  ///< [m]

 private:
  struct Warmth {
    math::Vec3 place;
    double seconds = 0;

    void VisitState(base::StateArchive& archive) {
      archive.Field("place", place);
      archive.Field("seconds", seconds);
    }
  };
  std::vector<Warmth> warmths_;
};

}  // namespace trocar::agent
