// SPDX-License-Identifier: Apache-2.0
#include "pdf_canvas.h"

#include <cairo-pdf.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "shown_text.h"

namespace trocar::report {
namespace {

// Pango takes the first that is installed; DejaVu Sans comes with Trocar's packages
constexpr const char* kFamilies = "Inter,DejaVu Sans,sans-serif";
constexpr int kSemiBold = 600;

template <auto free_function>
struct Deleter {
  template <typename T>
  void operator()(T* object) const {
    free_function(object);
  }
};
using LayoutOwner = std::unique_ptr<PangoLayout, Deleter<g_object_unref>>;
using SurfaceOwner = std::unique_ptr<cairo_surface_t, Deleter<cairo_surface_destroy>>;
using ContextOwner = std::unique_ptr<cairo_t, Deleter<cairo_destroy>>;

cairo_status_t Append(void* target, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(target)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

struct PngReader {
  std::string_view left;
};
cairo_status_t ReadPng(void* source, unsigned char* bytes, unsigned int count) {
  auto& reader = *static_cast<PngReader*>(source);
  if (reader.left.size() < count) return CAIRO_STATUS_READ_ERROR;
  std::copy_n(reader.left.data(), count, reinterpret_cast<char*>(bytes));
  reader.left.remove_prefix(count);
  return CAIRO_STATUS_SUCCESS;
}

SurfaceOwner DecodePng(const std::string& png) {
  PngReader reader{png};
  SurfaceOwner picture(cairo_image_surface_create_from_png_stream(ReadPng, &reader));
  if (cairo_surface_status(picture.get()) != CAIRO_STATUS_SUCCESS) return nullptr;
  return picture;
}

void SetColour(cairo_t* cairo, std::uint32_t colour, double opacity = 1) {
  cairo_set_source_rgba(cairo, (colour >> 16 & 0xff) / 255.0, (colour >> 8 & 0xff) / 255.0,
                        (colour & 0xff) / 255.0, opacity);
}

LayoutOwner MakeLayout(cairo_t* cairo, std::string_view text, double width, const TextStyle& style) {
  LayoutOwner layout(pango_cairo_create_layout(cairo));
  PangoContext* context = pango_layout_get_context(layout.get());
  pango_cairo_context_set_resolution(context, 72);  // a point is a unit of the page
  PangoFontDescription* font = pango_font_description_new();
  pango_font_description_set_family(font, kFamilies);
  pango_font_description_set_absolute_size(font, style.size * PANGO_SCALE);
  pango_font_description_set_weight(
      font, style.is_bold ? static_cast<PangoWeight>(kSemiBold) : PANGO_WEIGHT_NORMAL);
  pango_layout_set_font_description(layout.get(), font);
  pango_font_description_free(font);
  if (width > 0) {
    pango_layout_set_width(layout.get(), static_cast<int>(width * PANGO_SCALE));
    pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
  }
  pango_layout_set_alignment(layout.get(), style.anchor == Anchor::kStart    ? PANGO_ALIGN_LEFT
                                           : style.anchor == Anchor::kMiddle ? PANGO_ALIGN_CENTER
                                                                             : PANGO_ALIGN_RIGHT);
  const std::string shown = Shown(text);
  pango_layout_set_text(layout.get(), shown.c_str(), static_cast<int>(shown.size()));
  return layout;
}

double HeightOf(PangoLayout* layout) {
  int width = 0, height = 0;
  pango_layout_get_size(layout, &width, &height);
  return static_cast<double>(height) / PANGO_SCALE;
}

void Trace(cairo_t* cairo, const std::vector<Vec2>& points) {
  bool is_down = false;
  for (const Vec2& point : points) {
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

void Draw(cairo_t* cairo, const Line& line) {
  const std::array<double, 2> dashed = {6, 4}, dotted = {1.5, 3};
  if (line.dash != Dash::kSolid)
    cairo_set_dash(cairo, line.dash == Dash::kDashed ? dashed.data() : dotted.data(), 2, 0);
  cairo_set_line_width(cairo, line.width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  SetColour(cairo, ColoursOf(line.ink).light);
  Trace(cairo, line.points);
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

void Draw(cairo_t* cairo, const Area& area) {
  Trace(cairo, area.points);
  cairo_close_path(cairo);
  SetColour(cairo, ColoursOf(area.ink).light, area.opacity);
  cairo_fill(cairo);
}

void Draw(cairo_t* cairo, const Mark& mark) {
  if (mark.kind == MarkKind::kDot) {
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, mark.at.x, mark.at.y, mark.radius, 0, 2 * std::numbers::pi);
  } else {
    Trace(cairo, MakeMarkOutline(mark));
    cairo_close_path(cairo);
  }
  SetColour(cairo, ColoursOf(mark.ink).light);
  cairo_fill_preserve(cairo);
  SetColour(cairo, kPaper.light);
  cairo_set_line_width(cairo, 1);
  cairo_stroke(cairo);
}

void Draw(cairo_t* cairo, const Label& label) {
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
  SetColour(cairo, ColoursOf(label.ink).light);
  pango_cairo_show_layout(cairo, layout.get());
  cairo_restore(cairo);
}

}  // namespace

struct PdfCanvas::Content {
  std::string bytes;
  SurfaceOwner surface;
  ContextOwner cairo;
};

PdfCanvas::PdfCanvas(const std::string& title, const std::string& created)
    : content_(std::make_unique<Content>()) {
  content_->surface.reset(
      cairo_pdf_surface_create_for_stream(Append, &content_->bytes, kPageWidth, kPageHeight));
  cairo_surface_t* surface = content_->surface.get();
  // Cairo would write the clock's time
  int year = 0;
  const bool is_date = std::sscanf(created.c_str(), "%4d-", &year) == 1 && year > 1900;
  const std::string date = is_date ? created : "1970-01-01T00:00:00Z";
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, Shown(title).c_str());
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "Trocar");
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, date.c_str());
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_MOD_DATE, date.c_str());
  content_->cairo.reset(cairo_create(surface));
}

PdfCanvas::~PdfCanvas() = default;

double PdfCanvas::MeasureText(std::string_view text, double width, const TextStyle& style) {
  return HeightOf(MakeLayout(content_->cairo.get(), text, width, style).get());
}

double PdfCanvas::AddText(std::string_view text, double left, double top, double width,
                          const TextStyle& style) {
  cairo_t* cairo = content_->cairo.get();
  const LayoutOwner layout = MakeLayout(cairo, text, width, style);
  SetColour(cairo, style.colour);
  cairo_move_to(cairo, left, top);
  pango_cairo_show_layout(cairo, layout.get());
  return HeightOf(layout.get());
}

void PdfCanvas::AddRectangle(double left, double top, double width, double height, std::uint32_t colour,
                             double radius) {
  cairo_t* cairo = content_->cairo.get();
  SetColour(cairo, colour);
  if (radius <= 0) {
    cairo_rectangle(cairo, left, top, width, height);
  } else {
    const double quarter = std::numbers::pi / 2;
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, left + width - radius, top + radius, radius, -quarter, 0);
    cairo_arc(cairo, left + width - radius, top + height - radius, radius, 0, quarter);
    cairo_arc(cairo, left + radius, top + height - radius, radius, quarter, 2 * quarter);
    cairo_arc(cairo, left + radius, top + radius, radius, 2 * quarter, 3 * quarter);
    cairo_close_path(cairo);
  }
  cairo_fill(cairo);
}

