// SPDX-License-Identifier: Apache-2.0
/// \file main.cpp  trocar-window: the simulator's window, the page of devices, or one of the editors, as a program of its
/// own.
#include <gtkmm.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <locale>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

#include "device_page.h"
#include "layout_check.h"
#include "replay_window.h"
#include "simulator_window.h"
#include "trocar/base/simd_choice.h"
#include "trocar/centre/centre_window.h"
#include "trocar/editor/contour_window.h"
#include "trocar/editor/patient_editor_window.h"
#include "trocar/gui/composition.h"
#include "trocar/gui/look.h"
#include "trocar/gui/window_screenshot.h"
#include "trocar/host/console.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/log.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"
#include "trocar/presenter/film_job.h"
#include "trocar/presenter/options.h"
#include "trocar/scene/scene.h"

namespace trocar::app {
namespace {

/// The window that the command line asks for, and those that it opens. It opens with the application and ends with it.
class Program {
 public:
  explicit Program(const presenter::CommandLine& command) : command_(command) {}

  /// Who operates, and where attempts go. \return what the person has to change
  base::Status FindStore() {
    const presenter::Options& options = command_.options;
    auto place = store::FindPlace(options.store);
    if (!place.ok()) return place.error();
    access_.place = std::move(*place);
    // one that nobody attends keeps an attempt only where it is told to
    const bool keeps = !options.recordings.empty() && (options.run.IsAttended() || !options.store.empty());
    if (!options.trainee.empty()) {
      auto pseudonym = centre::FindPseudonym(access_, options.trainee);
      if (!pseudonym.ok()) return pseudonym.error();
      access_.person = std::move(*pseudonym);
    }
    if (keeps)
      filing_ = std::make_unique<centre::AttemptFiling>(access_, Threads(), [this] { WakeCentre(); });
    return {};
  }

  int Run() {
    const auto application = Gtk::Application::create("", Gio::Application::Flags::NON_UNIQUE);
    // in files, certificates and SQL numbers have a point, whatever the language of the desktop
    std::locale::global(std::locale(std::locale(), std::locale::classic(), std::locale::numeric));
    std::setlocale(LC_NUMERIC, "C");
    host::UseLanguage(host::FindLocaleFolder());  // again: the line before has taken the language back
    application_ = application.get();
    application->signal_activate().connect([&] {
      ApplyLook();
      Open();
      application->add_window(*window_);
      window_->present();
      CheckLayout();
    });
    const int status = application->run();
    const bool has_failed = has_failed_ && has_failed_();
    const bool is_good = status == 0 && !has_failed;
    for (const auto& simulator : simulators_) simulator->SaveHapticRecord();
    {
      const std::lock_guard lock(mutex_);
      woken_ = nullptr;
    }
    centre_.reset();
    replay_.reset();
    simulators_.clear();
    window_.reset();
    filing_.reset();  // after whoever records
    return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
  }

 private:
  void ApplyLook() {
    if (const int percent = command_.options.text_percent; percent > 0) {
      constexpr int kDotsPerInch = 96, kParts = 1024;  // as GTK counts them
      Gtk::Settings::get_default()->property_gtk_xft_dpi() = kParts * kDotsPerInch * percent / 100;
    }

    if (const auto data = host::FindDataFolder(); data.ok()) {
      gui::ApplyLook(*data, command_.options.is_high_contrast);
    } else {
      host::Log(host::LogLevel::kWarning, data.error().Text());
    }
  }

  void Open() {
    const presenter::Options& options = command_.options;
    if (!command_.contours.images.empty()) {
      Use(std::make_unique<editor::ContourWindow>(command_.contours, since_start_));
    } else if (options.is_device_page) {
      Use(std::make_unique<DevicePage>(options, nullptr));
    } else if (!command_.patient_editor.patient.empty()) {
      Use(std::make_unique<editor::PatientEditorWindow>(command_.patient_editor));
    } else if (!options.replay.empty()) {
      Use(std::make_unique<ReplayWindow>(options,
                                         [this](presenter::Branch branch) { Simulate(std::move(branch)); }));
    } else if (!options.page.empty()) {
      auto centre = MakeCentre();
      OpenPage(*centre);
      Use(std::move(centre));
    } else {
      Use(MakeSimulator({}));
    }
  }

