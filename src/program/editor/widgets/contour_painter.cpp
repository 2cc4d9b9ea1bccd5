// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_painter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "trocar/editor/organ_colour.h"

namespace trocar::editor {

using math::Vec2;

namespace {

using CairoContext = Cairo::RefPtr<Cairo::Context>;
using contours::FitNote;

constexpr render::SrgbColour kClicked{0.98, 0.30, 0.26}, kAdapted{1.00, 0.85, 0.20},
    kSpline{0.30, 0.95, 0.45};
constexpr render::SrgbColour kReference{0.35, 0.85, 1.00}, kWarning{1.00, 0.62, 0.15};
constexpr double kNearestZoom = 6;  // beyond it, pixels are shown as they are
constexpr int kFarthestGhost = 16;  // slices

void SetColour(const CairoContext& cairo, const render::SrgbColour& c, double alpha = 1) {
  cairo->set_source_rgba(c[0], c[1], c[2], alpha);
}

void AddPath(const CairoContext& cairo, const ContourEditor& editor, std::span<const Vec2> points,
             bool is_closed) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 at = ToCanvas(editor.view, editor.size, points[i]);
    if (i == 0) {
      cairo->move_to(at.x, at.y);
    } else {
      cairo->line_to(at.x, at.y);
    }
  }
  if (is_closed && !points.empty()) cairo->close_path();
}

/// A line with a dark border, readable on any picture.
void StrokeOutlined(const CairoContext& cairo, const render::SrgbColour& colour, double width,
                    double alpha = 1) {
  cairo->set_line_width(width + 1.6);
  cairo->set_source_rgba(0, 0, 0, 0.55 * alpha);
  cairo->stroke_preserve();
  cairo->set_line_width(width);
  SetColour(cairo, colour, alpha);
  cairo->stroke();
}

void Disc(const CairoContext& cairo, const Vec2& at, double radius, const render::SrgbColour& colour) {
  cairo->begin_new_sub_path();
  cairo->arc(at.x, at.y, radius, 0, 2 * M_PI);
  SetColour(cairo, colour);
  cairo->fill_preserve();
  cairo->set_line_width(1.2);
  cairo->set_source_rgba(0, 0, 0, 0.75);
  cairo->stroke();
}

void Square(const CairoContext& cairo, const Vec2& at, double half, const render::SrgbColour& colour) {
  cairo->rectangle(at.x - half, at.y - half, 2 * half, 2 * half);
  SetColour(cairo, colour);
  cairo->fill_preserve();
  cairo->set_line_width(1.2);
  cairo->set_source_rgba(0, 0, 0, 0.75);
  cairo->stroke();
}

void TextOutlined(const CairoContext& cairo, double x, double y, const std::string& text,
                  const render::SrgbColour& colour) {
  cairo->move_to(x, y);
  cairo->text_path(text);
  cairo->set_line_join(Cairo::Context::LineJoin::ROUND);
  cairo->set_line_width(3);
  cairo->set_source_rgba(0, 0, 0, 0.7);
  cairo->stroke_preserve();
  SetColour(cairo, colour);
  cairo->fill();
}

Cairo::RefPtr<Cairo::ImageSurface> MakeSurface(const images::ColorImage& image) {
  auto surface = Cairo::ImageSurface::create(Cairo::Surface::Format::RGB24, image.width, image.height);
  surface->flush();
  unsigned char* data = surface->get_data();
  const int stride = surface->get_stride();
  for (int y = 0; y < image.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    const std::uint8_t* from = image.At(0, y);
    for (int x = 0; x < image.width; ++x, from += 3) {
      row[x] = static_cast<std::uint32_t>(from[0]) << 16 | static_cast<std::uint32_t>(from[1]) << 8 | from[2];
    }
  }
  surface->mark_dirty();
  return surface;
}

}  // namespace

base::Status ContourPainter::Paint(const CairoContext& cairo, ContourEditor& editor,
                                   const PaintOptions& options, int scale) {
  cairo->set_source_rgb(0, 0, 0);
  cairo->paint();
  const base::Status status = PreparePicture(editor, options);
  if (status.ok()) PaintPicture(cairo, editor, scale);
  if (options.has_reference) PaintReference(cairo, editor);
  if (options.has_ghosts) PaintGhosts(cairo, editor);
  const int count = static_cast<int>(editor.Workspace().Document().Points().structures.size());
  for (int s = 0; s < count; ++s) {
    if (s != editor.Structure()) PaintOrgan(cairo, editor, options, s);
  }
  if (count > 0) PaintOrgan(cairo, editor, options, editor.Structure());
  PaintOpen(cairo, editor);
  PaintMargins(cairo, editor);
  return status;
}

