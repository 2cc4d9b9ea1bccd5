// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/cairo_drawing.h"

#include <array>
#include <cmath>
#include <numbers>

#include "cairo_text.h"
#include "palette.h"

namespace trocar::report {
namespace {

std::uint32_t On(Ground ground, TwoColours colours) {
  return ground == Ground::kLight ? colours.light : colours.dark;
}

void Trace(cairo_t* cairo, const std::vector<math::Vec2>& points) {
  bool is_down = false;
  for (const math::Vec2& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      is_down = false;
    } else if (is_down) {
      cairo_line_to(cairo, point.x, point.y);
    } else {
      cairo_move_to(cairo, point.x, point.y);
      is_down = true;
    }
  }
}

void Draw(cairo_t* cairo, const Line& line, Ground ground) {
  const std::array<double, 2> dashed = {6, 4}, dotted = {1.5, 3};
  if (line.dash != Dash::kSolid)
    cairo_set_dash(cairo, line.dash == Dash::kDashed ? dashed.data() : dotted.data(), 2, 0);
  cairo_set_line_width(cairo, line.width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  SetColour(cairo, On(ground, ColoursOf(line.ink)));
  Trace(cairo, line.points);
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

void Draw(cairo_t* cairo, const Area& area, Ground ground) {
  Trace(cairo, area.points);
  cairo_close_path(cairo);
  SetColour(cairo, On(ground, ColoursOf(area.ink)), area.opacity);
  cairo_fill(cairo);
}

void Draw(cairo_t* cairo, const Mark& mark, Ground ground) {
  if (mark.kind == MarkKind::kDot) {
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, mark.at.x, mark.at.y, mark.radius, 0, 2 * std::numbers::pi);
  } else {
    Trace(cairo, MakeMarkOutline(mark));
    cairo_close_path(cairo);
  }
  SetColour(cairo, On(ground, ColoursOf(mark.ink)));
  cairo_fill_preserve(cairo);
  SetColour(cairo, On(ground, kPaper));
  cairo_set_line_width(cairo, 1);
  cairo_stroke(cairo);
}

void Draw(cairo_t* cairo, const Label& label, Ground ground) {
  const LayoutOwner layout = MakeLayout(cairo, label.text, 0, {label.size, 0, label.is_bold, Anchor::kStart});
  int width = 0, height = 0;
  pango_layout_get_size(layout.get(), &width, &height);
  const double length = static_cast<double>(width) / PANGO_SCALE;
  const double back = label.anchor == Anchor::kStart    ? 0
                      : label.anchor == Anchor::kMiddle ? length / 2
                                                        : length;
  cairo_save(cairo);
  cairo_translate(cairo, label.at.x, label.at.y);
  if (label.is_upward) cairo_rotate(cairo, -std::numbers::pi / 2);
  cairo_move_to(cairo, -back, -static_cast<double>(pango_layout_get_baseline(layout.get())) / PANGO_SCALE);
  SetColour(cairo, On(ground, ColoursOf(label.ink)));
  pango_cairo_show_layout(cairo, layout.get());
  cairo_restore(cairo);
}

}  // namespace

void PaintDrawing(cairo_t& cairo, const Drawing& drawing, Ground ground) {
  for (const Shape& shape : drawing.shapes)
    std::visit([&](const auto& one) { Draw(&cairo, one, ground); }, shape);
}

}  // namespace trocar::report
