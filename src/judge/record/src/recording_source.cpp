// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recording_source.h"

#include <utility>

#include "trocar/base/assert.h"

namespace trocar::record {

RecordingSource::RecordingSource(std::shared_ptr<const Recording> recording)
    : recording_(std::move(recording)), tick_(recording_->FirstTick()) {}

scene::Input RecordingSource::For(std::uint64_t tick, const simulation::Snapshot& /*before*/) {
  TROCAR_ASSERT(tick > recording_->FirstTick() && !recording_->inputs.empty());
  tick_ = tick;
  if (tick <= recording_->LastTick()) return recording_->inputs[tick - 1 - recording_->FirstTick()];
  scene::Input rest = recording_->inputs.back();
  for (scene::HandControls& controls : rest.controls)
    controls.cut = controls.coagulate = controls.rinse = controls.aspirate = false;
  return rest;
}

}  // namespace trocar::record
