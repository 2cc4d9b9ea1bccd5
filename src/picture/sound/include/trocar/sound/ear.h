// SPDX-License-Identifier: Apache-2.0
/// \file ear.h  From a tick's snapshot to what is to be heard.
#pragma once

#include <cstdint>

#include "trocar/scene/input.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/sound/synthesiser.h"

namespace trocar::sound {

/// Follows published snapshots; looks only.
class Ear {
 public:
  /// The electrosurgical unit sounds while a pedal is pressed with an electrode in that hand, as a real one does, in tissue or
  /// not. Where pedals are not known (a script, an expert), current that flows sounds as coagulation.
  /// \param input       of the tick
  /// \param is_running  false: paused, and nothing sounds
  SoundState Listen(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                    const scene::Input& input, bool is_running) noexcept;

 private:
  std::uint64_t seen_events_ = 0, clicks_ = 0;
};

}  // namespace trocar::sound
