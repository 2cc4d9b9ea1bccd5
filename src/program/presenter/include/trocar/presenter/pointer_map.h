// SPDX-License-Identifier: Apache-2.0
/// \file pointer_map.h  How the picture lies to the joints: what makes a tip go right, up and away on the
/// screen.
#pragma once

#include "trocar/device/mouse_keyboard.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/math/pose.h"

namespace trocar::presenter {

/// Inverse of the derivative of tip = port + depth * axis(pan, tilt), whose columns are perpendicular.
///
/// \param joints        where the shaft is
/// \param X_world_view  camera: +x right and +y up in the picture, looking along -z
/// \param p_view_away   unit vector in the camera's frame along which "away" goes
/// \return  joint rates for one metre along each of the picture's axes; finite also where the shaft lies
/// along the
///          pan axis or the tip in the port, where the true rates would be infinite
device::PointerMap CalcPointerMap(const instrument::TrocarJoints& joints, const math::Pose& X_world_view,
                                  const math::Vec3& p_view_away = {0, 0, -1}) noexcept;

/// Line of sight through a point: a tip that goes along it stays on its spot of the picture.
/// \return unit vector in the camera's frame, away from it; straight ahead for a point that is not well before the lens
math::Vec3 CalcSightLine(const math::Pose& X_world_view, const math::Vec3& p_world) noexcept;

/// Size of one pixel at the tip, so that the tip stays under the pointer.
///
/// \param p_world_tip    [m]
/// \param field_of_view  over `pixels` [rad]
/// \param pixels         across that field of view, > 0
/// \return [m/pixel], within 10 um and 1 mm
double CalcMetresPerPixel(const math::Pose& X_world_view, const math::Vec3& p_world_tip, double field_of_view,
                          double pixels) noexcept;

}  // namespace trocar::presenter
