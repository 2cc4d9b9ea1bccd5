// SPDX-License-Identifier: Apache-2.0
/// \file camera_planner.h  The laparoscope under way: it turns at a steady pace to the pose that is wanted, and follows a tool that
/// leaves the picture.
#pragma once

#include "place.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/math/pose.h"
#include "trocar/scene/scene.h"

namespace trocar::agent {

/// Camera work of an operator.
struct CameraWork {
  instrument::TrocarJoints now, to;  ///< of the laparoscope
  Place field;                       ///< what the picture is about
  bool follows = false;              ///< the right hand's tool
  double first_azimuth = 0;          ///< of the lens about the axis of its views, at the start [rad]
  double unseen_seconds = 0;         ///< for which the tool has been out of the picture

  bool HasArrived() const { return now == to; }
};

/// Aims at a point from about a distance; stays where the laparoscope does not get there.
/// \param facing  from this side, unit
void AimCamera(CameraWork& camera, const scene::LaparoscopeSetup& setup, const math::Vec3& p,
               const math::Vec3& facing, double distance);

/// Aims between a tool's tip and what the picture is about, once the tip has been out of the picture for a while.
/// \param depth  of the tool in its trocar: one that is hardly in is not followed [m]
/// \param field  what the picture is about [m]
void FollowTool(CameraWork& camera, const scene::LaparoscopeSetup& setup, const math::Pose& X_world_lens,
                const math::Vec3& p_tip, double depth, const math::Vec3& field, double dt);

/// One tick on the way.
void StepCamera(CameraWork& camera, double dt);

}  // namespace trocar::agent
