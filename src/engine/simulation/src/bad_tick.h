// SPDX-License-Identifier: Apache-2.0
/// \file bad_tick.h  Return to the last good tick after one whose tissue state was bad (faults S1 and S3).
#pragma once

#include "trocar/tissue/conservation.h"

namespace trocar::simulation {

/// Pressures, volumes and frames go back to the last good tick. What was opened stays open: the tear or cut is in the mesh, and
/// is not made a second time.
/// \pre of the same organs
/// \note Real-time safe.
void TakeBack(const tissue::ConservationTick& good, tissue::ConservationTick& state) noexcept;

}  // namespace trocar::simulation
