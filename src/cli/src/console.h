// SPDX-License-Identifier: Apache-2.0
/// \file console.h  Tables and progress for a person at a terminal.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trocar::cli {

/// Number with `digits` significant digits, as short as it can be: "12.3", "0.00451", "not a number".
std::string FormatNumber(double value, int digits = 4);

/// Lines of columns, each as wide as its widest cell; cells that are numbers stand at the right.
///
/// \param rows  the first is the heading; shorter rows end early
/// \return every line ends with a newline
std::string FormatTable(const std::vector<std::vector<std::string>>& rows);

/// One line that is redrawn, on standard error; silent where that is not a terminal, and in the first half
/// second.
class ProgressBar {
 public:
  /// \param label  what is going on;
  /// \param total  steps, > 0
  ProgressBar(std::string label, double total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// \param done  steps so far, 0 to total
  void Show(double done);
  /// Replaces what is said to be going on.
  void SetLabel(std::string_view label) { label_ = label; }
  /// Wipes the line.
  void Finish();

 private:
  std::string label_;
  double total_;
  bool is_terminal_;
  bool is_drawn_ = false;
  long long start_;     // [ns]
  long long last_ = 0;  // [ns]
};

}  // namespace trocar::cli
