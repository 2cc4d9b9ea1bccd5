// SPDX-License-Identifier: Apache-2.0
/// \file liquids.h  Blood and bile on their way and where they gather.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/render/frame.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Adds what runs and drips out of every leak.
void AddStreams(render::Frame& frame, const simulation::Snapshot& snapshot);

/// What lies under a pool: a small piece of a surface that faces up or down.
struct GroundPiece {
  math::Vec3 p_world;  ///< [m]
  math::Vec3 area;     ///< normal times area [m^2]
};
/// One piece a vertex.
std::vector<GroundPiece> MakeGround(const geometry::TriangleMesh& mesh);

/// The pool. It fills the hollows round the lowest place, of what is drawn but belongs to no patient.
class Pool {
 public:
  explicit Pool(std::vector<GroundPiece> ground) : ground_(std::move(ground)) {}

  void AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const;

 private:
  std::vector<GroundPiece> ground_;
};

}  // namespace trocar::view
