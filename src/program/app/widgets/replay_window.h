// SPDX-License-Identifier: Apache-2.0
/// \file replay_window.h  The replay window's widgets; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "failure_card.h"
#include "film_bar.h"
#include "picture.h"
#include "recording_chooser.h"
#include "replay_bar.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/help_card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/replay_presenter.h"

namespace trocar::app {

class ReplayWindow : public Gtk::ApplicationWindow, private presenter::ReplayScreen {
 public:
  /// \param options    names the recording
  /// \param take_over  called when somebody goes on from a moment; never within a frame
  ReplayWindow(const presenter::Options& options, std::function<void(presenter::Branch)> take_over);
  ~ReplayWindow() override;

  /// Error of the window, if any: the program's exit status follows it.
  const std::optional<base::Error>& GetFailure() const { return presenter_->GetFailure(); }

 private:
  struct Side {
    Gtk::Overlay overlay;
    Picture picture;
    Gtk::Label about;
    double last_x = 0, last_y = 0;  // of the drag
  };
  void MakeContent();
  void MakeSide(std::size_t side);
  void MakeRoutes();
  void SavePicture();
  void StartFilm(double until, double last_seconds, const std::filesystem::path& video);
  bool OnKey(guint keyval, guint keycode, Gdk::ModifierType state);
  bool OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock);

  // ReplayScreen
  void Show(const presenter::ReplayPage& page) override;
  void UseReplay(std::size_t side, const session::ReplayRunner* replay) override;
  void ShowMarks(const std::vector<presenter::ReplayMark>& marks) override;
  void FillRecordingList(const std::filesystem::path& folder) override { chooser_.Load(folder); }
  void TakeOver(presenter::Branch branch) override;
  void DoInWindow(presenter::ReplayAction action) override;

  gui::Tips tips_;
  gui::CommandBar<presenter::ReplayAction, presenter::ReplayNeeds> bar_;
  std::array<Side, presenter::ReplayPresenter::kSides> sides_;
  Gtk::Overlay overlay_;
  ReplayBar time_bar_;
  Gtk::ListBox mark_list_;
  std::vector<presenter::ReplayMark> marks_;  // of the list's rows
  RecordingChooser chooser_{host::Mark("Beside")};
  gui::HelpCard help_card_{presenter::ReplayHelp()};
  FailureCard failure_card_;
  Gtk::Label clock_, state_, message_;
  std::function<void(presenter::Branch)> take_over_;
  Glib::Dispatcher loaded_;
  gui::FileDialog file_dialog_;
  std::filesystem::path recording_;
  FilmBar film_bar_{[this](const std::string& text, bool is_warning) { presenter_->Tell(text, is_warning); }};
  std::unique_ptr<presenter::ReplayPresenter> presenter_;
};

}  // namespace trocar::app
