// SPDX-License-Identifier: Apache-2.0
/// \file sheet_monitor.h  How the cuts in a sheet lie to the circle that is drawn on it.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/core/state_archive.h"
#include "trocar/geometry/editable_mesh.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/operation_snapshot.h"

namespace trocar::simulation {

using math::Vec3;
using scene::ModelSheet;
using scene::VisitState;

/// Judges by places at rest, so that it does not matter how the sheet is pulled.
class SheetMonitor {
 public:
  SheetMonitor(const ModelSheet& sheet, const geometry::EditableMesh& mesh);

  /// After a cut. A cut inside of the circle counts at once; outside of it only where it bounds the piece that came
  /// free, because one has to get to the circle.
  /// \note Real-time safe.
  void Update(const geometry::EditableMesh& mesh) noexcept;
  const SheetSnapshot& Now() const { return now_; }
  void VisitState(core::StateArchive& archive);

 private:
  bool IsBorder(const Vec3& p_rest) const noexcept;
  void MarkPiece(const geometry::EditableMesh& mesh) noexcept;

  ModelSheet sheet_;
  std::uint32_t centre_ = 0;          // vertex in the middle of the circle
  std::vector<std::uint8_t> piece_;   // (triangles) 1: hangs together with the middle
  std::vector<std::uint32_t> stack_;  // of triangles
  SheetSnapshot now_;
};

}  // namespace trocar::simulation
