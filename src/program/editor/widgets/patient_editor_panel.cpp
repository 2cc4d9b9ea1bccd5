// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_editor_panel.h"

#include <iterator>

#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr int kPanelWidth = 330;  // [pixels]

struct ToolText {
  const char *name, *tip;
};
constexpr ToolText kTools[] = {
    {host::Mark("Look"), host::Mark("Turn and look (1)")},
    {host::Mark("Regions"),
     host::Mark("Paint where the liver is held and where the gallbladder grows on it (2)")},
    {host::Mark("Ducts"), host::Mark("Move, insert and delete points of ducts and arteries (3)")},
    {host::Mark("Landmarks"), host::Mark("Move landmarks (4)")}};

}  // namespace

PatientEditorPanel::PatientEditorPanel() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("panel");
  set_spacing(8);
  set_margin(10);
  set_size_request(kPanelWidth, -1);
  set_hexpand(false);
  AddTools();
  for (Gtk::Widget* card : {static_cast<Gtk::Widget*>(&paint_), static_cast<Gtk::Widget*>(&tubes_),
                            static_cast<Gtk::Widget*>(&landmarks_), static_cast<Gtk::Widget*>(&look_),
                            static_cast<Gtk::Widget*>(&findings_)})
    append(*card);
}

void PatientEditorPanel::AddTools() {
  Gtk::Box& row = gui::MakeRow(0, {});
  row.add_css_class("linked");
  row.set_homogeneous(true);
  for (std::size_t i = 0; i < std::size(kTools); ++i) {
    auto* button = Gtk::make_managed<Gtk::ToggleButton>(host::Translate(kTools[i].name));
    button->set_tooltip_text(host::Translate(kTools[i].tip));
    button->set_focus_on_click(false);
    if (!tools_.empty()) button->set_group(*tools_.front());
    button->signal_toggled().connect([this, button, i] {
      if (!is_showing_ && button->get_active()) presenter_.ChooseTool(static_cast<EditorTool>(i));
    });
    tools_.push_back(button);
    row.append(*button);
  }
  append(row);
}

void PatientEditorPanel::Show(const PatientPanelPage& page) {
  const Showing showing(is_showing_);
  tools_[static_cast<std::size_t>(page.tool)]->set_active(true);
  paint_.Show(page);
  tubes_.Show(page);
  landmarks_.Show(page);
  look_.Show(page);
}

void PatientEditorPanel::OnEdited() {
  if (is_edit_due_) return;
  is_edit_due_ = true;
  // the lists are made anew, which must not happen within their own signals
  Glib::signal_timeout().connect_once(sigc::mem_fun(*this, &PatientEditorPanel::EmitEdited), 0);
}

void PatientEditorPanel::EmitEdited() {
  is_edit_due_ = false;
  signal_edited_.emit();
}

}  // namespace trocar::editor
