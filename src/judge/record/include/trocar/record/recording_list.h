// SPDX-License-Identifier: Apache-2.0
/// \file recording_list.h  List of the recordings in a folder, without reading them whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/record/recording.h"

namespace trocar::record {

/// A recording in a list.
struct RecordingSummary {
  std::filesystem::path path;
  Description description;
  double seconds = 0;      ///< of what was recorded [s]
  std::size_t errors = 0;  ///< that were noted
  bool is_finished = false;
  bool is_whole = true;  ///< every chunk begins where it should; ReadRecording checks the rest
  std::string outcome;   ///< JSON of outcome.h; empty where it has not finished
  std::uint64_t bytes = 0;
};

/// Reads description, events and ending, and skips the rest: some ten milliseconds for half an hour.
/// \return as ReadRecording
base::Result<RecordingSummary> ReadSummary(const std::filesystem::path& path);

/// The recordings of a folder, the newest first; what is none is left out. Empty where there is no such folder.
std::vector<RecordingSummary> ListRecordings(const std::filesystem::path& folder);

/// An outcome for a person: "completed, 97.4 points", "time over, 0 points", "completed, critical view, 40 mL of blood".
/// Empty where nothing was judged.
std::string DescribeOutcome(const std::string& outcome);

}  // namespace trocar::record
