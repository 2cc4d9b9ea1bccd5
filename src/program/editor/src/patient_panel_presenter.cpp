// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_panel_presenter.h"

#include <algorithm>
#include <cstdio>

#include "trocar/host/translate.h"
#include "trocar/patient/patient.h"

namespace trocar::editor {
namespace {

constexpr double kMmPerMetre = 1000.0;

/// Words of a name as a person reads them: "cystic duct".
std::string Spoken(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return host::TranslateComposed(name);
}

/// What a tube can begin or end at; the first, empty one leaves the scene.
std::vector<std::string> FindEnds(const patient::Patient& patient, const patient::Tube& tube) {
  std::vector<std::string> names = {""};
  for (const patient::Organ& organ : patient.organs) names.push_back(organ.name);
  for (const patient::Tube& other : patient.tubes) {
    if (other.name != tube.name) names.push_back(other.name);
  }
  return names;
}

ChoicePage ChooseEnd(const std::vector<std::string>& names, const std::string& chosen) {
  ChoicePage page;
  for (const std::string& name : names)
    page.names.push_back(name.empty() ? host::Translate("leaves the scene") : Spoken(name));
  page.chosen = static_cast<std::size_t>(std::find(names.begin(), names.end(), chosen) - names.begin());
  return page;
}

std::string DescribeTube(const patient::Tube& tube) {
  const auto millimetres = [](const char* format, double metres) {
    char text[32];
    std::snprintf(text, sizeof(text), format, kMmPerMetre * metres);
    return host::LocalNumber(text);
  };
  const auto [thin, thick] = std::minmax_element(tube.line.radii.begin(), tube.line.radii.end());
  return host::TranslateWith(
      "{1} mm long, radius {2} to {3} mm, {4} points",
      {millimetres("%.1f", geometry::CalcLength(tube.line)), millimetres("%.2f", *thin),
       millimetres("%.2f", *thick), std::to_string(tube.line.points.size())});
}

void AddRegions(const PatientEditor& editor, PatientPanelPage& page) {
  for (const RegionChoice& choice : editor.Regions()) {
    if (choice == editor.region) page.regions.chosen = page.regions.names.size();
    page.regions.names.push_back(Spoken(choice.organ) + ": " + Spoken(choice.region));
  }
  page.is_erasing = editor.is_erasing;
  page.brush_mm = kMmPerMetre * editor.brush_radius;
}

void AddTubes(const PatientEditor& editor, PatientPanelPage& page) {
  const patient::Patient& patient = editor.GetPatient();
  for (const patient::Tube& tube : patient.tubes)
    page.tubes.push_back({Spoken(tube.name), editor.look.colours.Of(tube), !tube.is_seen});
  for (const std::string& name : anatomy::FindMissingTubes(patient))
    page.missing.names.push_back(Spoken(name));
  page.can_add = !page.missing.names.empty();
  if (!page.can_add) page.missing.names = {host::Translate("no usual duct is missing")};
  page.reach_mm = kMmPerMetre * editor.reach;
  page.tube = editor.Tube();
  page.has_tube_point = editor.TubePoint().has_value();
  page.tube_facts = host::Translate("Choose a duct here or in the picture.");
  if (!page.tube) return;
  const patient::Tube& tube = patient.tubes[*page.tube];
  const std::vector<std::string> ends = FindEnds(patient, tube);
  page.tube_facts = DescribeTube(tube);
  page.from = ChooseEnd(ends, tube.from);
  page.to = ChooseEnd(ends, tube.to);
}

void AddLandmarks(const PatientEditor& editor, PatientPanelPage& page) {
  for (const patient::Landmark& landmark : editor.GetPatient().landmarks) {
    const auto& p = landmark.position;
    char place[96];
    std::snprintf(place, sizeof(place), "%.1f  %.1f  %.1f", kMmPerMetre * p.x, -kMmPerMetre * p.z,
                  kMmPerMetre * p.y);
    page.landmarks.push_back({Spoken(landmark.name), place});
  }
  page.landmark = editor.Landmark();
}

}  // namespace

PatientPanelPage MakePatientPanelPage(const PatientEditor& editor) {
  PatientPanelPage page;
  page.tool = editor.tool;
  AddRegions(editor, page);
  AddTubes(editor, page);
  AddLandmarks(editor, page);
  page.look = editor.look;
  return page;
}

FindingsPage MakeFindingsPage(const anatomy::LintReport& report) {
  FindingsPage page;
  for (const anatomy::LintFinding& finding : report.findings)
    page.rows.push_back(
        {finding.code + "  " + Spoken(finding.where), host::TranslateComposed(finding.text), finding.where});
  const std::size_t count = page.rows.size();
  page.title = count == 0 ? host::Translate("No findings: this patient can be operated on.")
                          : host::TranslateCount("{1} finding; click one to look at it",
                                                 "{1} findings; click one to look at it", count);
  return page;
}

void PatientPanelPresenter::UseEditor(PatientEditor* editor) {
  editor_ = editor;
  Refresh();
}

void PatientPanelPresenter::Refresh() {
  if (editor_ != nullptr) screen_.Show(MakePatientPanelPage(*editor_));
}

void PatientPanelPresenter::Finish(const base::Status& status) {
  if (!status) screen_.OnRefused(status.error());
  screen_.OnEdited();
}

void PatientPanelPresenter::ChooseTool(EditorTool tool) {
  if (editor_ == nullptr) return;
  editor_->tool = tool;
  Finish();
}

// painting

void PatientPanelPresenter::ChooseRegion(std::size_t place) {
  if (editor_ == nullptr) return;
  const auto choices = editor_->Regions();
  if (place >= choices.size()) return;
  editor_->region = choices[place];
  Finish();
}

void PatientPanelPresenter::SetErasing(bool is_erasing) {
  if (editor_ == nullptr) return;
  editor_->is_erasing = is_erasing;
  Finish();
}

void PatientPanelPresenter::SetBrush(double radius_mm) {
  if (editor_ == nullptr) return;
  editor_->brush_radius = radius_mm / kMmPerMetre;
  Finish();
}

// ducts and arteries

void PatientPanelPresenter::ChooseTube(std::size_t place) {
  if (editor_ == nullptr) return;
  editor_->ChooseTube(static_cast<std::uint32_t>(place));
  Finish();
}

void PatientPanelPresenter::JoinTube(anatomy::TubeEnd end, std::size_t place) {
  if (editor_ == nullptr || !editor_->Tube()) return;
  const std::uint32_t tube = *editor_->Tube();
  const auto ends = FindEnds(editor_->GetPatient(), editor_->GetPatient().tubes[tube]);
  if (place >= ends.size()) return;
  Finish(editor_->Document().Edit(
      "join " + editor_->GetPatient().tubes[tube].name,
      [&](patient::Patient& patient) { return anatomy::JoinTubeEnd(patient, tube, end, ends[place]); }));
}

void PatientPanelPresenter::SetReach(double reach_mm) {
  if (editor_ != nullptr) editor_->reach = reach_mm / kMmPerMetre;
}

void PatientPanelPresenter::InsertPoint() {
  if (editor_ != nullptr) Finish(editor_->InsertPoint());
}

void PatientPanelPresenter::DeletePoint() {
  if (editor_ != nullptr) Finish(editor_->DeletePoint());
}

void PatientPanelPresenter::RemoveTube() {
  if (editor_ == nullptr) return;
  if (!editor_->Tube()) return Finish(base::Error{base::ErrorCode::kUsage, "choose a duct or artery first"});
  const std::uint32_t tube = *editor_->Tube();
  const auto status = editor_->Document().Edit(
      "remove " + editor_->GetPatient().tubes[tube].name,
      [tube](patient::Patient& patient) { return anatomy::RemoveTube(patient, tube); });
  editor_->ChooseTube(std::nullopt);
  Finish(status);
}

void PatientPanelPresenter::AddMissingTube(std::size_t place) {
  if (editor_ == nullptr) return;
  const auto names = anatomy::FindMissingTubes(editor_->GetPatient());
  if (place >= names.size()) return;
  const auto status = editor_->Document().Edit("add " + names[place], [&](patient::Patient& patient) {
    return anatomy::AddTemplateTube(patient, names[place]);
  });
  if (status) editor_->ChooseTube(static_cast<std::uint32_t>(editor_->GetPatient().tubes.size() - 1));
  Finish(status);
}

// landmarks and looks

void PatientPanelPresenter::ChooseLandmark(std::size_t place) {
  if (editor_ == nullptr) return;
  editor_->ChooseLandmark(static_cast<std::uint32_t>(place));
  Finish();
}

void PatientPanelPresenter::SetLook(const view::PatientFigureOptions& look) {
  if (editor_ == nullptr) return;
  editor_->look = look;
  Finish();
}

}  // namespace trocar::editor
