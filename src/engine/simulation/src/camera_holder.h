// SPDX-License-Identifier: Apache-2.0
/// \file camera_holder.h  Holds the laparoscope in the trainee's place.
///
/// As a good assistant does, it holds still while both tips are well inside of the picture, and moves slowly, the horizon
/// level, when one comes near the rim or the picture is too near or too far.
#pragma once

#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/scene/scene.h"

namespace trocar::simulation {

class CameraHolder {
 public:
  void Reset(const instrument::TrocarJoints& at) noexcept;
  /// \param tips  of the tools that have been pushed in [m]; none: it holds still
  /// \param dt    since the last call [s]
  /// \return joints of the laparoscope now
  /// \note Real-time safe.
  const instrument::TrocarJoints& Follow(const scene::LaparoscopeSetup& setup,
                                         std::span<const math::Vec3> tips, double dt) noexcept;
  const instrument::TrocarJoints& Now() const noexcept { return now_; }
  void VisitState(base::StateArchive& archive);

 private:
  instrument::TrocarJoints now_, to_;
  double since_look_ = 0;  // [s]
  bool is_moving_ = false;
};

}  // namespace trocar::simulation
