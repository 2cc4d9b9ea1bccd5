// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/ear.h"

#include <algorithm>
#include <cstddef>

namespace trocar::sound {
namespace {

bool HoldsElectrode(const scene::InstrumentSetup& setup, std::size_t place) noexcept {
  if (place >= setup.tray.size()) return false;
  return instrument::AbilitiesOf(setup.tray[place].kind).electrode != instrument::Electrode::kNone;
}

}  // namespace

SoundState Ear::Listen(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                       const scene::Input& input, bool is_running) noexcept {
  const std::uint64_t count = snapshot.event_count, ring = snapshot.events.size();
  if (count < seen_events_) seen_events_ = 0;  // the scene began anew
  // what is no longer in the ring happened too long ago to be heard
  for (std::uint64_t& seen = seen_events_ = std::max(seen_events_, count - std::min(count, ring));
       seen < count; ++seen) {
    if (snapshot.events[seen % ring].kind == surgery::FactKind::kClipClosed) ++clicks_;
  }
  SoundState state;
  state.clicks = clicks_;
  if (!is_running) return state;
  for (std::size_t hand = 0; hand < input.controls.size(); ++hand) {
    const scene::HandControls& controls = input.controls[hand];
    const bool is_pressed = (controls.cut || controls.coagulate) &&
                            HoldsElectrode(scene.instruments[hand], snapshot.operation.tools[hand]);
    if (!is_pressed && !snapshot.operation.has_current[hand]) continue;
    // with both pedals the unit cuts
    if (is_pressed && controls.cut) {
      state.energy = EnergyTone::kCut;
    } else if (state.energy == EnergyTone::kNone) {
      state.energy = EnergyTone::kCoagulation;
    }
  }
  // over a box trainer there is no monitor
  state.has_pulse = !scene.patient.organs.empty();
  const auto& blood = snapshot.operation.flow.ledger.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  state.signs = CalcVitalSigns(blood.left);
  return state;
}

}  // namespace trocar::sound
