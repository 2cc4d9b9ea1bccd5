// SPDX-License-Identifier: Apache-2.0
/// \file doors.h  Every way by which JSON that somebody else wrote comes into the program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace trocar::json_doors {

/// Hands a text in. \return the message of its refusal; empty where it was taken
using Feed = std::function<std::string(const std::string& text)>;

struct Door {
  std::string name;
  std::vector<std::string> functions;  ///< as FindDoors names them: those that see the text first
  /// \param folder  empty, of this door alone
  std::function<Feed(const std::filesystem::path& folder)> open;
  std::string sample = {};      ///< a file of the repository that this door takes, or its text; empty: none
  bool takes_any_text = false;  ///< what is no JSON is kept as a text
  std::size_t most_mutations = 150;
  std::size_t memory_bytes = std::size_t{256} << 20;  ///< that it may need
  bool is_silent = false;                             ///< nothing shows whether a text was taken
  double most_seconds = 5;                            ///< of the processor, for a short text
};

const std::vector<Door>& Doors();

}  // namespace trocar::json_doors