base::Status ContourPainter::PreparePicture(ContourEditor& editor, const PaintOptions& options) {
  auto& workspace = editor.Workspace();
  const auto& suggested = workspace.Series().suggested_window;
  const bool is_suggested = workspace.Series().is_color || (options.window.centre == suggested.centre &&
                                                            options.window.width == suggested.width);
  const bool is_same_window = is_suggested || (options.window.centre == picture_window_.centre &&
                                               options.window.width == picture_window_.width);
  if (picture_ && picture_slice_ == editor.Slice() && is_same_window &&
      (picture_window_.width == 0) == is_suggested) {
    return {};
  }
  picture_.reset();
  scaled_picture_.reset();
  if (is_suggested) {
    const auto image = workspace.Picture(editor.Slice());
    if (!image.ok()) return image.error();
    picture_ = MakeSurface(**image);
  } else {
    const auto image = workspace.PictureInWindow(editor.Slice(), options.window);
    if (!image.ok()) return image.error();
    picture_ = MakeSurface(*image);
  }
  picture_slice_ = editor.Slice();
  picture_window_ = is_suggested ? images::DisplayWindow{0, 0} : options.window;
  return {};
}

void ContourPainter::PaintPicture(const CairoContext& cairo, const ContourEditor& editor, int scale) {
  const int width = static_cast<int>(std::ceil(editor.size.width * scale));
  const int height = static_cast<int>(std::ceil(editor.size.height * scale));
  if (!scaled_picture_ || scaled_view_ != editor.view || scaled_width_ != width || scaled_height_ != height) {
    ++scaled_;
    scaled_picture_ = Cairo::ImageSurface::create(Cairo::Surface::Format::RGB24, width, height);
    const auto canvas = Cairo::Context::create(scaled_picture_);
    const Vec2 corner = ToCanvas(editor.view, editor.size, {-0.5, -0.5});
    canvas->scale(scale, scale);
    canvas->translate(corner.x, corner.y);
    canvas->scale(editor.view.is_mirrored_x ? -editor.view.zoom : editor.view.zoom,
                  editor.view.is_mirrored_y ? -editor.view.zoom : editor.view.zoom);
    const auto pattern = Cairo::SurfacePattern::create(picture_);
    pattern->set_filter(editor.view.zoom * scale >= kNearestZoom ? Cairo::SurfacePattern::Filter::NEAREST
                                                                 : Cairo::SurfacePattern::Filter::BILINEAR);
    canvas->set_source(pattern);
    canvas->paint();
    scaled_view_ = editor.view;
    scaled_width_ = width, scaled_height_ = height;
  }
  cairo->save();
  cairo->scale(1.0 / scale, 1.0 / scale);
  cairo->set_source(scaled_picture_, 0, 0);
  cairo->paint();
  cairo->restore();
}

void ContourPainter::PaintReference(const CairoContext& cairo, ContourEditor& editor) {
  if (reference_slice_ != editor.Slice()) {
    reference_ = editor.Workspace().FindReference(editor.Slice());
    reference_slice_ = editor.Slice();
  }
  cairo->set_line_width(1.4);
  SetColour(cairo, kReference, 0.85);
  for (const auto& label : reference_) {
    for (const auto& line : label.lines) AddPath(cairo, editor, line, false);
  }
  cairo->stroke();
}

void ContourPainter::PaintGhosts(const CairoContext& cairo, ContourEditor& editor) {
  auto& workspace = editor.Workspace();
  const int structure = editor.Structure();
  if (structure >= static_cast<int>(workspace.Document().Points().structures.size())) return;
  for (const int direction : {-1, 1}) {
    const auto slice = editor.FindContoured(direction);
    if (!slice || std::abs(*slice - editor.Slice()) > kFarthestGhost) continue;
    const auto fit = workspace.Fit(structure, *slice);
    if (!fit.ok()) continue;
    for (const auto* group : {&(*fit)->contours, &(*fit)->holes}) {
      for (const auto& contour : *group) AddPath(cairo, editor, contour->spline, true);
    }
    cairo->set_line_width(1.1);
    cairo->set_dash(direction < 0 ? std::vector<double>{6, 4} : std::vector<double>{1.5, 4}, 0);
    cairo->set_source_rgba(1, 1, 1, 0.55);
    cairo->stroke();
    cairo->unset_dash();
  }
}

