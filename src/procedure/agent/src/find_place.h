// SPDX-License-Identifier: Apache-2.0
/// \file find_place.h  Where a place of a plan is in a snapshot.
#pragma once

#include "division_planner.h"
#include "place.h"
#include "surgeon_view.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

/// What some places depend on beside the snapshot.
struct PlaceContext {
  const JawAim& aim;   ///< of the right hand's jaws
  const Place& field;  ///< what the picture is about
};

/// World frame [m].
math::Vec3 FindPlace(const SurgeonView& view, const Place& place, const PlaceContext& context);

}  // namespace trocar::agent
