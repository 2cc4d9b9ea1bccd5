// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_presenter.h  From images to an operation, step by step, without a widget: a series, its organs, the patient, ports, the
/// operation. What is done survives the window.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/editor/contour_options.h"
#include "trocar/gui/background_job.h"
#include "trocar/host/file_lock.h"
#include "trocar/images/series_list.h"
#include "trocar/patient/patient.h"
#include "trocar/rehearsal/port_editor.h"
#include "trocar/rehearsal/rehearsal_state.h"
#include "trocar/rehearsal/rehearsal_work.h"

namespace trocar::rehearsal {

struct RehearsalStepPage {
  std::string title;
  bool is_open = false;  ///< may be gone to
  bool is_done = false;
};

/// One series of those that were found.
struct RehearsalSeries {
  std::string title, about;  ///< "CT, portal venous"; "DICOM, 120 slices, 0.70 mm pixels, 2.50 mm apart"
  std::string problem;       ///< why it cannot be chosen
  images::ColorImage preview;
};

struct RehearsalPort {
  std::string name, place, reason;
};

struct RehearsalPorts {
  std::vector<RehearsalPort> list;
  std::size_t chosen = 0;
  double head_up_deg = 0, right_up_deg = 0;
  std::string table_reason;
  bool can_undo = false, can_redo = false, is_proposal = true;
};

/// All that the window says, besides slices and figure.
struct RehearsalPage {
  RehearsalStep step = RehearsalStep::kImages;
  std::array<RehearsalStepPage, kRehearsalSteps> steps;
  std::string hint;                    ///< what to do now
  std::optional<base::Error> problem;  ///< of what was asked for last; the hint leads on
  std::string doing;                   ///< what is under way; empty: nothing
  double fraction = 0;                 ///< of that; negative: not known [-]
  bool can_go_back = false, can_go_on = false;

  std::string images;
  std::vector<RehearsalSeries> series;
  std::optional<std::size_t> chosen_series;

  OrganSource source = OrganSource::kNone;
  std::string labels;  ///< file of the map
  std::vector<LabelChoice> label_choices;
  int liver = 0, gallbladder = 0;

  bool is_built = false, is_stale = false;  ///< stale: what it was built from has changed since
  std::vector<RehearsalLine> check;

  RehearsalPorts ports;

  std::vector<RehearsalLine> origin;
};

/// View interface that the presenter drives; a window implements it.
class RehearsalScreen {
 public:
  virtual ~RehearsalScreen() = default;
  virtual void Show(const RehearsalPage& page) = 0;
  /// Opens a series, with the contours that are drawn on it; RehearsalPresenter::SlicesOpened is told. Nothing: closes it.
  virtual void ShowSlices(const std::optional<editor::ContourOptions>& slices) = 0;
  /// Lays a map over the slices, or none.
  virtual void ShowOverlay(std::optional<images::LabelVolume> labels) = 0;
  /// Writes what is drawn into its file.
  virtual base::Status SaveContours() = 0;
  virtual void ShowFigure(const patient::Patient& patient) = 0;
  /// Its ports, with one of them highlighted; none: no ports are shown.
  virtual void ShowPorts(const patient::Patient& patient, std::optional<std::size_t> chosen) = 0;
  virtual void Operate(const std::filesystem::path& patient) = 0;
};

class RehearsalPresenter {
 public:
  /// \param folder    of what is under way
  /// \param patients  where a patient goes that is operated on
  /// \param screen    outlives the presenter
  /// \param on_news   called by another thread: FinishWork() is due
  RehearsalPresenter(std::filesystem::path folder, std::filesystem::path patients, RehearsalScreen& screen,
                     std::function<void()> on_news);
  ~RehearsalPresenter();

  /// Goes on where it was left.
  void Start();
  void FinishWork();
  /// Shows how far it is.
  void ShowProgress();
  bool IsBusy() const { return job_.IsRunning(); }
  /// Cancels the work that is under way; it then has no result.
  void Cancel();
  /// All is forgotten; patients that were operated on stay.
  void Forget();

  // steps
  void GoTo(RehearsalStep step);
  void GoOn();
  void GoBack();

  // images
  void ChooseImages(const std::filesystem::path& path);
  void ChooseSeries(std::size_t index);
  /// The window has opened the series that ShowSlices named.
  void SlicesOpened(const images::ImageSeriesInfo& series, const images::ImageSeriesOptions& options);

  // organs
  void ChooseLabels(const std::filesystem::path& file);
  void NameLabels(int liver, int gallbladder);
  void DrawContours();
  /// The person has drawn.
  void SetContoured(std::size_t liver_slices, std::size_t gallbladder_slices);

  // patient
  void Build();

  // ports and table
  void ChoosePort(std::size_t port);
  void MovePort(double left_mm, double up_mm);
  /// A drag: undo takes it back as one.
  void GrabPort(std::size_t port);
  void DragPort(const math::Vec3& p_world);
  void ReleasePort();
  void TiltTable(double head_up_deg, double right_up_deg);
  void Undo();
  void Redo();
  void ResetPorts();
  /// The patient as it is shown, or null.
  const patient::Patient* GetPatient() const { return built_ ? &built_->patient : nullptr; }

  void Operate();
  /// Before the window closes, or shows something else.
  void Leave();

  const RehearsalPage& Page() const { return page_; }
  const RehearsalState& State() const { return state_; }

 private:
  using Then = std::function<void()>;
  using Work = std::function<Then(const images::Progress&, const std::stop_token&)>;
  void Run(const std::string& doing, Work work);
  void Begin();
  std::filesystem::path StateFile() const { return folder_ / "rehearsal.json"; }
  std::filesystem::path Draft() const { return folder_ / "patient"; }
  std::filesystem::path ContoursFile() const;
  void Keep();
  void Refresh();
  void RefreshSteps();
  void RefreshPorts();
  std::string HintText() const;
  bool CanOpen(RehearsalStep step) const;
  bool IsBuilt() const { return built_.has_value(); }
  bool IsStale() const;
  void Complain(const base::Error& error);
  void List();
  void TakeSeries(base::Result<std::vector<images::ListedSeries>> listed);
  void OpenSlices();
  void CloseSlices();
  void CheckLabels();
  void TakeLabels(base::Result<LabelMap> map);
  void UseBuilt(RehearsedPatient built);
  void TakeBuilt(base::Result<RehearsedPatient> built, const std::string& built_from);
  void LoadDraft();
  void ShowPorts();
  void KeepPorts();
  base::Result<std::filesystem::path> KeepPatient();

  std::filesystem::path folder_, patients_;
  RehearsalScreen& screen_;
  RehearsalState state_;
  RehearsalPage page_;
  std::optional<host::FileLock> lock_;
  std::vector<images::ListedSeries> listed_;
  std::optional<images::ImageSeriesInfo> series_;  // that is open
  std::optional<LabelMap> labels_;
  std::optional<RehearsedPatient> built_;
  PortEditor ports_;
  std::array<std::size_t, 2> contoured_ = {0, 0};  // slices of liver and gallbladder

  struct Request {
    std::string doing;
    Work work;
  };
  std::vector<Request> waiting_;
  std::stop_source stop_;
  std::shared_ptr<gui::JobProgress> progress_ = std::make_shared<gui::JobProgress>();  // shared with the job
  gui::BackgroundJob<Then> job_;
};

}  // namespace trocar::rehearsal
