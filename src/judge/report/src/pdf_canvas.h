// SPDX-License-Identifier: Apache-2.0
/// \file pdf_canvas.h  Pages of a PDF on which texts, shapes and pictures are put: Cairo and Pango behind plain calls.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "palette.h"
#include "trocar/report/drawing.h"

namespace trocar::report {

inline constexpr double kPageWidth = 595.28, kPageHeight = 841.89;  // A4 [pt]

struct TextStyle {
  double size = 9;  ///< [pt]
  std::uint32_t colour = ColoursOf(Ink::kText).light;
  bool is_bold = false;
  Anchor anchor = Anchor::kStart;
};

/// Lengths in points, y downwards from the page's top.
class PdfCanvas {
 public:
  /// \param created  RFC 3339; empty or not a date: 1970
  PdfCanvas(const std::string& title, const std::string& created);
  ~PdfCanvas();
  PdfCanvas(const PdfCanvas&) = delete;
  PdfCanvas& operator=(const PdfCanvas&) = delete;

  /// Height of the text broken into lines of `width`.
  double MeasureText(std::string_view text, double width, const TextStyle& style);
  /// Draws it below `top`. \return its height
  double AddText(std::string_view text, double left, double top, double width, const TextStyle& style);
  void AddRectangle(double left, double top, double width, double height, std::uint32_t colour,
                    double radius = 0);
  void AddRule(double left, double y, double width, std::uint32_t colour, double thickness);
  /// Scaled to `width`. \return its height
  double AddDrawing(const Drawing& drawing, double left, double top, double width);
  /// A PNG, scaled to `width`. \return its height; 0 where it is no picture
  double AddPicture(const std::string& png, double left, double top, double width);
  /// Height that AddPicture would return, without drawing.
  double MeasurePicture(const std::string& png, double width);
  /// In the list of contents that viewers show beside the page.
  void AddOutline(const std::string& title, int page, double y);
  void EndPage();
  /// The file's bytes; nothing can be added after it.
  std::string Finish();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::report
