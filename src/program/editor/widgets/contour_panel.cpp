// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_panel.h"

#include <utility>

namespace trocar::editor {
namespace {

constexpr int kPanelWidth = 340;

}  // namespace

ContourPanel::ContourPanel() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  set_size_request(kPanelWidth, -1);
  set_hexpand(false);
  add_css_class("panel");
  set_spacing(7);
  set_margin(8);
  for (Gtk::Widget* card : {static_cast<Gtk::Widget*>(&organs_), static_cast<Gtk::Widget*>(&slice_),
                            static_cast<Gtk::Widget*>(&edges_), static_cast<Gtk::Widget*>(&surface_)})
    append(*card);
}

void ContourPanel::Show(const ContourPanelPage& page) {
  organs_.Show(page.organs);
  slice_.Show(page);
  edges_.Show(page);
}

void ContourPanel::ShowSurfaces(std::vector<render::FigureSurface> surfaces, bool is_fit_wanted) {
  surface_.View().SetSurfaces(std::move(surfaces));
  if (is_fit_wanted) surface_.View().LookFrom(render::Viewpoint::kAnterior);
}

}  // namespace trocar::editor
