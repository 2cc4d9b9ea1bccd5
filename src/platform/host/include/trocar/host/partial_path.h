// SPDX-License-Identifier: Apache-2.0
/// \file partial_path.h  Where a result is written until it is whole: beside its target, and gone when the program ends
/// before that, by an error or by a signal.
#pragma once

#include <cstddef>
#include <filesystem>

namespace trocar::host {

/// A file or folder "TARGET.partPID". Whoever made it renames it to the target; what is not renamed is removed.
class PartialPath {
 public:
  /// Removes what an earlier one of this name left. Makes nothing.
  explicit PartialPath(const std::filesystem::path& target);
  ~PartialPath();
  PartialPath(const PartialPath&) = delete;
  PartialPath& operator=(const PartialPath&) = delete;

  const std::filesystem::path& Path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int entry_ = -1;  // in the table that the signals' handler reads; -1 where it is full
};

/// From now on SIGINT, SIGTERM and SIGHUP remove every PartialPath of this process before they end it, unless the program
/// that started this one had them ignored. A file that may not grow any further (SIGXFSZ) is an error of writing, as a full
/// disk is, and ends nothing. For a program's main function.
void RemovePartialPathsOnSignals();

/// Removes them now.
/// \note Async-signal-safe.
void RemovePartialPaths() noexcept;

}  // namespace trocar::host
