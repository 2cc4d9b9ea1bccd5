// SPDX-License-Identifier: Apache-2.0
/// \file layout_set.h  The files of one layout: a writer for each video, and what belongs to all of them.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "video.h"

namespace trocar::dataset {

/// Writers of different videos may be used on different threads at a time.
class LayoutSet {
 public:
  virtual ~LayoutSet() = default;
  virtual std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                                  const simulation::Simulation& simulation) = 0;
  /// After all videos.
  virtual base::Status Finish(const std::filesystem::path& /*folder*/) { return {}; }
  /// For the card: classes or words, with their ids.
  virtual nlohmann::ordered_json Classes() const = 0;
  /// For the card: what this layout asks for and does not get, a sentence each.
  virtual std::vector<std::string> Gaps() const = 0;
};

std::unique_ptr<LayoutSet> MakeCholecSeg8k();
std::unique_ptr<LayoutSet> MakeCholec80();
std::unique_ptr<LayoutSet> MakeCholecT50();
std::unique_ptr<LayoutSet> MakeEndoscapes();
std::unique_ptr<LayoutSet> MakeTrocar();

/// "video07" of a prefix and a seed: at least two digits.
std::string NameVideo(const char* prefix, std::uint64_t seed, int digits = 2);

}  // namespace trocar::dataset
