// SPDX-License-Identifier: Apache-2.0
/// \file lens_smear.h  Smear on the lens after it has touched tissue, until it is wiped outside.
#pragma once

#include <vector>

#include "trocar/render/frame.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// Follows the laparoscope from snapshot to snapshot; the same snapshots give the same smear.
class LensSmear {
 public:
  /// Touching tissue leaves blots; the laparoscope drawn back into its trocar is wiped, and a leap back in time starts clean.
  void Update(const simulation::Snapshot& snapshot);
  const std::vector<render::Blot>& Blots() const { return blots_; }

 private:
  std::vector<render::Blot> blots_;
  bool is_touching_ = false;
  double time_ = 0;  // of the last snapshot [s]
};

}  // namespace trocar::view
