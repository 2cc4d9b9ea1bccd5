// SPDX-License-Identifier: Apache-2.0
/// \file surface_updates.h  Which organs' surfaces are made anew after an edit.
#pragma once

#include <functional>
#include <vector>

#include "trocar/contours/contour_workspace.h"
#include "trocar/contours/mesh_job.h"

namespace trocar::editor {

class SurfaceUpdates {
 public:
  /// \param workspace   outlives this
  /// \param on_change   called by another thread: something can be taken, or the state has changed
  SurfaceUpdates(contours::ContourWorkspace& workspace, std::function<void()> on_change)
      : workspace_(workspace), job_(workspace.Fits(), std::move(on_change)) {}

  struct Change {
    bool is_everything_new = false;  ///< all surfaces so far are to be forgotten
    std::vector<int> without;        ///< organs nobody has begun, or that have lost their contours
  };
  /// Asks for the surfaces of the organs that have changed since the last request.
  /// \param is_all  of all
  Change Request(bool is_all);

  std::vector<contours::MeshOutcome> Take() { return job_.Take(); }
  contours::MeshJob::State GetState() const { return job_.GetState(); }
  void Cancel() { job_.Cancel(); }

 private:
  contours::ContourWorkspace& workspace_;
  std::vector<contours::Structure> meshed_;  // what the last requests were made from
  contours::MeshJob job_;
};

}  // namespace trocar::editor
