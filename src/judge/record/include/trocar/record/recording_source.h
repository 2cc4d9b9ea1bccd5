// SPDX-License-Identifier: Apache-2.0
/// \file recording_source.h  The inputs of a recording, tick by tick.
#pragma once

#include <memory>

#include "trocar/record/recording.h"
#include "trocar/simulation/input_source.h"

namespace trocar::record {

/// Inputs as they were recorded, bit for bit. After the last one the hands stay where they are and no pedal is pressed.
class RecordingSource final : public simulation::InputSource {
 public:
  explicit RecordingSource(std::shared_ptr<const Recording> recording);

  /// \pre tick > Recording::FirstTick(), and the recording has an input
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  bool IsAtEnd() const override { return tick_ >= recording_->LastTick(); }
  void Reset() override { tick_ = recording_->FirstTick(); }

 private:
  std::shared_ptr<const Recording> recording_;
  std::uint64_t tick_ = 0;  // that was asked for last
};

}  // namespace trocar::record
