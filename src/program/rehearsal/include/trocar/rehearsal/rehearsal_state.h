// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_state.h  How far somebody has come on the way from images to an operation; it survives the window.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"
#include "trocar/patient/patient.h"

namespace trocar::rehearsal {

enum class RehearsalStep : std::uint8_t {
  kImages,   ///< which series
  kOrgans,   ///< by a label map or drawn contours
  kPatient,  ///< built and checked
  kPorts,    ///< and the table
  kOperate
};
inline constexpr std::size_t kRehearsalSteps = 5;
/// "images", "organs", "patient", "ports", "operate": as the file writes it.
const char* NameOf(RehearsalStep step) noexcept;

enum class OrganSource : std::uint8_t { kNone, kLabels, kContours };

inline constexpr double kMostTiltDeg = 30;  ///< of a table, to either side

/// Where the instruments go in and how the table is tilted.
struct PortPlan {
  std::vector<patient::Port> ports;
  std::optional<patient::Table> table;

  friend bool operator==(const PortPlan&, const PortPlan&) = default;
};

struct RehearsalState {
  RehearsalStep step = RehearsalStep::kImages;
  std::filesystem::path images;        ///< that was looked into for series; empty: nothing yet
  std::filesystem::path series;        ///< that was chosen of them; empty: none
  images::ImageSeriesOptions options;  ///< with which it is opened
  OrganSource source = OrganSource::kNone;
  std::filesystem::path labels;    ///< map, with OrganSource::kLabels
  int liver = 0, gallbladder = 0;  ///< labels in it; 0: found by their names and numbers
  std::string built_from;          ///< fingerprint of what the patient was built from; empty: none is built
  std::vector<std::string> notes;  ///< sentences of that build
  std::optional<PortPlan> plan;    ///< where it is not the proposal
  std::filesystem::path kept;      ///< patient that was operated on, made of this one
};

/// \return an empty state where there is no file
/// \note Errors: kJsonSyntax, kJsonField.
base::Result<RehearsalState> LoadRehearsal(const std::filesystem::path& file);
/// Nobody but the account that runs the program may read the file and the folder that it lies in (modes 600 and 700).
base::Status SaveRehearsal(const std::filesystem::path& file, const RehearsalState& state);

}  // namespace trocar::rehearsal
