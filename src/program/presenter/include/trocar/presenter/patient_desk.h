// SPDX-License-Identifier: Apache-2.0
/// \file patient_desk.h  Lists patients and makes new ones beside the window: by seed, or from a label map.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trocar/gui/background_job.h"
#include "trocar/presenter/patient_list.h"

namespace trocar::presenter {

struct PatientPage {
  std::vector<PatientEntry> patients;
  std::filesystem::path chosen;  ///< empty: the built-in one
  std::string doing;             ///< what is under way; empty: nothing
  double fraction = 0;           ///< of that; negative: not known [-]
  bool can_cancel = false;
  std::optional<base::Error> problem;  ///< of what was asked for last
};

class PatientDesk {
 public:
  /// \param folder   where new patients go
  /// \param on_news  called by another thread: Finish() is due
  PatientDesk(std::filesystem::path folder, std::function<void()> on_news);
  ~PatientDesk();

  /// Reads the list; nothing while something else is under way, after which it is read anyway.
  void List();
  /// A plausible patient from a seed, at "seed-SEED" of the folder; one that is there is chosen.
  void Generate(std::uint64_t seed);
  /// A patient from a label map of liver and gallbladder (NIfTI, NRRD): at the file's name, with a number behind it where
  /// that is taken.
  void Import(const std::filesystem::path& labels);
  /// Cancels the work that is under way; it then has no result.
  void Cancel();
  /// Takes over what has been done. \return the patient that was made or is there already, or nothing
  std::optional<std::filesystem::path> Finish();

  void Choose(const std::filesystem::path& folder) { page_.chosen = folder; }
  /// How far it is now.
  const PatientPage& Look();
  bool IsBusy() const { return job_.IsRunning(); }

 private:
  struct Work {
    gui::JobProgress progress;
    std::atomic<bool> is_cancelled = false;
  };
  struct Outcome {
    std::vector<PatientEntry> patients;
    std::optional<base::Error> problem;
    std::optional<std::filesystem::path> made;
  };
  /// Makes a patient in a folder. \return what went wrong
  using Maker = std::function<base::Status(const std::filesystem::path& folder, Work& work)>;
  void Make(const std::string& name, const std::string& doing, Maker maker);

  std::filesystem::path folder_;
  PatientPage page_;
  std::shared_ptr<Work> work_;  // shared with the job's thread, which may outlive a cancelled request
  bool is_list_due_ = false;
  gui::BackgroundJob<Outcome> job_;
};

}  // namespace trocar::presenter
