// SPDX-License-Identifier: Apache-2.0
/// \file canvas_view.h  How a slice lies on the screen: zoom, pan, mirror, and what lies under the pointer.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::editor {

/// Size of the canvas [pixels of the window].
struct CanvasSize {
  double width = 1, height = 1;
};

/// Maps pixels of the picture to places on the canvas.
struct CanvasView {
  double zoom = 1;    ///< pixels of the window a pixel of the picture, kLeastZoom to kMostZoom
  math::Vec2 centre;  ///< what lies in the middle of the canvas [pixels of the picture]
  bool is_mirrored_x = false, is_mirrored_y = false;

  friend bool operator==(const CanvasView&, const CanvasView&) = default;
};
inline constexpr double kLeastZoom = 0.05, kMostZoom = 40;

math::Vec2 ToCanvas(const CanvasView& view, const CanvasSize& size, const math::Vec2& p) noexcept;
math::Vec2 ToPicture(const CanvasView& view, const CanvasSize& size, const math::Vec2& at) noexcept;

/// Zooms so that what lies under `at` stays there.
void ZoomAt(CanvasView& view, const CanvasSize& size, const math::Vec2& at, double factor) noexcept;
/// Moves the picture with the pointer by so many pixels of the window; its middle never leaves the canvas.
void PanBy(CanvasView& view, double dx, double dy, int picture_width, int picture_height) noexcept;
/// The whole picture, with a small margin.
void FitPicture(CanvasView& view, const CanvasSize& size, int picture_width, int picture_height) noexcept;
/// A part of the picture.
/// \param low, high  corners [pixels of the picture]
void FitBox(CanvasView& view, const CanvasSize& size, const math::Vec2& low, const math::Vec2& high) noexcept;

/// Mirrors the picture as radiology shows it: on a cross-section anterior is above and the patient's right at
/// the left; from front and side superior is above, and from the side anterior at the left.
/// \param axes  where column, row and slice number grow to: "left", "posterior", ...
void MirrorForRadiology(CanvasView& view, const std::array<std::string, 3>& axes) noexcept;

/// Letters at the edges of the canvas: "R", "L", "A", "P", "S" or "I".
struct EdgeLetters {
  std::string left, right, top, bottom;
};
EdgeLetters FindEdgeLetters(const CanvasView& view, const std::array<std::string, 3>& axes);

/// Index of the nearest of some points within `reach` of the pointer, the later of equals.
/// \param at, reach  on the canvas [pixels of the window]
std::optional<std::size_t> HitPoint(const CanvasView& view, const CanvasSize& size,
                                    std::span<const math::Vec2> points, const math::Vec2& at,
                                    double reach) noexcept;

/// Where a closed curve passes the pointer.
struct CurveHit {
  math::Vec2 at;         ///< on the curve [pixels of the picture]
  std::size_t side = 0;  ///< the curve's point before it
  double distance = 0;   ///< on the canvas [pixels of the window]
};
std::optional<CurveHit> HitCurve(const CanvasView& view, const CanvasSize& size,
                                 std::span<const math::Vec2> curve, const math::Vec2& at,
                                 double reach) noexcept;

/// Which control point a new one on the curve comes before, so that the contour keeps its order.
///
/// \param curve    closed, through or near the control points in their order
/// \param side     of a CurveHit on it
/// \return 1 to the number of control points
std::size_t FindInsertion(std::span<const math::Vec2> curve, std::span<const math::Vec2> controls,
                          std::size_t side) noexcept;

/// Length of a scale bar that takes about `pixels` of the window: 1, 2 or 5 times a power of ten [mm].
double ChooseScaleBar(double zoom, double pixel_mm, double pixels) noexcept;

}  // namespace trocar::editor
