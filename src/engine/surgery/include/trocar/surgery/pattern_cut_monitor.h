// SPDX-License-Identifier: Apache-2.0
/// \file pattern_cut_monitor.h  How the cuts in a sheet lie to the circle that is drawn on it.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/geometry/editable_mesh.h"

namespace trocar::surgery {

/// A level sheet that is held at its border, with a circle drawn round its middle.
struct PatternSheet {
  math::Vec3 centre;  ///< world frame [m]
  math::Vec3 half;    ///< of its sides along x and y [m]; z is 0
  double circle = 0;  ///< radius [m]
};

/// How a sheet is cut along the circle that is drawn on it. Places and lengths are those of the sheet at rest.
struct PatternCut {
  double cut_length = 0;  ///< [m]
  double farthest = 0;    ///< of a cut from the line: inside of it, or round the piece that came free [m]
  double off_area = 0;    ///< between the line and the rim of that piece [m^2]
  bool is_free = false;   ///< what the line encloses hangs on the border no more
  math::Vec3 p_farthest;  ///< world frame [m]
};

/// Judges by places at rest, so that it does not matter how the sheet is pulled.
class PatternCutMonitor {
 public:
  PatternCutMonitor(const PatternSheet& sheet, const geometry::EditableMesh& mesh);

  /// After a cut. A cut inside of the circle counts at once; outside of it only where it bounds the piece that came
  /// free, because one has to get to the circle.
  /// \note Real-time safe.
  void Update(const geometry::EditableMesh& mesh) noexcept;
  const PatternCut& Now() const { return now_; }
  void VisitState(base::StateArchive& archive);

 private:
  bool IsBorder(const math::Vec3& p_rest) const noexcept;
  void MarkPiece(const geometry::EditableMesh& mesh) noexcept;

  PatternSheet sheet_;
  std::uint32_t centre_ = 0;          // vertex in the middle of the circle
  std::vector<std::uint8_t> piece_;   // (triangles) 1: hangs together with the middle
  std::vector<std::uint32_t> stack_;  // of triangles
  PatternCut now_;
};

}  // namespace trocar::surgery
