// SPDX-License-Identifier: Apache-2.0
// The simulator window's tasks: the list to choose from, and what comes at a task's end.
#include "simulator_window.h"
#include "trocar/core/log.h"
#include "trocar/core/safe_file.h"

namespace trocar::app {

void SimulatorWindow::MakeTaskCards() {
  for (Gtk::Widget* widget :
       {static_cast<Gtk::Widget*>(&chooser_), static_cast<Gtk::Widget*>(&result_card_)}) {
    widget->set_visible(false);
    overlay_.add_overlay(*widget);
  }
  chooser_.SignalChosen().connect(sigc::mem_fun(*this, &SimulatorWindow::Open));
  chooser_.SignalClosed().connect([this] { chooser_.set_visible(false); });
  result_card_.SignalAgain().connect([this] {
    Reset();
    picture_.grab_focus();
  });
  result_card_.SignalOther().connect([this] { OpenTaskList(); });
  result_card_.SignalSave().connect([this] { SaveResult(); });
  result_card_.SignalClosed().connect([this] { result_card_.set_visible(false); });
}

void SimulatorWindow::OpenTaskList() {
  if (failure_) return;
  if (const core::Status loaded = chooser_.Load(); !loaded) return Fail(loaded.error());
  hands_->ReleasePointer();
  result_card_.set_visible(false);
  help_.set_active(false);
  chooser_.set_visible(true);
}

/// Gives up the scene that is shown and reads the one that was chosen.
void SimulatorWindow::Open(const TaskWish& wish) {
  if (loader_.joinable()) return;  // one is being read
  hands_->ReleasePointer();
  device_page_.reset();
  picture_.SetSnapshot(nullptr);
  picture_.SetScene(nullptr, {}, {});
  panel_.SetControl(nullptr);
  panel_.set_sensitive(false);
  hands_->SetControl(nullptr);
  control_.reset();
  stages_ = {};
  error_log_ = {};
  seen_events_ = 0;
  is_result_known_ = false;
  chooser_.set_visible(false);
  result_card_.set_visible(false);
  options_.task = wish.task;
  options_.scene = wish.scene;
  options_.level = wish.choice.level;
  options_.seed = wish.choice.seed;
  options_.is_demonstration = false;
  ShowSituation();
  picture_.grab_focus();
  StartLoading();
}

void SimulatorWindow::FollowTask(const session::TaskSnapshot& now) {
  error_log_.Add(now);
  if (!now.IsOver()) {
    // begun anew
    if (is_result_known_) result_card_.set_visible(false);
    is_result_known_ = false;
    return;
  }
  if (is_result_known_) return;
  is_result_known_ = true;
  result_ = MakeTaskResult(control_->GetScene(), now, error_log_.Errors());
  result_.is_demonstration = control_->IsDemonstration();
  hands_->ReleasePointer();
  result_card_.Show(result_);
  result_card_.set_visible(true);
}

void SimulatorWindow::SaveResult() {
  auto dialog = Gtk::FileChooserNative::create("Save the result", *this, Gtk::FileChooser::Action::SAVE,
                                               "Save", "Cancel");
  for (const auto& [name, pattern] :
       {std::pair{"Page (HTML)", "*.html"}, std::pair{"Data (JSON)", "*.json"}}) {
    auto filter = Gtk::FileFilter::create();
    filter->set_name(name);
    filter->add_pattern(pattern);
    dialog->add_filter(filter);
  }
  dialog->set_current_name("result.html");
  dialog->signal_response().connect([this, dialog](int response) {
    if (response != Gtk::ResponseType::ACCEPT) return;
    const std::filesystem::path path = dialog->get_file()->get_path();
    const core::Status saved = core::WriteFile(
        path, path.extension() == ".json" ? FormatTaskResultJson(result_) : FormatTaskResultHtml(result_));
    if (!saved) core::Log(core::LogLevel::kError, saved.error().Text());
    event_.set_text(saved ? "Saved " + path.string() : saved.error().Text());
  });
  dialog->show();
}

}  // namespace trocar::app
