// SPDX-License-Identifier: Apache-2.0
#include "contour_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "contour_painter.h"
#include "trocar/app/contour_read_outs.h"

namespace trocar::app {
namespace {

constexpr int kPanelWidth = 340;
constexpr int kNewOrganTriangles = 1500;
constexpr double kMostReach = 30;  // [pixels], as the file allows

void SetLabel(Gtk::Label& label, const char* style) {
  label.add_css_class(style);
  label.set_halign(Gtk::Align::FILL);
  label.set_xalign(0);
  label.set_wrap(true);
  label.set_max_width_chars(10);
  label.set_hexpand(true);
}

void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
  if (label.get_visible() == text.empty()) label.set_visible(!text.empty());
}

std::string HexColour(const Colour3& c) {
  char text[8];
  const auto byte = [](double v) { return static_cast<int>(std::lround(255 * v)); };
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", byte(c[0]), byte(c[1]), byte(c[2]));
  return text;
}

}  // namespace

ContourPanel::ContourPanel() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  set_size_request(kPanelWidth, -1);
  set_hexpand(false);
  add_css_class("panel");
  set_spacing(7);
  set_margin(8);
  AddOrgans();
  AddSlice();
  AddEdges();
  AddSurface();
}

ContourPanel::~ContourPanel() {
  name_popover_.unparent();
}

Gtk::Box& ContourPanel::AddCard(const char* title, bool is_growing) {
  auto* card = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  card->add_css_class("card");
  card->set_spacing(4);
  card->set_vexpand(is_growing);
  if (title != nullptr) {
    auto* label = Gtk::make_managed<Gtk::Label>(title);
    SetLabel(*label, "card-title");
    card->append(*label);
  }
  append(*card);
  return *card;
}

void ContourPanel::AddOrgans() {
  Gtk::Box& card = AddCard("Organs");
  organs_.set_spacing(3);
  card.append(organs_);
  auto* row = Gtk::make_managed<Gtk::Box>();
  row->set_spacing(6);
  for (Gtk::Button* button : {&add_, &rename_, &delete_}) {
    button->add_css_class("small");
    button->set_focus_on_click(false);
    row->append(*button);
  }
  add_.set_tooltip_text("Add an organ");
  rename_.set_tooltip_text("Rename the chosen organ");
  delete_.set_tooltip_text("Delete the chosen organ with its contours (Ctrl+Z brings it back)");
  card.append(*row);
  name_popover_.set_parent(*row);
  name_entry_.set_placeholder_text("name, then Enter");
  name_popover_.set_child(name_entry_);
  add_.signal_clicked().connect([this] { NameOrgan(true); });
  rename_.signal_clicked().connect([this] { NameOrgan(false); });
  delete_.signal_clicked().connect([this] {
    if (editor_ == nullptr) return;
    const auto status = editor_->Workspace().Document().DeleteStructure(editor_->Structure());
    if (!status.ok() && editor_->on_error) editor_->on_error(status.error());
    editor_->ChooseStructure(0);
    editor_->Choose({});
    signal_edited_.emit();
  });
  name_entry_.signal_activate().connect([this] {
    if (editor_ == nullptr) return;
    auto& document = editor_->Workspace().Document();
    const std::string name = name_entry_.get_text().raw();
    const auto status = is_naming_new_ ? document.AddStructure(name, kNewOrganTriangles)
                                       : document.RenameStructure(editor_->Structure(), name);
    if (!status.ok()) {
      if (editor_->on_error) editor_->on_error(status.error());
    } else if (is_naming_new_) {
      editor_->ChooseStructure(static_cast<int>(document.Points().structures.size()) - 1);
    }
    name_popover_.popdown();
    signal_edited_.emit();
  });
}

void ContourPanel::NameOrgan(bool is_new) {
  if (editor_ == nullptr) return;
  const auto& structures = editor_->Workspace().Document().Points().structures;
  if (!is_new && structures.empty()) return;
  is_naming_new_ = is_new;
  name_entry_.set_text(is_new ? "" : structures[editor_->Structure()].name);
  name_popover_.popup();
  name_entry_.grab_focus();
}

void ContourPanel::AddSlice() {
  Gtk::Box& card = AddCard(nullptr);
  SetLabel(slice_title_, "card-title");
  SetLabel(slice_text_, "name");
  SetLabel(notes_, "note");
  card.append(slice_title_);
  card.append(slice_text_);
  card.append(notes_);
  auto* row = Gtk::make_managed<Gtk::Box>();
  row->set_spacing(6);
  const auto add = [&](const char* text, const char* tooltip, ContourAction action) {
    auto* button = Gtk::make_managed<Gtk::Button>(text);
    button->add_css_class("small");
    button->set_focus_on_click(false);
    button->set_tooltip_text(tooltip);
    button->signal_clicked().connect([this, action] { signal_action_.emit(action); });
    row->append(*button);
  };
  add("\u25c2 Carry", "Carry the contours to the slice before (Shift+P)", ContourAction::kPropagateBack);
  add("Carry \u25b8", "Carry the contours to the next slice (P)", ContourAction::kPropagateForward);
  add("Hole", "The chosen contour is a hole (H)", ContourAction::kToggleHole);
  add("Clear", "Remove all contours of this organ from the slice (Ctrl+Delete)", ContourAction::kClearSlice);
  card.append(*row);
}