  int Threads() const {
    return command_.options.threads > 0 ? command_.options.threads
                                        : presenter::ChooseThreads(std::thread::hardware_concurrency());
  }

  // simulators

  std::unique_ptr<SimulatorWindow> MakeSimulator(SimulatorWindow::Beginning beginning) {
    SimulatorServices services;
    services.open_centre = [this] { OpenCentre().Presenter().Open(centre::PageKind::kHistory); };
    services.load_best = [this]() -> std::function<base::Result<centre::HomeResults>()> {
      return [access = access_] { return centre::LoadHomeResults(access); };
    };
    services.start_step = [this](const centre::StepName& step) {
      centre::CentrePresenter& presenter = OpenCentre().Presenter();
      presenter.Open(centre::PageKind::kCourses);
      presenter.StartStep(step);
    };
    services.open_result = [this](const centre::NextAndLast::Result& result) {
      centre::CentrePresenter& presenter = OpenCentre().Presenter();
      if (result.recording.empty()) return presenter.Open(centre::PageKind::kHistory);
      centre::HistoryPage::Row row;
      row.attempt = result.attempt, row.recording = result.recording;
      presenter.OpenResultOf(row);
    };
    services.be_somebody =
        [this](const std::optional<std::string>& text) -> base::Result<presenter::Somebody> {
      if (text) {
        auto pseudonym = centre::FindPseudonym(access_, *text);
        if (!pseudonym.ok()) return pseudonym.error();
        access_.person = std::move(*pseudonym);
        if (centre_ != nullptr) centre_->Presenter().BeSomebody(access_.person);
        if (filing_ != nullptr) filing_->SetPerson(access_.person);
      }
      return presenter::Somebody{centre::NameOf(access_, access_.person), access_.person};
    };
    services.open_attempt = [this](const std::filesystem::path& recording,
                                   const std::optional<centre::ExamSitting>& exam) {
      centre::CentrePresenter& presenter = OpenCentre().Presenter();
      exam ? presenter.EndExam(*exam, recording) : presenter.ExpectResult(recording);
    };
    if (filing_ != nullptr) {
      services.hooks.on_begin = [filing = filing_.get()](const auto& path, const auto& step) {
        filing->Begin(path, step);
      };
      services.hooks.on_end = [filing = filing_.get()](const auto& path) { filing->End(path); };
      services.hooks.watch = [filing = filing_.get()](const auto& path, const auto& simulation, auto from,
                                                      auto until) {
        const auto live = filing->Follow(path, simulation, from, until);
        return session::AttemptWatch{
            [live](const auto& now, const auto& controls) { live->Add(now, controls); },
            [live](bool is_whole) { live->End(is_whole); }};
      };
    }
    return std::make_unique<SimulatorWindow>(command_.options, since_start_, std::move(services),
                                             std::move(beginning));
  }

  /// Goes on in a window beside what is there, or in the simulator that is open.
  void Simulate(SimulatorWindow::Beginning beginning) {
    SimulatorWindow* open = OpenSimulator();
    if (open != nullptr && !std::holds_alternative<presenter::Branch>(beginning)) {
      if (const auto* start = std::get_if<centre::Start>(&beginning)) open->Presenter().Open(*start);
      if (const auto* task = std::get_if<presenter::TaskRequest>(&beginning)) open->Presenter().Open(*task);
      return open->present();
    }
    simulators_.push_back(MakeSimulator(std::move(beginning)));
    application_->add_window(*simulators_.back());
    simulators_.back()->present();
  }

  SimulatorWindow* OpenSimulator() {
    for (const auto& one : simulators_) {
      if (one->IsOpen()) return one.get();
    }
    auto* first = dynamic_cast<SimulatorWindow*>(window_.get());
    return first != nullptr && first->IsOpen() ? first : nullptr;
  }

