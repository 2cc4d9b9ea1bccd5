// SPDX-License-Identifier: Apache-2.0
/// \file progress_bar.h  Progress for a person at a terminal.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace trocar::host {

/// One line that is redrawn, on standard error; silent where that is not a terminal, and in the first half
/// second.
class ProgressBar {
 public:
  /// \param label  the work that is going on, in English; shown in the chosen language
  /// \param total  steps, > 0
  ProgressBar(std::string_view label, double total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// \param done  steps so far, 0 to total
  void Show(double done);
  /// Replaces what is said to be going on.
  void SetLabel(std::string_view label) { label_ = label; }
  /// For work that says what it is doing, and how far it is; the bar must outlive it.
  std::function<void(std::string_view, double)> Follow() {
    return [this](std::string_view what, double done) {
      SetLabel(what);
      Show(done);
    };
  }
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

}  // namespace trocar::host
