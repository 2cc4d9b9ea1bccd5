// SPDX-License-Identifier: Apache-2.0
/// \file input_source.h  The input of each tick, from whoever holds the instruments.
#pragma once

#include <cstdint>

#include "trocar/scene/input.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

/// One input for each tick: of a person's hands, a device, a scripted surgeon, a script or a recording.
///
/// All members are called by the thread that steps the simulation, between two ticks.
class InputSource {
 public:
  virtual ~InputSource() = default;

  /// Input of one tick; called once for each tick, in their order.
  ///
  /// \param tick    the tick that is about to be made, which its snapshot will bear: before.tick + 1
  /// \param before  state that the tick begins with
  virtual scene::Input For(std::uint64_t tick, const Snapshot& before) = 0;
  /// The tick was made. Called before anybody else sees its state.
  virtual void AfterTick(const Snapshot& /*after*/) {}
  /// The time of a tick has passed without one, because the simulation is paused.
  virtual void Wait(const Snapshot& /*now*/) {}
  /// The simulation is back at its first tick.
  virtual void Reset() {}

  /// The script or the recording is over, the surgeon has finished. For() still gives inputs, in which the hands rest.
  virtual bool IsAtEnd() const { return false; }
  /// A program moves the hands: the attempt is nobody's own, and no person feels its forces.
  virtual bool IsDemonstration() const { return true; }
};

}  // namespace trocar::simulation
