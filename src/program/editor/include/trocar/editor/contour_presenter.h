// SPDX-License-Identifier: Apache-2.0
/// \file contour_presenter.h  Presenter of the contour window, without a widget: opening, editing, saving, building.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "trocar/anatomy/build_patient.h"
#include "trocar/editor/contour_commands.h"
#include "trocar/editor/contour_editor.h"
#include "trocar/editor/contour_options.h"
#include "trocar/editor/contour_side_file.h"
#include "trocar/editor/surface_updates.h"
#include "trocar/gui/background_job.h"
#include "trocar/gui/question.h"
#include "trocar/host/translate.h"

namespace trocar::editor {

/// All that the window says, besides canvas, slice bar and panel, which read the editor.
struct ContourPage {
  std::string title = host::Translate("Trocar: contours");
  std::string hint, series, state;
  bool is_hint_warning = false;
  bool is_busy = false;      ///< a bar shows how far it is
  double fraction = 0;       ///< [-]
  bool is_building = false;  ///< a patient is being built; it can be stopped
  bool is_growing = false;   ///< an organ grows; it can be stopped
  bool is_stopping = false;  ///< the build or growth has been told to stop
  bool is_document_open = false;
  bool is_help_open = false;
  bool has_points = true, has_fill = true, has_ghosts = true, has_reference = false;
};

/// File or folder that a person is asked to choose.
enum class FileQuestion { kOpenContours, kSaveContours, kPatientFolder };

enum class ContourTimer {
  kSurfaces,  ///< once: an edit becomes a surface
  kAutosave,  ///< again and again
  kCount
};

/// View interface that the presenter drives; a window implements it.
class ContourScreen {
 public:
  virtual ~ContourScreen() = default;
  /// Brings all widgets to what the page, the editor and the presenter's commands say.
  virtual void Show(const ContourPage& page) = 0;
  /// Sets the editor that canvas, slice bar and panel work on from now on. Null, passed before the old one is destroyed: nothing.
  virtual void UseEditor(ContourEditor* editor) = 0;
  virtual void FocusCanvas() = 0;

  virtual void ShowError(const base::Error& error) = 0;
  virtual void ShowNotice(const std::string& text) = 0;
  virtual void Ask(gui::Question question) = 0;
  virtual void ChooseFile(FileQuestion what, std::function<void(std::filesystem::path)> act) = 0;
  /// Asks for what the pictures do not say. \return whether somebody, or a script, will answer
  virtual bool AskSizes(const images::ImageSeriesOptions& series) = 0;

  virtual void ForgetSurfaces() = 0;
  virtual void ShowSurface(int structure, contours::OrganMesh mesh) = 0;
  /// \param problem  why an organ has no surface; may be empty
  virtual void ShowSurfaceProblem(int structure, const std::string& problem) = 0;
  virtual void ShowSurfaceJob(const contours::MeshJob::State& state) = 0;

  /// OnTimer() is called after that time.
  virtual void StartTimer(ContourTimer timer, unsigned milliseconds) = 0;
  /// Carries out an action of the window itself: full screen and the end.
  virtual void DoInWindow(ContourAction action) = 0;
};

/// How the threads of the presenter wake the window's thread; called by them.
struct ContourWakes {
  std::function<void()> on_loaded, on_built, on_progress, on_surfaces;
  std::function<void()> on_grown = [] {};
};

class ContourPresenter {
 public:
  /// \param user_folder  of this person's data
  /// \param screen       outlives the presenter
  ContourPresenter(const ContourOptions& options, std::filesystem::path user_folder, ContourScreen& screen,
                   ContourWakes wakes);
  ~ContourPresenter();

  /// Opens what the options name.
  void Start();
  /// Nothing while something is being opened.
  void Open(contours::WorkspaceOptions options);
  /// Opens the same pictures with what a person said of them.
  void OpenWith(const images::ImageSeriesOptions& series);