void ContourPainter::PaintOrgan(const CairoContext& cairo, ContourEditor& editor, const PaintOptions& options,
                                int structure) {
  auto& workspace = editor.Workspace();
  const auto& organ = workspace.Document().Points().structures[structure];
  const bool is_chosen = structure == editor.Structure();
  const auto fit = is_chosen ? editor.Fit() : workspace.Fit(structure, editor.Slice());
  if (!fit.ok() || (*fit)->contours.empty()) return;
  const render::SrgbColour colour = OrganColour(organ.name, structure);
  const auto add_all = [&] {
    for (const auto* group : {&(*fit)->contours, &(*fit)->holes}) {
      for (const auto& contour : *group) AddPath(cairo, editor, contour->spline, true);
    }
  };
  if (options.has_fill) {
    // contours united, then the holes cut out: a group keeps what lies under it
    cairo->push_group();
    SetColour(cairo, colour, 1);
    for (const auto& contour : (*fit)->contours) {
      AddPath(cairo, editor, contour->spline, true);
      cairo->fill();
    }
    if (!(*fit)->holes.empty()) {
      cairo->set_operator(Cairo::Context::Operator::CLEAR);
      for (const auto& hole : (*fit)->holes) {
        AddPath(cairo, editor, hole->spline, true);
        cairo->fill();
      }
    }
    cairo->pop_group_to_source();
    cairo->paint_with_alpha(is_chosen ? 0.30 : 0.18);
  }
  add_all();
  if (is_chosen) {
    StrokeOutlined(cairo, kSpline, 1.8);
  } else {
    StrokeOutlined(cairo, colour, 1.3, 0.85);
  }
  if (is_chosen && options.has_points) PaintPoints(cairo, editor, **fit);
}

void ContourPainter::PaintPoints(const CairoContext& cairo, ContourEditor& editor,
                                 const contours::SliceFit& fit) {
  const auto& here = editor.Here();
  const auto on_canvas = [&](const Vec2& p) { return ToCanvas(editor.view, editor.size, p); };
  // seen from far, points must not hide the curve
  const double size = std::clamp(0.45 + 0.3 * editor.view.zoom, 0.6, 1.0);
  for (const bool is_hole : {false, true}) {
    const auto& polygons = is_hole ? here.holes : here.contours;
    const auto& fits = is_hole ? fit.holes : fit.contours;
    for (std::size_t c = 0; c < fits.size(); ++c) {
      const auto& stages = *fits[c];
      for (const FitNote& note : stages.notes) {
        // the part of the curve around its middle
        const auto& curve = stages.spline;
        std::size_t middle = 0;
        for (std::size_t i = 1; i < curve.size(); ++i) {
          if (Norm(curve[i] - note.at) < Norm(curve[middle] - note.at)) middle = i;
        }
        std::vector<Vec2> part{curve[middle]};
        for (const int way : {-1, 1}) {
          double left = 0.5 * note.length_px;
          std::size_t i = middle;
          for (std::size_t steps = 0; left > 0 && steps < curve.size() / 2; ++steps) {
            const std::size_t next = (i + curve.size() + static_cast<std::size_t>(way)) % curve.size();
            left -= Norm(curve[next] - curve[i]);
            i = next;
            part.insert(way < 0 ? part.begin() : part.end(), curve[i]);
          }
        }
        AddPath(cairo, editor, part, false);
        cairo->set_line_width(3.2);
        SetColour(cairo, kWarning, 0.95);
        cairo->stroke();
      }
      for (const Vec2& p : stages.inserted) Disc(cairo, on_canvas(p), 1.8 * size, kAdapted);
      for (std::size_t i = 0; i < polygons[c].size(); ++i) {
        const Vec2 from = on_canvas(polygons[c][i]), to = on_canvas(stages.adapted[i]);
        cairo->move_to(from.x, from.y);
        cairo->line_to(to.x, to.y);
        cairo->set_line_width(1.2);
        SetColour(cairo, kAdapted, 0.9);
        cairo->stroke();
        Disc(cairo, to, 3.4 * size, kAdapted);
        Square(cairo, from, 2.4 * size, kClicked);
      }
      const auto& choice = editor.Choice();
      const contours::ContourId id{editor.Structure(), editor.Slice(), is_hole, static_cast<int>(c)};
      if (choice && choice->id == id && choice->point && *choice->point < polygons[c].size()) {
        const Vec2 at = on_canvas(polygons[c][*choice->point]);
        cairo->begin_new_sub_path();
        cairo->arc(at.x, at.y, 8, 0, 2 * M_PI);
        StrokeOutlined(cairo, {1, 1, 1}, 1.8);
      }
    }
  }
}

