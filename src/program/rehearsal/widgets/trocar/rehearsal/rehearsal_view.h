// SPDX-License-Identifier: Apache-2.0
/// \file rehearsal_view.h  From images to an operation as one widget; what it shows and does is the presenter's.
#pragma once

#include <gtkmm.h>

#include <array>
#include <memory>
#include <optional>

#include "trocar/editor/contour_pane.h"
#include "trocar/editor/mesh_view.h"
#include "trocar/gui/command_bar.h"
#include "trocar/gui/tips.h"
#include "trocar/patient/patient.h"
#include "trocar/rehearsal/rehearsal_cards.h"
#include "trocar/rehearsal/rehearsal_presenter.h"

namespace trocar::rehearsal {

class RehearsalView : public Gtk::Box, private RehearsalScreen {
 public:
  /// \param folder    of what is under way
  /// \param patients  where a patient goes that is operated on
  RehearsalView(const std::filesystem::path& folder, const std::filesystem::path& patients);
  ~RehearsalView() override;

  /// Goes on where it was left, and takes the keyboard.
  void Open();
  /// Before the window closes, or shows something else.
  void Leave() { presenter_.Leave(); }
  /// \return whether the key was used here
  bool OnKey(guint key, Gdk::ModifierType state);
  void OnKeyReleased(guint key);

  sigc::signal<void(std::filesystem::path)>& SignalOperate() { return signal_operate_; }
  sigc::signal<void()>& SignalClosed() { return signal_closed_; }

 private:
  void MakeSteps();
  void MakeMiddle();
  void MakeFoot();
  void MakePorts();
  void MakePane(const editor::ContourOptions& slices);
  void ClosePane();
  bool IsDrawing() const;
  bool IsOnSlice() const;
  void CountContours();
  void FollowWork();
  void FocusStep();

  // RehearsalScreen
  void Show(const RehearsalPage& page) override;
  void ShowSlices(const std::optional<editor::ContourOptions>& slices) override;
  void ShowOverlay(std::optional<images::LabelVolume> labels) override;
  base::Status SaveContours() override;
  void ShowFigure(const patient::Patient& patient) override;
  void ShowPorts(const patient::Patient& patient, std::optional<std::size_t> chosen) override;
  void Operate(const std::filesystem::path& patient) override { signal_operate_.emit(patient); }

  view::PatientColours colours_;
  std::array<Gtk::Button, kRehearsalSteps> steps_;
  Gtk::Stack left_;
  Gtk::Box slices_{Gtk::Orientation::VERTICAL};
  Gtk::Label nothing_;
  editor::MeshView figure_;
  Gtk::ScrolledWindow scroller_;
  Gtk::Label hint_, problem_, doing_;
  Gtk::ProgressBar progress_;
  Gtk::Box under_way_;
  Gtk::Button cancel_{host::Translate("Cancel")}, back_{host::Translate("Back")}, next_,
      build_{host::Translate("Build again")}, map_{host::Translate("Take a label map")},
      forget_{host::Translate("Start anew")};
  std::unique_ptr<gui::Tips> pane_tips_;  // of the pane that is open; they end after its widgets
  std::unique_ptr<gui::CommandBar<editor::ContourAction, editor::ContourNeeds>> pane_bar_;
  std::unique_ptr<editor::ContourPane> pane_;
  bool wants_map_ = false;  // while contours are drawn, the card with maps was asked for
  RehearsalStep shown_step_ = RehearsalStep::kImages;
  bool is_dragging_ = false;
  std::vector<math::Vec3> ports_;
  sigc::connection pulse_;
  Glib::Dispatcher news_;
  RehearsalPresenter presenter_;  // before the cards, which use it
  ImagesCard images_card_{presenter_};
  OrgansCard organs_card_{presenter_};
  LinesCard check_card_{host::Mark("Check")};
  PortsCard ports_card_{presenter_};
  LinesCard origin_card_{host::Mark("What it is made of")};
  sigc::signal<void(std::filesystem::path)> signal_operate_;
  sigc::signal<void()> signal_closed_;
};

}  // namespace trocar::rehearsal
