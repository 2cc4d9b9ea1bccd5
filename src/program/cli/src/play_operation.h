// SPDX-License-Identifier: Apache-2.0
/// \file play_operation.h  A scripted surgeon operates: the part of trocar play that judges by the patient.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "attempt_page.h"
#include "trocar/agent/surgeon.h"
#include "trocar/assessment/play_state.h"
#include "trocar/base/result.h"
#include "trocar/record/recording.h"
#include "trocar/simulation/simulation.h"

namespace trocar::cli {

inline constexpr double kMillilitre = 1e6;  ///< per m^3

struct OperationPlay {
  std::filesystem::path output;  ///< folder for pictures and a video, or empty
  int width = 1280, height = 720;
  int threads = 1;
  double most_seconds = 3600;
  bool is_json = false;
  assessment::PlayFiles files;      ///< only without pictures
  std::string record;               ///< file of a recording, or empty; only without pictures
  record::Description description;  ///< of that recording
  RunReport report;
};

/// Goes on from files.restore, where one is named.
/// \return an error as of RestorePlay, or where that state stands after most_seconds [s] already.
base::Status GoOn(const assessment::PlayFiles& files, double most_seconds, simulation::Simulation& simulation,
                  agent::Surgeon& surgeon);

/// Runs to the surgeon's end and prints what it came to.
base::Status PlayOperation(std::shared_ptr<const scene::Scene> scene, agent::Surgeon& surgeon,
                           OperationPlay play);

}  // namespace trocar::cli
