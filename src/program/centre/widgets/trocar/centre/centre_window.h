// SPDX-License-Identifier: Apache-2.0
/// \file centre_window.h  The window of the training centre: results, history, courses, groups, exams.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <functional>
#include <memory>

#include "trocar/centre/centre_presenter.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/help_card.h"
#include "trocar/gui/message_bars.h"
#include "trocar/gui/tips.h"

namespace trocar::centre {

class CourseView;
class ExamView;
class GroupView;
class HistoryView;
class ResultView;

/// Services that other windows provide for this one.
struct CentreServices {
  std::function<void(const Start&)> start;
  std::function<void(const std::string& task, const std::string& level)> start_task;
  std::function<void(const std::filesystem::path& recording, double time)> replay;
  CentrePresenter::DrawMoment draw_moment;
};

class CentreWindow : public Gtk::ApplicationWindow, private CentreScreen {
 public:
  /// \param filing  may be null; outlives the window
  CentreWindow(const Access& access, int threads, AttemptFiling* filing, CentreServices services);
  ~CentreWindow() override;

  /// Whether a person can still see it: GTK forgets a window that was closed.
  bool IsOpen() const { return is_open_; }
  CentrePresenter& Presenter() { return *presenter_; }
  /// The filing has news. From any thread.
  void Wake() { news_.emit(); }
  /// Error of the window, if any: the program's exit status follows it.
  const std::optional<base::Error>& GetFailure() const { return failure_; }
  void Fail(const base::Error& error) { failure_ = error; }

 private:
  void MakeContent();
  void MakeWho();
  void MakeRoutes();
  bool OnKey(guint keyval, guint keycode, Gdk::ModifierType state);

  // CentreScreen
  void Show(const CentrePage& page) override;
  void ShowError(const base::Error& error) override { bars_.ShowError(error); }
  void ShowNotice(const std::string& text) override { bars_.ShowNotice(text); }
  void StartAttempt(const Start& start) override;
  void StartTask(const std::string& task, const std::string& level) override;
  void OpenReplay(const std::filesystem::path& recording, double time) override;
  void Close() override;

  CentreServices services_;
  gui::Tips tips_;
  gui::CommandBar<CentreAction, CentreNeeds> bar_;
  gui::MessageBars bars_;
  Gtk::Overlay overlay_;
  Gtk::Stack stack_;
  std::unique_ptr<ResultView> result_;
  std::unique_ptr<HistoryView> history_;
  std::unique_ptr<CourseView> courses_;
  std::unique_ptr<GroupView> group_;
  std::unique_ptr<ExamView> exam_;
  gui::HelpCard help_card_{CentreHelp()};
  Gtk::Box who_card_{Gtk::Orientation::VERTICAL};
  Gtk::Entry who_;
  Gtk::Spinner spinner_;
  Gtk::Label busy_, notice_;
  Gtk::Button cancel_;
  Gtk::ProgressBar progress_;
  std::uint64_t shown_version_ = 0;
  std::optional<base::Error> failure_;
  bool is_open_ = true;
  Glib::Dispatcher news_;
  std::unique_ptr<CentrePresenter> presenter_;
};

}  // namespace trocar::centre
