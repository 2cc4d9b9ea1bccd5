// SPDX-License-Identifier: Apache-2.0
/// \file film_bar.h  A line that shows how far a video is, with a button that gives it up.
#pragma once

#include <gtkmm.h>

#include <atomic>
#include <functional>
#include <string>

#include "trocar/presenter/film_job.h"

namespace trocar::app {

/// Hidden while nothing is being made. One video at a time.
class FilmBar : public Gtk::Box {
 public:
  /// \param say  told in words what became of it; a warning where it failed
  explicit FilmBar(std::function<void(const std::string& text, bool is_warning)> say);
  ~FilmBar() override;

  /// Nothing while another is being made, which is said.
  void Start(presenter::FilmRequest request);

 private:
  void Finish();
  bool ShowProgress();

  std::function<void(const std::string&, bool)> say_;
  Gtk::Label text_;
  Gtk::ProgressBar bar_;
  Gtk::Button cancel_;
  Glib::Dispatcher done_;
  sigc::connection timer_;
  presenter::FilmRequest request_;
  gui::JobProgress progress_;
  std::atomic<bool> is_cancelled_ = false;
  gui::BackgroundJob<base::Result<presenter::Film>> job_;  // ends before what it uses
};

}  // namespace trocar::app