void ContourPanel::AddEdges() {
  Gtk::Box& card = AddCard("Edge search and steps");
  const auto add = [&](const char* name, const char* tooltip, Gtk::Scale& scale, Gtk::Label& value,
                       double low, double high, double step) {
    auto* row = Gtk::make_managed<Gtk::Box>();
    row->set_spacing(6);
    auto* label = Gtk::make_managed<Gtk::Label>(name);
    label->add_css_class("name");
    label->set_size_request(66, -1);
    label->set_xalign(0);
    scale.set_range(low, high);
    scale.set_increments(step, step);
    scale.set_draw_value(false);
    scale.set_hexpand(true);
    scale.set_tooltip_text(tooltip);
    value.add_css_class("value");
    value.set_size_request(58, -1);
    value.set_xalign(1);
    row->append(*label);
    row->append(scale);
    row->append(value);
    card.append(*row);
  };
  add("Reach", "How far a clicked point may move to an edge; 0 leaves points where they were clicked", reach_,
      reach_value_, 0, kMostReach, 0.5);
  add("Skipped",
      "How far the edges of slices that you skip may move the contour between yours when the patient is "
      "built; "
      "0 keeps the shape in between",
      skipped_, skipped_value_, 0, kMostReach, 0.5);
  add("Step", "Slices that Page Up, Page Down and Carry go at once", step_, step_value_, 1, 20, 1);
  reach_.signal_value_changed().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    auto& document = editor_->Workspace().Document();
    if (document.Points().structures.empty()) return;
    auto adaption = document.Points().structures[editor_->Structure()].adaption;
    adaption.max_shift_px = std::round(2 * reach_.get_value()) / 2;
    const auto status = document.SetAdaption(editor_->Structure(), adaption);
    if (!status.ok() && editor_->on_error) editor_->on_error(status.error());
    signal_edited_.emit();
  });
  skipped_.signal_value_changed().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    auto& document = editor_->Workspace().Document();
    if (document.Points().structures.empty()) return;
    auto adaption = document.Points().structures[editor_->Structure()].adaption;
    adaption.skipped_shift_px = std::round(2 * skipped_.get_value()) / 2;
    const auto status = document.SetAdaption(editor_->Structure(), adaption);
    if (!status.ok() && editor_->on_error) editor_->on_error(status.error());
    signal_edited_.emit();
  });
  step_.signal_value_changed().connect([this] {
    if (is_showing_ || editor_ == nullptr) return;
    editor_->SetSliceStep(static_cast<int>(std::lround(step_.get_value())));
    signal_edited_.emit();
  });
}

void ContourPanel::AddSurface() {
  Gtk::Box& card = AddCard("Surface (preview)", true);
  view_.set_vexpand(true);
  view_.set_hexpand(true);
  card.append(view_);
  SetLabel(mesh_text_, "stage");
  mesh_text_.set_tooltip_text(
      "A preview; the last number is the distance of the lattice it was made on. Build patient makes the "
      "finer one");
  card.append(mesh_text_);
  auto* row = Gtk::make_managed<Gtk::Box>();
  row->set_spacing(8);
  progress_.set_hexpand(true);
  progress_.set_valign(Gtk::Align::CENTER);
  cancel_.add_css_class("small");
  cancel_.set_focus_on_click(false);
  cancel_.set_tooltip_text("Give up the surfaces that are being made; the next change makes them again");
  cancel_.signal_clicked().connect([this] { signal_cancel_.emit(); });
  row->append(progress_);
  row->append(cancel_);
  card.append(*row);
  ShowJob({});
}

void ContourPanel::SetEditor(ContourEditor* editor) {
  editor_ = editor;
  organs_shown_.clear();
  ClearMeshes();
  Refresh();
}

void ContourPanel::Refresh() {
  if (editor_ == nullptr) return;
  is_showing_ = true;
  RefreshOrgans();
  RefreshSlice();
  const auto& structures = editor_->Workspace().Document().Points().structures;
  const bool has_organ = !structures.empty();
  for (Gtk::Button* button : {&rename_, &delete_}) button->set_sensitive(has_organ);
  reach_.set_sensitive(has_organ);
  skipped_.set_sensitive(has_organ);
  char text[32];
  if (has_organ) {
    const double reach = structures[editor_->Structure()].adaption.max_shift_px;
    reach_.set_value(reach);
    std::snprintf(text, sizeof(text), "%g px", reach);
    SetText(reach_value_, text);
    const double skipped = structures[editor_->Structure()].adaption.skipped_shift_px;
    skipped_.set_value(skipped);
    std::snprintf(text, sizeof(text), "%g px", skipped);
    SetText(skipped_value_, text);
  }
  step_.set_value(editor_->SliceStep());
  SetText(step_value_,
          std::to_string(editor_->SliceStep()) + (editor_->SliceStep() == 1 ? " slice" : " slices"));
  is_showing_ = false;
}