void PdfCanvas::AddRule(double left, double y, double width, std::uint32_t colour, double thickness) {
  AddRectangle(left, y - thickness / 2, width, thickness, colour);
}

double PdfCanvas::AddDrawing(const Drawing& drawing, double left, double top, double width) {
  cairo_t* cairo = content_->cairo.get();
  const double scale = width / drawing.width;
  cairo_save(cairo);
  cairo_translate(cairo, left, top);
  cairo_scale(cairo, scale, scale);
  for (const Shape& shape : drawing.shapes) std::visit([&](const auto& one) { Draw(cairo, one); }, shape);
  cairo_restore(cairo);
  return drawing.height * scale;
}

double PdfCanvas::MeasurePicture(const std::string& png, double width) {
  const SurfaceOwner picture = DecodePng(png);
  if (picture == nullptr) return 0;
  return width * cairo_image_surface_get_height(picture.get()) / cairo_image_surface_get_width(picture.get());
}

double PdfCanvas::AddPicture(const std::string& png, double left, double top, double width) {
  const SurfaceOwner picture = DecodePng(png);
  if (picture == nullptr) return 0;
  cairo_t* cairo = content_->cairo.get();
  const double scale = width / cairo_image_surface_get_width(picture.get());
  cairo_save(cairo);
  cairo_translate(cairo, left, top);
  cairo_scale(cairo, scale, scale);
  cairo_set_source_surface(cairo, picture.get(), 0, 0);
  cairo_paint(cairo);
  cairo_restore(cairo);
  return scale * cairo_image_surface_get_height(picture.get());
}

void PdfCanvas::AddOutline(const std::string& title, int page, double y) {
  const std::string place =
      "page=" + std::to_string(page) + " pos=[0 " + std::to_string(static_cast<int>(y)) + "]";
  cairo_pdf_surface_add_outline(content_->surface.get(), CAIRO_PDF_OUTLINE_ROOT, Shown(title).c_str(),
                                place.c_str(), CAIRO_PDF_OUTLINE_FLAG_OPEN);
}

void PdfCanvas::EndPage() {
  cairo_show_page(content_->cairo.get());
}

std::string PdfCanvas::Finish() {
  content_->cairo.reset();
  cairo_surface_finish(content_->surface.get());
  return std::move(content_->bytes);
}

}  // namespace trocar::report
