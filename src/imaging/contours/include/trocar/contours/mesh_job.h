// SPDX-License-Identifier: Apache-2.0
/// \file mesh_job.h  Surfaces of organs, made anew in the background while their contours are edited.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/slice_fits.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::contours {

/// How fine a preview is.
enum class MeshLevel {
  kCoarse,  ///< first look while a contour changes
  kFine,    ///< what stays when nothing changes any more
};

/// A preview of one organ.
///
/// It goes the way of `trocar anatomy build` (fitted contours, slices between them, volume, MeshVolume) on a
/// coarser lattice; thin tips are not taken off and organs that overlap are not cut apart.
struct OrganMesh {
  geometry::TriangleMesh mesh;  ///< in the frame of the pictures: column, row, slice times distances [mm]
  MeshLevel level = MeshLevel::kCoarse;
  double spacing_mm = 0;  ///< of the lattice
  double volume_ml = 0;   ///< that it encloses
  bool is_closed = false, is_manifold = false;
  double seconds = 0;  ///< that it took
};

/// A consistent copy of what one organ's surface depends on.
struct MeshRequest {
  int structure = 0;
  Structure content;  ///< open contours are left out
  double pixel_mm = 1, slice_mm = 1;
};

/// Told what is being done and how much of it is done [0, 1].
/// \return false to give up
using MeshProgress = std::function<bool(std::string_view what, double fraction)>;

/// Distance of the lattice's points for an organ of this extent [mm]: never finer than the pixels, and so
/// coarse that the lattice has at most 56 (coarse) or 112 (fine) points on its longest side.
double CalcPreviewSpacing(double extent_mm, double pixel_mm, MeshLevel level);

/// Makes one preview in the calling thread.
///
/// \return kContourTooShort when there are not two slices with contours, kCancelled when `progress` gave up,
/// or why a picture cannot be had
base::Result<OrganMesh> MakePreviewMesh(const MeshRequest& request, SliceFits& fits, MeshLevel level,
                                        const MeshProgress& progress = {});

/// Result of a request for the mesh of one organ.
struct MeshOutcome {
  int structure = 0;
  base::Result<OrganMesh> result;
};

/// One thread that makes previews: first a coarse one of every organ that waits, then fine ones. The newest
/// request of an organ wins; an older one of it that is under way is given up.
class MeshJob {
 public:
  /// \param on_change  called from the thread when there is something to take or the state has changed; must
  /// return soon
  MeshJob(std::shared_ptr<SliceFits> fits, std::function<void()> on_change);
  /// Gives up what is under way.
  ~MeshJob();
  MeshJob(const MeshJob&) = delete;
  MeshJob& operator=(const MeshJob&) = delete;

  void Request(MeshRequest request);
  /// Gives up everything that is under way or waits.
  void Cancel();
  /// Finished previews and errors, oldest first; each is given once.
  std::vector<MeshOutcome> Take();

  struct State {
    bool is_busy = false;  ///< something is being made or waits
    int structure = 0;     ///< what is being made
    std::string what;      ///< "marching cubes"
    double fraction = 0;
  };
  State GetState() const;

 private:
  struct Waiting {
    MeshRequest request;
    MeshLevel level = MeshLevel::kCoarse;
    std::uint64_t number = 0;
  };
  void Run();
  std::optional<Waiting> NextWaiting() const;

  std::shared_ptr<SliceFits> fits_;  // shared with the window
  std::function<void()> on_change_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::map<int, Waiting> waiting_;  // by structure
  std::uint64_t requests_ = 0;
  bool is_given_up_ = false, is_ending_ = false;
  State state_;
  std::vector<MeshOutcome> outcomes_;
  std::thread thread_;
};

}  // namespace trocar::contours
