// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_slice_bar.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/editor/organ_colour.h"
#include "trocar/host/translate.h"

namespace trocar::editor {
namespace {

constexpr double kBorder = 34;  // left and right, where the first and last numbers stand [pixels]
constexpr int kHeight = 40;

}  // namespace

ContourSliceBar::ContourSliceBar() {
  set_content_height(kHeight);
  set_hexpand(true);
  set_tooltip_text(host::Translate("Slices; marks show where contours are. Click or drag to go there"));
  set_draw_func(sigc::mem_fun(*this, &ContourSliceBar::Draw));
  const auto drag = Gtk::GestureDrag::create();
  drag->signal_drag_begin().connect([this](double x, double) { Go(x); });
  drag->signal_drag_update().connect([this, gesture = drag.get()](double dx, double) {
    double x = 0, y = 0;
    gesture->get_start_point(x, y);
    Go(x + dx);
  });
  add_controller(drag);
}

void ContourSliceBar::SetEditor(ContourEditor* editor) {
  editor_ = editor;
  queue_draw();
}

double ContourSliceBar::PlaceOf(int slice, int width) const {
  const auto& slices = editor_->Workspace().Slices();
  const double range = std::max(1, slices.back() - slices.front());
  return kBorder + (width - 2 * kBorder) * (slice - slices.front()) / range;
}

void ContourSliceBar::Go(double x) {
  if (editor_ == nullptr) return;
  const auto& slices = editor_->Workspace().Slices();
  const double part = std::clamp((x - kBorder) / std::max(1.0, get_width() - 2 * kBorder), 0.0, 1.0);
  signal_slice_.emit(static_cast<int>(std::lround(slices.front() + part * (slices.back() - slices.front()))));
}

void ContourSliceBar::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int width, int height) {
  if (editor_ == nullptr) return;
  const auto& workspace = editor_->Workspace();
  const auto& slices = workspace.Slices();
  const auto& structures = workspace.Document().Points().structures;
  const double middle = 0.62 * height;
  cairo->set_source_rgb(0.20, 0.23, 0.27);
  cairo->rectangle(kBorder, middle - 2, width - 2 * kBorder, 4);
  cairo->fill();
  // one row of marks an organ, the chosen one on top
  const int count = static_cast<int>(structures.size());
  for (int s = 0; s < count; ++s) {
    const bool is_chosen = s == editor_->Structure();
    const render::SrgbColour colour = OrganColour(structures[s].name, s);
    cairo->set_source_rgba(colour[0], colour[1], colour[2], is_chosen ? 1.0 : 0.55);
    for (const auto& content : structures[s].slices) {
      if (content.contours.empty() && content.open.empty()) continue;
      const double x = PlaceOf(content.slice, width);
      if (is_chosen) {
        cairo->rectangle(x - 1.25, middle - 10, 2.5, 10);
      } else {
        cairo->rectangle(x - 1, middle + 3, 2, 6);
      }
    }
    cairo->fill();
  }
  const double x = PlaceOf(editor_->Slice(), width);
  cairo->begin_new_sub_path();
  cairo->arc(x, middle, 7, 0, 2 * M_PI);
  cairo->set_source_rgb(0.90, 0.93, 0.95);
  cairo->fill_preserve();
  cairo->set_line_width(2);
  cairo->set_source_rgb(0.17, 0.61, 0.69);
  cairo->stroke();

  cairo->select_font_face("sans-serif", Cairo::ToyFontFace::Slant::NORMAL,
                          Cairo::ToyFontFace::Weight::NORMAL);
  cairo->set_font_size(12);
  const auto write = [&](double at, double y, const std::string& text, double grey) {
    Cairo::TextExtents extents;
    cairo->get_text_extents(text, extents);
    cairo->set_source_rgb(grey, grey + 0.02, grey + 0.04);
    cairo->move_to(std::clamp(at - 0.5 * extents.width, 2.0, width - extents.width - 4), y);
    cairo->show_text(text);
  };
  write(0.5 * kBorder, middle + 4, std::to_string(slices.front()), 0.58);
  write(width - 0.5 * kBorder, middle + 4, std::to_string(slices.back()), 0.58);
  cairo->select_font_face("sans-serif", Cairo::ToyFontFace::Slant::NORMAL, Cairo::ToyFontFace::Weight::BOLD);
  write(x, middle - 13, std::to_string(editor_->Slice()), 0.94);
}

}  // namespace trocar::editor
