// SPDX-License-Identifier: Apache-2.0
/// \file cairo_text.h  Colours and texts on a Cairo surface.
#pragma once

#include <pango/pangocairo.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "pdf_canvas.h"
#include "shown_text.h"

namespace trocar::report {

// Pango takes the first that is installed; DejaVu Sans comes with Trocar's packages
inline constexpr const char* kFamilies = "Inter,DejaVu Sans,sans-serif";
inline constexpr int kSemiBold = 600;

template <auto free_function>
struct Deleter {
  template <typename T>
  void operator()(T* object) const {
    free_function(object);
  }
};
using LayoutOwner = std::unique_ptr<PangoLayout, Deleter<g_object_unref>>;
inline void SetColour(cairo_t* cairo, std::uint32_t colour, double opacity = 1) {
  cairo_set_source_rgba(cairo, (colour >> 16 & 0xff) / 255.0, (colour >> 8 & 0xff) / 255.0,
                        (colour & 0xff) / 255.0, opacity);
}

inline LayoutOwner MakeLayout(cairo_t* cairo, std::string_view text, double width, const TextStyle& style) {
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

}  // namespace trocar::report
