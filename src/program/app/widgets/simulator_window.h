// SPDX-License-Identifier: Apache-2.0
/// \file simulator_window.h  The simulator window's widgets; what they show and do is the presenter's.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "device_page.h"
#include "failure_card.h"
#include "film_bar.h"
#include "hand_events.h"
#include "home_card.h"
#include "key_card.h"
#include "layout_check.h"
#include "opening_card.h"
#include "panel.h"
#include "patient_list_card.h"
#include "picture.h"
#include "recording_chooser.h"
#include "replay_window.h"
#include "result_card.h"
#include "sound_card.h"
#include "task_chooser.h"
#include "trocar/gui/columns.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/file_dialog.h"
#include "trocar/gui/help_card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/simulator_presenter.h"
#include "trocar/rehearsal/rehearsal_view.h"

namespace trocar::app {

/// Services that other windows provide for this one.
struct SimulatorServices {
  std::function<void()> open_centre;
  /// \param exam  that was sat, or nothing
  std::function<void(const std::filesystem::path& recording, const std::optional<centre::ExamSitting>& exam)>
      open_attempt;
  /// The best results of whoever operates, from the store, are read beside the window's thread.
  /// \return what reads them
  std::function<std::function<base::Result<centre::HomeResults>()>()> load_best;
  /// As SimulatorScreen::BeSomebody.
  std::function<base::Result<presenter::Somebody>(const std::optional<std::string>&)> be_somebody;
  std::function<void(const centre::StepName&)> start_step;
  std::function<void(const centre::NextAndLast::Result&)> open_result;
  presenter::AttemptHooks hooks;
};

class SimulatorWindow : public Gtk::ApplicationWindow, private presenter::SimulatorScreen {
 public:
  /// \param since_start  runs since the program began
  /// \param beginning    nothing, or what is opened in place of the scene that the options name: a moment of a recording from which
  ///                     it goes on, a step of a course or an exam, or a task
  using Beginning = std::variant<std::monostate, presenter::Branch, centre::Start, presenter::TaskRequest>;
  SimulatorWindow(const presenter::Options& options, const host::Stopwatch& since_start,
                  SimulatorServices services, Beginning beginning = {});
  ~SimulatorWindow() override;

  presenter::SimulatorPresenter& Presenter() { return *presenter_; }
  /// Whether a person can still see it: GTK forgets a window that was closed.
  bool IsOpen() const { return is_open_; }
  /// Every page of the window, for --check-layout.
  std::vector<LayoutCheck::Page> LayoutPages();
  /// Writes what --haptic-record asks for; call it once the window has closed.
  void SaveHapticRecord() { presenter_->SaveHapticRecord(); }
  /// Error of the window, if any: the program's exit status follows it.
  const std::optional<base::Error>& GetFailure() const { return presenter_->GetFailure(); }

 private:
  void MakeContent();
  void MakeOverlay();
  void MakeQuestion();
  void MakeRoutes();
  bool OnFrame(const Glib::RefPtr<Gdk::FrameClock>& clock);
  void OpenDevices();
  void SwitchPane();
  void ChooseAndSaveResult();
  void SavePicture();
  void SaveClip();
  void MakeSound(const presenter::Options& options);
  void HearFrame(const simulation::Snapshot& snapshot);
  bool ChangeSound(presenter::Action action);
  void ShowHelp();
  void FocusCard(const presenter::SimulatorPage& page);
  void ShowRehearsal(bool is_open);
  KeyCardServices MakeKeyCardServices();

  // SimulatorScreen
  void Show(const presenter::SimulatorPage& page) override;
  void UseControl(presenter::SessionControl* control) override;
  std::vector<std::string> UseKeys(const std::map<std::string, device::HandAct>& keys) override;
  void FillTaskList(const presenter::TaskPage& page) override { chooser_.Show(page); }
  void RequestBest() override;
  void FillPatientList(const std::filesystem::path& chosen) override { patients_.Load(chosen); }
  void FillRecordingList(const std::filesystem::path& folder) override { recordings_.Load(folder); }
  void OpenReplay(const std::filesystem::path& recording) override;
  void OpenAttempt(const std::filesystem::path& recording,
                   const std::optional<centre::ExamSitting>& exam) override;
  void FillResult(const presenter::TaskResult& result) override { result_card_.Show(result); }
  void ReleasePointer() override { hands_->ReleasePointer(); }
  bool IsPointerTaken() const override { return hands_->IsPointerTaken(); }
  void FocusPicture() override { picture_.grab_focus(); }
  void DoInWindow(presenter::Action action) override;
  base::Result<presenter::Somebody> BeSomebody(const std::optional<std::string>& text) override;
  void StartStep(const centre::StepName& step) override;
  void OpenLastResult(const centre::NextAndLast::Result& result) override;

  SimulatorServices services_;
  gui::Tips tips_;
  gui::CommandBar<presenter::KeyMeaning, presenter::SimulatorNeeds> bar_;
  Gtk::Overlay overlay_;
  Picture picture_;
  Panel panel_;
  Gtk::Box help_;  // of the keys as they are now
  Gtk::ScrolledWindow* help_scroller_ = nullptr;
  std::optional<std::pair<presenter::KeyLayout, presenter::KeyBindings::Own>> shown_help_;
  Gtk::Widget* focused_card_ = nullptr;
  bool is_open_ = true;
  HomeCard home_;
  OpeningCard opening_;
  PatientListCard patients_;
  KeyCard keys_;
  Gtk::Box question_{Gtk::Orientation::VERTICAL};
  TaskChooser chooser_;
  RecordingChooser recordings_{host::Mark("Watch")};
  ResultCard result_card_;
  SoundCard sound_card_;
  FailureCard failure_card_;
  Gtk::Label badge_, hint_, event_, state_, haptics_, mode_, progress_, tutorial_, asked_;
  gui::Columns top_{0};  // badge and progress
  Gtk::Button tutorial_task_;
  std::unique_ptr<HandEvents> hands_;
  Glib::Dispatcher loaded_, best_loaded_;
  gui::BackgroundJob<base::Result<centre::HomeResults>> loading_best_;
  bool wants_best_again_ = false;  // asked for while it was read
  gui::FileDialog file_dialog_;
  std::unique_ptr<presenter::SimulatorPresenter> presenter_;
  FilmBar film_bar_{[this](const std::string& text, bool is_warning) { presenter_->Tell(text, is_warning); }};
  std::unique_ptr<presenter::WindowSound> sound_;        // null where nobody is there to hear
  std::unique_ptr<DevicePage> device_page_;              // of the presenter's control
  std::unique_ptr<rehearsal::RehearsalView> rehearsal_;  // once it has been opened
  std::unique_ptr<ReplayWindow> replay_;
};

}  // namespace trocar::app
