// SPDX-License-Identifier: Apache-2.0
/// \file truth.h  What the simulation itself knows of each frame, beside the labels of a layout: a table with named columns, by which
/// tools/verify-dataset asks whether labels mean what they say.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acts.h"
#include "player.h"
#include "trocar/base/result.h"

namespace trocar::dataset {

/// Of one video of an operation: truth/video_SEED.csv. docs/datasets.md says what each column is.
class TruthTable {
 public:
  explicit TruthTable(const simulation::Simulation& simulation);

  /// One tick: facts of hands are kept until the next frame.
  void Look(const simulation::Snapshot& now);
  /// A row.
  /// \param number  at 25 frames a second
  /// \param acts    of all tools, seen or not
  void Add(std::size_t index, std::uint64_t number, const Player& player, const std::vector<Act>& acts);
  /// \return kFileUnwritable
  base::Status Write(const std::filesystem::path& path) const;

 private:
  std::string NameHeld(const simulation::Snapshot& now, std::size_t hand) const;

  std::vector<std::string> surfaces_, strands_;  // (Surfaces()), (Strands()) their roles' names
  std::map<std::string, int> facts_;             // since the last frame: how many of each
  std::string text_;
};

}  // namespace trocar::dataset
