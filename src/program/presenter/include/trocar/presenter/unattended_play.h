// SPDX-License-Identifier: Apache-2.0
/// \file unattended_play.h  A run of the simulator window that is not attended: when its picture is due, and its report.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/base/result.h"
#include "trocar/presenter/options.h"
#include "trocar/session/runner.h"

namespace trocar::presenter {

class UnattendedPlay {
 public:
  enum class Step {
    kGoOn,
    kSave,   ///< once
    kGiveUp  ///< once: the simulation does not get on, and a test must not hang
  };

  explicit UnattendedPlay(const Options& options)
      : after_(options.run.screenshot_after), is_on_(!options.run.IsAttended()) {}

  bool IsOn() const { return is_on_; }
  /// \param simulated  of the newest state [s]
  /// \param elapsed    since the start of the program [s]
  Step Advance(double simulated, double elapsed);
  /// Why it gave up.
  base::Error Complaint() const;

 private:
  double Limit() const { return 60.0 + 20.0 * after_; }

  double after_;
  bool is_on_, is_over_ = false;
};

/// Report that the run prints.
struct PlayReport {
  std::string screenshot;  ///< file name
  int width = 0, height = 0;
  double first_picture = 0;  ///< since the start of the program [s]
  session::RunnerStatistics statistics;
  std::uint64_t pictures = 0;
  double pictures_per_second = 0;
  bool has_task_list = false;
  std::string result;   ///< the verdict that is shown; empty: none
  std::string haptics;  ///< as JSON; empty: none
};

/// In one line of JSON.
std::string FormatPlayReport(const PlayReport& report);

}  // namespace trocar::presenter
