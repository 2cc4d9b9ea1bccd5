// SPDX-License-Identifier: Apache-2.0
/// \file view_planner.h  Exposure: where the laparoscope is held so that what is judged or worked on is seen.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/math/pose.h"
#include "trocar/scene/scene.h"

namespace trocar::agent {

/// Points about a tube that are to be seen.
struct ViewField {
  const scene::LaparoscopeSetup* setup = nullptr;
  math::Vec3 middle;  ///< of the picture [m]
  math::Vec3 axis;    ///< unit, about which the lens is taken round
  /// Whether a lens shows what is to be seen, with nothing before it.
  std::function<bool(const math::Pose& X_world_lens)> shows;
};

/// A pose of the laparoscope from one side, with nothing before what is to be seen; those nearest to the trocar's own side are
/// tried first.
/// \param azimuth  of an eye about the axis; its sign is the side [rad]
/// \param side     +1 or -1
/// \param aside    azimuth on that side, at least [rad]
std::optional<instrument::TrocarJoints> FindSideView(
    const ViewField& field, const std::function<double(const math::Vec3& eye)>& azimuth, int side,
    double aside);

/// A pose from which a shaft does not hide the point at which its tip works.
/// \param now    pose of the lens
/// \param shaft  from the middle of the picture along the shaft [m]
/// \return nothing where the shaft is out of the way already, or no pose shows the point better
std::optional<instrument::TrocarJoints> FindViewPastShaft(const ViewField& field, const math::Pose& now,
                                                          const math::Vec3& shaft);

}  // namespace trocar::agent