  // the presenter's threads and timers say so
  void FinishLoading();
  void FinishBuild();
  void FinishGrowth();
  void ShowProgress();
  void TakeSurfaces();
  /// \return whether the timer goes on
  bool OnTimer(ContourTimer timer);

  /// Does what a key or a button asks for, where it is possible.
  void Do(ContourAction action);
  bool IsEnabled(ContourAction action) const { return Meets(FindNeeds(action)); }
  gui::ButtonState FindButton(const ContourCommand& command) const;
  /// The editor may have changed the document, or what is chosen.
  void OnEdited();
  void GoToSlice(int slice);
  void StepSlice(int steps);
  void ShowHint(const std::string& text, bool is_warning = false);
  void Report(const base::Error& error);
  /// \param part  "reference", "ghosts", "points", "fill" or "help"
  /// \return false for another word
  bool SetPart(std::string_view part, bool is_on);

  /// \return whether the window stays open, because a question has been asked
  bool OnClose();
  /// \pre contours are open and saved, and no patient is being built (TROCAR_ASSERT)
  void StartBuild(const std::filesystem::path& folder);
  /// Gives up the organ that grows, or the patient that is being built.
  void Stop();
  void CancelSurfaces();

  /// Ends a run that is not attended.
  void Abandon(const base::Error& error);
  const std::optional<base::Error>& GetFailure() const { return failure_; }
  bool IsBuilding() const { return building_.IsRunning(); }
  bool IsGrowing() const { return growing_.IsRunning(); }
  bool CanBuild() const;
  /// No surface is due or being made.
  bool AreSurfacesDone() const;

  ContourEditor* Editor() { return editor_.get(); }
  contours::ContourWorkspace* Workspace() { return workspace_.get(); }
  const ContourOptions& GetOptions() const { return options_; }
  const ContourSideFile& SideFile() const { return side_file_; }
  const ContourPage& Page() const { return page_; }

 private:
  bool Meets(ContourNeeds needs) const;
  bool IsChecked(ContourAction action) const;
  using Handler = gui::CommandHandler<ContourPresenter, ContourAction>;
  /// Handlers of the actions that the presenter carries out itself; the editor does the rest.
  static std::span<const Handler> Handlers() noexcept;
  void UseWorkspace(contours::ContourWorkspace workspace);
  void OpeningFailed(const base::Error& error);
  void Drop();
  bool TakeSideFile();
  void StartAutosave();
  void OfferRecovered();
  bool Save();
  void SaveAs(std::function<void()> then);
  void ChooseAndOpen();
  void ChooseAndBuild();
  void CloseAnyway();
  void ToggleGrowMode();
  void StartGrowth(const math::Vec2& place);
  void RequestSurfaces(bool is_all);
  void PrefetchNeighbours();
  void Refresh();
  std::string DescribeState() const;

  ContourOptions options_;
  std::filesystem::path user_folder_;
  ContourScreen* screen_;
  ContourPage page_;
  std::optional<base::Error> failure_;
  bool has_asked_sizes_ = false, is_closing_ = false, are_surfaces_due_ = false;

  // order matters: what computes goes before what it computes on
  std::unique_ptr<contours::ContourWorkspace> workspace_;
  std::unique_ptr<ContourEditor> editor_;
  ContourSideFile side_file_;
  std::unique_ptr<contours::SlicePrefetcher> prefetcher_;
  std::unique_ptr<SurfaceUpdates> surfaces_;
  std::uint64_t shown_revision_ = 0;

  ContourWakes wakes_;
  gui::JobProgress progress_;
  contours::WorkspaceOptions loading_options_;
  std::stop_source build_stop_;
  std::filesystem::path build_folder_;
  std::stop_source growth_stop_;
  bool is_growth_void_ = false;  // other contours have been opened since it began
  gui::BackgroundJob<base::Result<contours::ContourWorkspace>> loading_;
  gui::BackgroundJob<base::Result<anatomy::BuildReport>> building_;
  gui::BackgroundJob<base::Result<contours::GrownOrgan>> growing_;
};

}  // namespace trocar::editor
