// SPDX-License-Identifier: Apache-2.0
/// \file patient_panel_presenter.h  Presenter of the patient editor's panel, without a widget.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/editor/patient_editor.h"

namespace trocar::editor {

/// Names to choose one of.
struct ChoicePage {
  std::vector<std::string> names;
  std::size_t chosen = 0;
};

struct PatientPanelPage {
  EditorTool tool = EditorTool::kLook;

  // painting
  ChoicePage regions;  ///< "liver: falciform"
  bool is_erasing = false;
  double brush_mm = 0;

  // ducts and arteries
  struct Tube {
    std::string name;
    render::SrgbColour colour{};
    bool is_placed = false;  ///< by landmarks: the images do not show it

    friend bool operator==(const Tube&, const Tube&) = default;
  };
  std::vector<Tube> tubes;
  std::optional<std::uint32_t> tube;
  bool has_tube_point = false;
  std::string tube_facts;
  ChoicePage from, to;  ///< where the chosen one begins and ends
  double reach_mm = 0;
  ChoicePage missing;  ///< that could be added
  bool can_add = false;

  struct Landmark {
    std::string name, place;  ///< place: LPS [mm], as the files give it

    friend bool operator==(const Landmark&, const Landmark&) = default;
  };
  std::vector<Landmark> landmarks;
  std::optional<std::uint32_t> landmark;

  view::PatientFigureOptions look;
};
PatientPanelPage MakePatientPanelPage(const PatientEditor& editor);

/// Findings of the check, for a person.
struct FindingsPage {
  struct Row {
    std::string title, text;  ///< "L-MESH-OPEN  liver"
    std::string where;        ///< as anatomy::FindWhere takes it
  };
  std::string title;
  std::vector<Row> rows;
};
FindingsPage MakeFindingsPage(const anatomy::LintReport& report);

/// View interface that the presenter drives; a panel implements it.
class PatientPanelScreen {
 public:
  virtual ~PatientPanelScreen() = default;
  virtual void Show(const PatientPanelPage& page) = 0;
  /// The editor was changed from here.
  virtual void OnEdited() = 0;
  virtual void OnRefused(const base::Error& error) = 0;
};

/// Places in lists are those of the page.
class PatientPanelPresenter {
 public:
  /// \param screen  outlives the presenter
  explicit PatientPanelPresenter(PatientPanelScreen& screen) : screen_(screen) {}

  /// \param editor  outlives its use here; null: nothing is done
  void UseEditor(PatientEditor* editor);
  void Refresh();

  void ChooseTool(EditorTool tool);
  void ChooseRegion(std::size_t place);
  void SetErasing(bool is_erasing);
  void SetBrush(double radius_mm);

  void ChooseTube(std::size_t place);
  void JoinTube(anatomy::TubeEnd end, std::size_t place);
  void SetReach(double reach_mm);
  void InsertPoint();
  void DeletePoint();
  void RemoveTube();
  void AddMissingTube(std::size_t place);

  void ChooseLandmark(std::size_t place);
  void SetLook(const view::PatientFigureOptions& look);

 private:
  void Finish(const base::Status& status = {});

  PatientPanelScreen& screen_;
  PatientEditor* editor_ = nullptr;
};

}  // namespace trocar::editor
