// SPDX-License-Identifier: Apache-2.0
#include "pdf_canvas.h"

#include <cairo-pdf.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "cairo_text.h"
#include "shown_text.h"
#include "trocar/report/cairo_drawing.h"

namespace trocar::report {
namespace {

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

double HeightOf(PangoLayout* layout) {
  int width = 0, height = 0;
  pango_layout_get_size(layout, &width, &height);
  return static_cast<double>(height) / PANGO_SCALE;
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
  PaintDrawing(*cairo, drawing, Ground::kLight);
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
