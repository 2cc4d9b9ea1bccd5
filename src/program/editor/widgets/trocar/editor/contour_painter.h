// SPDX-License-Identifier: Apache-2.0
/// \file contour_painter.h  Draws a slice and its contours with Cairo.
///
/// The three stages of the paper's Fig. 2: clicked points red, points on the edge yellow, the spline green
/// with the filled area.
#pragma once

#include <cairomm/cairomm.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "trocar/editor/contour_editor.h"

namespace trocar::editor {

struct PaintOptions {
  bool has_points = true, has_fill = true, has_ghosts = true, has_reference = false;
  images::DisplayWindow window;  ///< of grey pictures
};

class ContourPainter {
 public:
  /// Draws everything.
  /// \param scale  device pixels a pixel of the window
  /// \return why the picture cannot be had; then the rest is drawn on black
  base::Status Paint(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor,
                     const PaintOptions& options, int scale);
  /// How often the picture had to be scaled anew.
  std::uint64_t ScaledCount() const { return scaled_; }

 private:
  base::Status PreparePicture(ContourEditor& editor, const PaintOptions& options);
  void PaintPicture(const Cairo::RefPtr<Cairo::Context>& cairo, const ContourEditor& editor, int scale);
  void PaintReference(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor);
  void PaintGhosts(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor);
  void PaintOrgan(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor,
                  const PaintOptions& options, int structure);
  void PaintPoints(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor,
                   const contours::SliceFit& fit);
  void PaintOpen(const Cairo::RefPtr<Cairo::Context>& cairo, ContourEditor& editor);
  void PaintMargins(const Cairo::RefPtr<Cairo::Context>& cairo, const ContourEditor& editor);

  // the slice as a surface, and scaled for the view
  Cairo::RefPtr<Cairo::ImageSurface> picture_, scaled_picture_;
  int picture_slice_ = -1;
  images::DisplayWindow picture_window_;
  CanvasView scaled_view_;
  int scaled_width_ = 0, scaled_height_ = 0;
  std::uint64_t scaled_ = 0;
  // borders of the reference in this slice
  int reference_slice_ = -1;
  std::vector<contours::ContourWorkspace::ReferenceLines> reference_;
};

}  // namespace trocar::editor
