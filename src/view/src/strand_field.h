// SPDX-License-Identifier: Apache-2.0
/// \file strand_field.h  The connective tissue that dissection divides: fibres, lobules of fat, a film of peritoneum.
#pragma once

#include <span>
#include <vector>

#include "trocar/render/frame.h"
#include "trocar/simulation/operation_snapshot.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

class StrandField {
 public:
  /// \param strands  constant while the scene runs
  /// \param start    positions of their ends at rest [m]
  /// \pre the strands' rows lie in `start` (TROCAR_ASSERT)
  StrandField(std::span<const scene::StrandInfo> strands, std::span<const math::Vec3> start);

  /// Adds the strands that still hold; all of them where the snapshot does not say.
  void AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const;

 private:
  struct Strand {
    scene::StrandInfo info;
    double rest_length;  // [m]
    double breadth;      // of the film of a peritoneal strand [m]
  };
  std::vector<Strand> strands_;
};

}  // namespace trocar::view
