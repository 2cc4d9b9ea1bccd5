// SPDX-License-Identifier: Apache-2.0
/// \file play_operation.h  A scripted surgeon operates: the part of trocar play that judges by the patient.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "play_state.h"
#include "trocar/agent/surgeon.h"
#include "trocar/core/result.h"

namespace trocar::cli {

struct OperationPlay {
  std::filesystem::path output;  ///< folder for pictures and a video, or empty
  int width = 1280, height = 720;
  int threads = 1;
  double most_seconds = 3600;
  bool is_json = false;
  PlayFiles files;  ///< only without pictures
};

/// The scene of that name, or at that path, where it is an operation.
/// \return nothing where there is none: then it is a task; the file's error where it is one that cannot be read
core::Result<std::optional<scene::Scene>> FindOperation(const std::string& name,
                                                        const std::filesystem::path& patient_folder,
                                                        std::uint64_t seed);

/// Runs to the surgeon's end and prints what it came to.
core::Status PlayOperation(std::shared_ptr<const scene::Scene> scene, agent::Surgeon& surgeon,
                           const OperationPlay& play);

}  // namespace trocar::cli
