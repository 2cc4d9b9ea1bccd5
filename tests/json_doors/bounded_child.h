// SPDX-License-Identifier: Apache-2.0
/// \file bounded_child.h  Work in a process of its own, with little memory and time: what breaks there is a finding, not the end.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace trocar::json_doors {

/// How one piece of work ended.
struct PieceReport {
  bool is_done = false;
  bool is_refused = false;
  double cpu_seconds = 0;
  std::string message;  ///< of the refusal; the beginning where it is long
};

struct ChildReport {
  std::vector<PieceReport> pieces;
  std::string death;  ///< empty, or what ended the process, and at which piece
};

struct ChildLimits {
  std::size_t memory_bytes = std::size_t{256}
                             << 20;  ///< beyond what the process has at its start; none under a sanitizer
  unsigned seconds = 120;            ///< of wall clock, for all pieces
};

/// Does pieces 0 to count - 1 in turn. What they print goes nowhere.
/// \param piece  returns the message of its refusal, or an empty text
ChildReport RunInChild(std::size_t count, const std::function<std::string(std::size_t)>& piece,
                       const ChildLimits& limits = {});

}  // namespace trocar::json_doors
