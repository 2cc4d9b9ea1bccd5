// SPDX-License-Identifier: Apache-2.0
/// \file replay_presenter.h  Presenter of the replay window, without a widget: time, camera, playing on from a moment.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trocar/gui/background_job.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/branch.h"
#include "trocar/presenter/options.h"
#include "trocar/presenter/replay_commands.h"
#include "trocar/record/tip_path.h"
#include "trocar/session/replay_runner.h"
#include "trocar/view/free_camera.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::presenter {

/// A place on the bar.
struct ReplayMark {
  enum class Kind : std::uint8_t { kEvent, kPhase, kRemark, kError };
  double time = 0;  ///< [s]
  Kind kind = Kind::kEvent;
  std::string text;  ///< for a person
};

/// Errors, phases, remarks and events of a recording, in time order.
std::vector<ReplayMark> ListMarks(const record::Recording& recording);

/// "1:05.3", of a negative time "0:00.0".
std::string FormatClock(double seconds);

/// All that the window says and shows, besides pictures and list.
struct ReplayPage {
  std::string title = host::Translate("Trocar: replay");
  std::string clock, state, message;
  std::array<std::string, 2> about;  ///< of each side; empty: there is none
  bool is_warning = false;
  double begin = 0, end = 0, time = 0;  ///< of the bar [s]
  double seek_progress = 1;             ///< 1: nothing is being sought [-]
  double known_share = 0;               ///< as session::ReplayStatus
  bool is_help_open = false, is_list_open = false;
  view::ViewOptions view;
  std::optional<base::Error> failure;
};

/// View interface that the presenter drives; a window implements it.
class ReplayScreen {
 public:
  virtual ~ReplayScreen() = default;
  /// Brings the widgets to what the page and the presenter's commands say.
  virtual void Show(const ReplayPage& page) = 0;
  /// Sets the replay that a side's picture shows from now on. Null, passed before the old one is destroyed: nothing.
  virtual void UseReplay(std::size_t side, const session::ReplayRunner* replay) = 0;
  virtual void ShowMarks(const std::vector<ReplayMark>& marks) = 0;
  /// Reads the list of recordings anew, beside the window.
  virtual void FillRecordingList(const std::filesystem::path& folder) = 0;
  /// Somebody goes on from a moment.
  virtual void TakeOver(Branch branch) = 0;
  /// Carries out an action of the window itself: full screen, the end.
  virtual void DoInWindow(ReplayAction action) = 0;
};

class ReplayPresenter {
 public:
  static constexpr std::size_t kOwn = 0, kBeside = 1, kSides = 2;

  /// \param options    replay, replay_beside, threads and recordings are used
  /// \param screen     outlives the presenter
  /// \param on_loaded  called by another thread when FinishLoading() is due
  ReplayPresenter(const Options& options, ReplayScreen& screen, std::function<void()> on_loaded);
  ~ReplayPresenter();

  /// Begins to read what the options name.
  void Start();
  void FinishLoading();
  /// Begins to read what is shown beside; nothing while something is being read.
  void OpenBeside(const std::filesystem::path& recording);

  void Do(ReplayAction action);
  bool IsEnabled(ReplayAction action) const;
  gui::ButtonState FindButton(const ReplayCommand& command) const;
  /// The bar is dragged, or a mark is chosen: there, and no further. \param time  [s]
  void GoTo(double time);
  /// A little before a mark.
  void GoToMark(const ReplayMark& mark);

  /// The free camera; nothing where the recorded one is used. \param dx, dy  [pixels]; height  of the picture
  void Turn(double dx, double dy, int height);
  void Pan(double dx, double dy, int height);
  void Zoom(double steps);

  /// Content of a side's picture in a frame.
  struct SideWork {
    const simulation::Snapshot* snapshot = nullptr;  ///< null: there is none
    view::Overlay overlay;
  };
  /// \param now  of the frame clock [s]
  std::array<SideWork, kSides> Advance(double now);

  /// Says what the window has done by itself.
  void Tell(const std::string& text, bool is_warning = false) { Say(text, is_warning); }
  const ReplayPage& Page() const { return page_; }
  double Time() const { return page_.time; }
  double Speed() const;
  bool IsPlaying() const { return is_playing_; }
  const std::optional<base::Error>& GetFailure() const { return page_.failure; }

 private:
  /// A recording that is open.
  struct Side {
    std::filesystem::path path;
    std::unique_ptr<session::ReplayRunner> replay;
    record::TipPath path_of_tips;
    std::vector<ReplayMark> marks;
    double first = 0, last = 0;  // [s]
    bool has_expert = false;
  };
  static base::Result<Side> OpenSide(const std::filesystem::path& path, int threads);
  void Load(std::size_t side, const std::filesystem::path& path);
  void UseSide(std::size_t side, Side opened);
  void CloseBeside();
  bool Meets(ReplayNeeds needs) const;
  bool MoveInTime(ReplayAction action);
  bool ChangeView(ReplayAction action);
  void StepMark(int direction);
  void AskForBranch(bool is_experts);
  void TakeBranch();
  bool KeepsUp() const;
  void Follow();
  void Say(const std::string& text, bool is_warning = false);
  void Refresh();
  int Threads() const;

  Options options_;
  ReplayScreen* screen_;
  ReplayPage page_;
  std::array<std::optional<Side>, kSides> sides_;
  bool is_playing_ = false, is_slow_ = false, has_ghosts_ = false, is_branch_experts_ = false,
       is_branching_ = false;
  bool has_diverged_ = false, was_there_ = false;
  std::size_t speed_ = 2;  // of the list
  std::optional<render::OrbitCamera> camera_;
  double last_frame_ = 0;  // of the frame clock [s]
  std::size_t loading_side_ = 0;
  std::filesystem::path loading_path_;
  gui::BackgroundJob<base::Result<Side>> loading_;
};

}  // namespace trocar::presenter
