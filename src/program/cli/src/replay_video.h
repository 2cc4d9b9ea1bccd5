// SPDX-License-Identifier: Apache-2.0
/// \file replay_video.h  A recording, or two beside each other, as a video.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "trocar/record/replay.h"

namespace trocar::cli {

struct ReplayVideoOptions {
  std::filesystem::path output;  ///< folder
  std::string size = "1280x720";
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< [s]
  double speed = 1;                                                  ///< [-]
  std::string camera = "recorded";  ///< or a side of the patient from which it looks
  bool has_forces = true, has_ghosts = false;
};

/// The recording's tick that is nearest to a moment [s].
std::uint64_t TickAt(const record::Recording& recording, double seconds);

/// "recorded", and the names of sides.
std::vector<std::string> ListReplayCameras();

/// \param other  null, or what is shown at the right; the last picture of the shorter one stays
/// \return kUsage (nothing to show, a bad size), or what drawing and writing say
base::Status MakeReplayVideo(record::Replay& replay, record::Replay* other,
                             const ReplayVideoOptions& options);

}  // namespace trocar::cli