  // the training centre

  std::unique_ptr<centre::CentreWindow> MakeCentre() {
    centre::CentreServices services;
    services.start = [this](const centre::Start& start) { Simulate(start); };
    services.start_task = [this](const std::string& task, const std::string& level) {
      presenter::TaskRequest request;
      request.task = task;
      if (!level.empty()) request.choice.level = level;
      Simulate(request);
    };
    services.replay = [this](const std::filesystem::path& recording, double time) {
      presenter::Options options = command_.options;
      options.replay = recording;
      options.replay_beside.clear();
      options.replay_at = time;
      replay_ = std::make_unique<ReplayWindow>(options, [this](presenter::Branch branch) {
        // who takes over sees what is operated on, not the replay on top of it
        replay_->close();
        Simulate(std::move(branch));
      });
      application_->add_window(*replay_);
      replay_->present();
    };
    services.draw_moment = [threads = Threads()](
                               const std::filesystem::path& recording, double time,
                               const std::function<bool()>& goes_on) -> base::Result<std::filesystem::path> {
      const std::filesystem::path picture =
          host::FindCacheFolder() / "moments" / (recording.stem().string() + ".png");
      const auto drawn = presenter::DrawMoment(recording, time, picture, threads, goes_on);
      if (!drawn.ok()) return drawn.error();
      return picture;
    };
    auto made =
        std::make_unique<centre::CentreWindow>(access_, Threads(), filing_.get(), std::move(services));
    made->Presenter().SignalPerson([this](const std::string& person) { access_.person = person; });
    const std::lock_guard lock(mutex_);
    woken_ = made.get();
    return made;
  }

  /// The one that is open, or a new one.
  centre::CentreWindow& OpenCentre() {
    if (auto* first = dynamic_cast<centre::CentreWindow*>(window_.get());
        first != nullptr && first->IsOpen()) {
      first->present();
      return *first;
    }
    if (centre_ == nullptr || !centre_->IsOpen()) {
      {
        const std::lock_guard lock(mutex_);
        woken_ = nullptr;
      }
      centre_ = MakeCentre();
      application_->add_window(*centre_);
    }
    centre_->present();
    return *centre_;
  }

  void OpenPage(centre::CentreWindow& window) {
    const std::string& page = command_.options.page;
    centre::CentrePresenter& presenter = window.Presenter();
    presenter.Open(page == "courses" ? centre::PageKind::kCourses
                   : page == "group" ? centre::PageKind::kGroup
                   : page == "exam"  ? centre::PageKind::kExam
                                     : centre::PageKind::kHistory);
    if (!command_.options.exam.empty()) presenter.OpenExamFile(command_.options.exam);
    const gui::RunOptions& run = command_.options.run;
    if (run.IsAttended()) return;
    Glib::signal_timeout().connect_once(
        [&window, path = run.screenshot] {
          if (const auto saved = gui::SaveScreenshot(window, path); !saved.ok()) {
            host::Log(host::LogLevel::kError, saved.error().Text());
            window.Fail(saved.error());
          }
          window.close();
        },
        static_cast<unsigned>(1e3 * run.screenshot_after));
  }

  /// By any thread.
  void WakeCentre() {
    const std::lock_guard lock(mutex_);
    if (woken_ != nullptr) woken_->Wake();
  }

