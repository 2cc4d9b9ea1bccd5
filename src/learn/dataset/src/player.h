// SPDX-License-Identifier: Apache-2.0
/// \file player.h  Player of a video: a scripted surgeon or a recording.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "trocar/cholecystectomy/triplet.h"
#include "trocar/dataset/dataset.h"
#include "trocar/simulation/simulation.h"

namespace trocar::dataset {

/// A simulation and who steps it.
class Player {
 public:
  virtual ~Player() = default;
  virtual const simulation::Simulation& GetSimulation() const = 0;
  /// Nothing more comes: the surgeon has finished, the recording is at its end.
  virtual bool HasFinished() const = 0;
  /// One tick.
  virtual void Step() = 0;
  /// Input of the last tick; before the first tick, the place of hands and camera.
  virtual const scene::Input& LastInput() const = 0;
  /// The work under way by the surgeon's own words, and the phase to which it belongs by its plan; of a recording nobody says so.
  virtual std::string_view Doing() const { return {}; }
  virtual std::optional<std::uint8_t> OwnPhase() const { return std::nullopt; }
  /// After the last tick. \return kRecordingInvalid where other states were computed than were recorded
  virtual base::Status Finish() const { return {}; }
};

/// A surgeon of the plan. \param field_of_view_scale  of the laparoscope's lens [-], > 0
/// \return the scene's or simulation's error, kUnknownName for the surgeon
base::Result<std::unique_ptr<Player>> MakeSurgeonPlayer(const Plan& plan, std::uint64_t seed,
                                                        const std::filesystem::path& patient,
                                                        double field_of_view_scale);
/// Player of a recording's file, from its first tick on.
/// \return the file's error; kRecordingInvalid where it is damaged, or its scene is not what was recorded
base::Result<std::unique_ptr<Player>> MakeRecordingPlayer(const std::filesystem::path& recording);

}  // namespace trocar::dataset