void ContourPainter::PaintOpen(const CairoContext& cairo, ContourEditor& editor) {
  const auto& open = editor.Here().open;
  if (open.empty()) return;
  AddPath(cairo, editor, open, false);
  StrokeOutlined(cairo, kClicked, 1.8);
  const std::vector<Vec2> rubber = editor.RubberLine();
  if (rubber.size() > 1) {
    AddPath(cairo, editor, rubber, false);
    cairo->set_line_width(1.6);
    SetColour(cairo, editor.IsScissors() ? kAdapted : kClicked, 0.95);
    if (!editor.IsScissors()) cairo->set_dash(std::vector<double>{5, 4}, 0);
    cairo->stroke();
    cairo->unset_dash();
  }
  for (const Vec2& p : open) Square(cairo, ToCanvas(editor.view, editor.size, p), 2.8, kClicked);
  // the first point closes
  if (open.size() >= 3) {
    const Vec2 first = ToCanvas(editor.view, editor.size, open.front());
    cairo->begin_new_sub_path();
    cairo->arc(first.x, first.y, 8, 0, 2 * M_PI);
    StrokeOutlined(cairo, kClicked, 1.8);
  }
}

void ContourPainter::PaintMargins(const CairoContext& cairo, const ContourEditor& editor) {
  const auto& info = editor.Workspace().Series();
  const double width = editor.size.width, height = editor.size.height;
  const EdgeLetters letters = FindEdgeLetters(editor.view, info.axes);
  cairo->select_font_face("sans-serif", Cairo::ToyFontFace::Slant::NORMAL, Cairo::ToyFontFace::Weight::BOLD);
  cairo->set_font_size(19);
  const render::SrgbColour white{0.95, 0.97, 0.98};
  const auto letter = [&](double x, double y, const std::string& text) {
    Cairo::TextExtents extents;
    cairo->get_text_extents(text, extents);
    TextOutlined(cairo, x - 0.5 * extents.width, y + 0.5 * extents.height, text, white);
  };
  letter(18, 0.5 * height, letters.left);
  letter(width - 18, 0.5 * height, letters.right);
  letter(0.5 * width, 20, letters.top);
  letter(0.5 * width, height - 20, letters.bottom);

  const double bar_mm = ChooseScaleBar(editor.view.zoom, info.pixel_mm, 130);
  const double length = bar_mm / info.pixel_mm * editor.view.zoom;
  const double x = width - 24 - length, y = height - 22;
  for (const bool is_outline : {true, false}) {
    cairo->set_line_width(is_outline ? 5 : 2);
    cairo->set_source_rgba(is_outline ? 0 : 0.95, is_outline ? 0 : 0.97, is_outline ? 0 : 0.98,
                           is_outline ? 0.6 : 1);
    cairo->move_to(x, y - 5);
    cairo->line_to(x, y);
    cairo->line_to(x + length, y);
    cairo->line_to(x + length, y - 5);
    cairo->stroke();
  }
  char text[32];
  if (bar_mm >= 10) {
    std::snprintf(text, sizeof(text), "%g cm", bar_mm / 10);
  } else {
    std::snprintf(text, sizeof(text), "%g mm", bar_mm);
  }
  cairo->select_font_face("sans-serif", Cairo::ToyFontFace::Slant::NORMAL,
                          Cairo::ToyFontFace::Weight::NORMAL);
  cairo->set_font_size(12);
  Cairo::TextExtents extents;
  cairo->get_text_extents(text, extents);
  TextOutlined(cairo, x + 0.5 * (length - extents.width), y - 9, text, white);
}

}  // namespace trocar::editor