  /// Where the command line asks for it: opens all pages, says what is cut off, and ends.
  void CheckLayout() {
    auto* simulator = dynamic_cast<SimulatorWindow*>(window_.get());
    if (command_.options.layout.empty() || simulator == nullptr) return;
    std::vector<LayoutCheck::Page> pages = simulator->LayoutPages();
    const auto add = [&](const char* name, centre::PageKind kind) {
      pages.push_back({name, [this, kind] { OpenCentre().Presenter().Open(kind); },
                       [this]() -> Gtk::Window* { return centre_.get(); },
                       [this] { return centre_ != nullptr && !centre_->Presenter().IsBusy(); }});
    };
    add("history", centre::PageKind::kHistory);
    add("courses", centre::PageKind::kCourses);
    add("group", centre::PageKind::kGroup);
    add("exam", centre::PageKind::kExam);
    pages.push_back({"who",
                     [this] { centre_->Presenter().Do(centre::CentreAction::kWho); },
                     [this]() -> Gtk::Window* { return centre_.get(); },
                     {}});
    pages.push_back({"result",
                     [this] {
                       const auto& rows = centre_->Presenter().Page().history.rows;
                       if (!rows.empty()) centre_->Presenter().OpenResultOf(rows.front());
                     },
                     [this]() -> Gtk::Window* { return centre_.get(); },
                     [this] {
                       const auto& page = centre_->Presenter().Page();
                       return page.history.rows.empty() || (page.result && !centre_->Presenter().IsBusy());
                     }});
    layout_ = std::make_unique<LayoutCheck>(std::move(pages), command_.options.width, command_.options.height,
                                            command_.options.layout);
    layout_->Start([this](const base::Status& written) {
      if (!written.ok()) host::Log(host::LogLevel::kError, written.error().Text());
      Glib::signal_timeout().connect_once(
          [this] {
            if (centre_ != nullptr) centre_->close();
            application_->quit();
          },
          0);
    });
  }

  template <typename Window>
  void Use(std::unique_ptr<Window> window) {
    if constexpr (std::is_same_v<Window, SimulatorWindow>) {
      has_failed_ = [shown = window.get()] {
        shown->SaveHapticRecord();
        return shown->GetFailure().has_value();
      };
    } else {
      has_failed_ = [shown = window.get()] { return shown->GetFailure().has_value(); };
    }
    window_ = std::move(window);
  }

  host::Stopwatch since_start_;
  presenter::CommandLine command_;
  centre::Access access_;
  std::mutex mutex_;
  centre::CentreWindow* woken_ = nullptr;  // guarded by mutex_; told of the filing's news
  std::unique_ptr<centre::AttemptFiling> filing_;
  Gtk::Application* application_ = nullptr;
  std::unique_ptr<Gtk::ApplicationWindow> window_;
  std::vector<std::unique_ptr<SimulatorWindow>> simulators_;  // that were opened beside it
  std::unique_ptr<centre::CentreWindow> centre_;
  std::unique_ptr<ReplayWindow> replay_;
  std::unique_ptr<LayoutCheck> layout_;
  std::function<bool()> has_failed_;  // asked once the windows have closed
};

}  // namespace
}  // namespace trocar::app

int main(int argc, char** argv) {
  using namespace trocar;
  const host::PrintableOutput fence;
  host::UseLanguage(host::FindLocaleFolder());
  const base::Result<presenter::CommandLine> command = presenter::ParseCommandLine(argc, argv);
  if (!command) {
    host::PrintErrorLine(host::ShownText(command.error()));
    return 2;
  }
  if (command->is_text_only) {
    std::fputs(command->text.c_str(), stdout);
    return EXIT_SUCCESS;
  }
  if (const base::Status level = base::CheckSimdLevel(); !level) {
    host::PrintErrorLine(host::ShownText(level.error()));
    return 2;
  }
  app::Program program(*command);
  gtk_disable_setlocale();  // glibmm does it, and what Run() sets after that would be undone
  if (!gtk_init_check()) {
    const base::Error error{base::ErrorCode::kNoDisplay,
                            "no display can be opened: start from a desktop session or set DISPLAY "
                            "or WAYLAND_DISPLAY; without one, "
                            "`trocar simulate` runs the same scene headless"};
    host::PrintErrorLine(host::ShownText(error));
    return EXIT_FAILURE;
  }
  if (const base::Status found = program.FindStore(); !found.ok()) {
    host::PrintErrorLine(host::ShownText(found.error()));
    return EXIT_FAILURE;
  }
  host::RemovePartialPathsOnSignals();
  gui::ChooseComposition();
  return program.Run();
}