void ContourPanel::RefreshOrgans() {
  const auto& document = editor_->Workspace().Document();
  const auto& structures = document.Points().structures;
  // rows are made anew only when something in them changes
  std::string shown = std::to_string(editor_->Structure());
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    shown += "\n" + structures[s].name + " " + std::to_string(document.ContouredSlices(s).size());
  }
  if (shown == organs_shown_) return;
  organs_shown_ = shown;
  while (Gtk::Widget* child = organs_.get_first_child()) organs_.remove(*child);
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    auto* button = Gtk::make_managed<Gtk::ToggleButton>();
    button->add_css_class("organ");
    button->set_focus_on_click(false);
    button->set_active(s == editor_->Structure());
    auto* row = Gtk::make_managed<Gtk::Box>();
    row->set_spacing(8);
    auto* swatch = Gtk::make_managed<Gtk::Label>();
    swatch->set_markup("<span foreground=\"" + HexColour(OrganColour(structures[s].name, s)) +
                       "\">\u25cf</span>");
    auto* name = Gtk::make_managed<Gtk::Label>(structures[s].name);
    name->set_ellipsize(Pango::EllipsizeMode::END);
    name->set_hexpand(true);
    name->set_xalign(0);
    const std::size_t count = document.ContouredSlices(s).size();
    auto* slices = Gtk::make_managed<Gtk::Label>(std::to_string(count) + (count == 1 ? " slice" : " slices"));
    slices->add_css_class("fine");
    row->append(*swatch);
    row->append(*name);
    row->append(*slices);
    button->set_child(*row);
    button->signal_clicked().connect([this, s] {
      editor_->ChooseStructure(s);
      organs_shown_.clear();  // a click on the chosen one has released its button
      signal_edited_.emit();
    });
    organs_.append(*button);
  }
}

void ContourPanel::RefreshSlice() {
  SetText(slice_title_, SliceTitle(*editor_));
  SetText(slice_text_, SliceText(*editor_));
  SetText(notes_, SliceNotes(*editor_));
}

void ContourPanel::SetMesh(int structure, contours::OrganMesh mesh) {
  problems_.erase(structure);
  meshes_[structure] = std::move(mesh);
  ShowSurfaces();
}

void ContourPanel::SetMeshProblem(int structure, const std::string& problem) {
  meshes_.erase(structure);
  problems_[structure] = problem;
  ShowSurfaces();
}

void ContourPanel::ClearMeshes() {
  meshes_.clear();
  problems_.clear();
  ShowSurfaces();
}

void ContourPanel::ShowSurfaces() {
  std::vector<render::FigureSurface> surfaces;
  if (editor_ != nullptr) {
    const auto& points = editor_->Workspace().Document().Points();
    const auto directions = contours::AxisDirections(points);
    constexpr double kMmPerM = 1000.0;
    // a frame of the pictures that is left-handed in the body turns its triangles
    const auto& [a, b, c] = directions;
    const double handedness = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                              a[2] * (b[0] * c[1] - b[1] * c[0]);
    for (const auto& [structure, organ] : meshes_) {
      if (structure >= static_cast<int>(points.structures.size())) continue;
      render::FigureSurface surface;
      surface.triangles = organ.mesh.triangles;
      if (handedness < 0) {
        for (auto& t : surface.triangles) std::swap(t[1], t[2]);
      }
      for (const auto& p : organ.mesh.positions) {
        math::Vec3 world;
        for (int axis = 0; axis < 3; ++axis) {
          world[axis] =
              (p.x * directions[0][axis] + p.y * directions[1][axis] + p.z * directions[2][axis]) / kMmPerM;
        }
        surface.positions.push_back(world);
      }
      const Colour3 colour = OrganColour(points.structures[structure].name, structure);
      surface.colours = {{colour[0], colour[1], colour[2]}};
      surfaces.push_back(std::move(surface));
    }
  }
  // a new organ may lie where the camera does not look
  const bool has_more = surfaces.size() > shown_surfaces_;
  shown_surfaces_ = surfaces.size();
  view_.SetSurfaces(std::move(surfaces));
  if (has_more) view_.LookFrom(render::Viewpoint::kAnterior);
  ShowMeshText();
}

void ContourPanel::ShowMeshText() {
  std::string text;
  if (editor_ != nullptr) {
    const auto& structures = editor_->Workspace().Document().Points().structures;
    for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
      const auto mesh = meshes_.find(s);
      const auto problem = problems_.find(s);
      if (mesh == meshes_.end() && (problem == problems_.end() || problem->second.empty())) continue;
      if (!text.empty()) text += "\n";
      text += mesh != meshes_.end() ? MeshText(structures[s].name, mesh->second) : problem->second;
    }
  }
  SetText(mesh_text_, text);
}

void ContourPanel::ShowJob(const contours::MeshJob::State& state) {
  progress_.set_fraction(state.is_busy ? state.fraction : 0);
  progress_.set_opacity(state.is_busy ? 1 : 0);
  cancel_.set_opacity(state.is_busy ? 1 : 0);
  cancel_.set_sensitive(state.is_busy);
}

}  // namespace trocar::app
