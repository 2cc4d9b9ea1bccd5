// SPDX-License-Identifier: Apache-2.0
/// \file recording_chooser.h  The card on which a person chooses a recording, the newest first.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "trocar/gui/background_job.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/list_card.h"
#include "trocar/record/recording_list.h"

namespace trocar::app {

class RecordingChooser : public gui::ListCard {
 public:
  /// \param verb  on the buttons: "Watch"
  explicit RecordingChooser(const char* verb);

  /// Reads the folder on another thread and then shows what there is.
  void Load(const std::filesystem::path& folder);

  sigc::signal<void(std::filesystem::path)>& SignalChosen() { return signal_chosen_; }

 private:
  void Fill();
  void AddRecording(const record::RecordingSummary& recording);
  void OpenFile();

  const char* verb_;
  std::filesystem::path folder_;
  std::optional<std::filesystem::path> next_folder_;  // asked for while one is read
  sigc::signal<void(std::filesystem::path)> signal_chosen_;
  gui::FileDialog file_dialog_;
  Glib::Dispatcher loaded_;
  gui::BackgroundJob<std::vector<record::RecordingSummary>> loading_{[this] { loaded_.emit(); }};
};

}  // namespace trocar::app
