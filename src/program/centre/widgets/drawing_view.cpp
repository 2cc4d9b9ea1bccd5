// SPDX-License-Identifier: Apache-2.0
#include "drawing_view.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "trocar/report/cairo_drawing.h"

namespace trocar::centre {
namespace {

constexpr double kReach = 3;  // of the pointer around a mark [pixels]

}  // namespace

DrawingView::DrawingView(int width) : width_(width) {
  add_css_class("plot");
  set_draw_func(sigc::mem_fun(*this, &DrawingView::Draw));
  set_has_tooltip(true);
  signal_query_tooltip().connect(
      [this](int x, int y, bool, const Glib::RefPtr<Gtk::Tooltip>& tip) { return QueryTip(x, y, tip); },
      false);
}

void DrawingView::Show(const report::Drawing& drawing) {
  drawing_ = drawing;
  set_content_width(width_);
  set_content_height(static_cast<int>(std::lround(width_ * drawing.height / drawing.width)));
  // what it shows, for who cannot see it
  Glib::Value<Glib::ustring> text;
  text.init(Glib::Value<Glib::ustring>::value_type());
  text.set(drawing.title + ". " + drawing.description);
  update_property(Gtk::Accessible::Property::LABEL, text);
  queue_draw();
}

double DrawingView::Scale() const {
  return std::min(get_width() / drawing_.width, get_height() / drawing_.height);
}

void DrawingView::Draw(const Cairo::RefPtr<Cairo::Context>& cairo, int, int) const {
  if (drawing_.width <= 0) return;
  const double scale = Scale();
  cairo->scale(scale, scale);
  report::PaintDrawing(*cairo->cobj(), drawing_, report::Ground::kDark);
}

bool DrawingView::QueryTip(int x, int y, const Glib::RefPtr<Gtk::Tooltip>& tip) {
  if (drawing_.width <= 0) return false;
  const double scale = Scale();
  for (auto shape = drawing_.shapes.rbegin(); shape != drawing_.shapes.rend(); ++shape) {
    const auto* mark = std::get_if<report::Mark>(&*shape);
    if (mark == nullptr || mark->tip.empty()) continue;
    if (std::hypot(x - scale * mark->at.x, y - scale * mark->at.y) > scale * mark->radius + kReach) continue;
    tip->set_text(mark->tip);
    return true;
  }
  return false;
}

}  // namespace trocar::centre
