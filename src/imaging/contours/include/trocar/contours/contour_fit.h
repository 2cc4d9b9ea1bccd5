// SPDX-License-Identifier: Apache-2.0
/// \file contour_fit.h  From clicked control points to a curve on the organ's edge, in one call.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1.1, second to fourth step.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/contours/contour_spline.h"
#include "trocar/contours/edge_adaption.h"
#include "trocar/contours/edge_field.h"
#include "trocar/math/vector.h"

namespace trocar::contours {

/// Why a part of a contour does not lie on an edge.
enum class FitProblem {
  kNoEdge,        ///< no clear edge within reach; the curve goes on between its neighbours
  kTooIrregular,  ///< the edge turns more sharply than the spline may; the curve cuts the corner
  kCrossesItself  ///< the clicked points' own polygon crosses itself
};

/// "no edge within reach", ...
std::string_view FitProblemText(FitProblem problem);

/// A part of the contour that does not fit.
struct FitNote {
  FitProblem problem = FitProblem::kNoEdge;
  math::Vec2 at;         ///< middle of the part, on the curve [pixels]
  double length_px = 0;  ///< of the part, along the curve [pixels]
};

struct ContourFitSettings {
  EdgeAdaptionSettings adaption;
  ContourSplineSettings spline;
  bool is_inserting = true;  ///< off: the points move to the edge but none is added, as while one is dragged
  double tolerance_px =
      1.0;  ///< the spline may lie this far from the edge before a point is inserted [pixels]
};

/// A contour through its stages, Fig. 2 of the paper.
struct ContourFit {
  std::vector<math::Vec2>
      adapted;  ///< (clicked) each clicked point where it was moved to, same order [pixels]
  std::vector<math::Vec2> inserted;  ///< points that were added on the edge, in the contour's order [pixels]
  std::vector<math::Vec2> spline;    ///< closed polyline through both, about half a pixel a step [pixels]
  std::vector<FitNote> notes;        ///< empty: the curve lies on an edge all around
};

/// Moves the clicked points to the edge, draws the closed spline, and divides it by points on the edge until
/// it follows the edge or the notes say where it does not.
///
/// How: the band of the picture along the spline through the clicked points is straightened; the edge is the
/// closed path through it on which the colours become unlike those inside, found by dynamic programming; the
/// clicked points move onto it. With adaption.inserts_points off, the points alone are adapted (AdaptToEdges)
/// and the spline goes through them undivided: for points that a person placed densely.
///
/// Equal inputs give equal bits.
/// \param field    of the slice, blurred by settings.adaption.blur_px
/// \param clicked  (n) n >= 3 points of a closed contour [pixels], of any sense of rotation
/// \pre n >= 3 distinct points (TROCAR_ASSERT)
ContourFit FitContourToEdges(const EdgeField& field, std::span<const math::Vec2> clicked,
                             const ContourFitSettings& settings = {});

/// As above, for an image that is used once.
ContourFit FitContourToEdges(const images::ColorImage& image, std::span<const math::Vec2> clicked,
                             const ContourFitSettings& settings = {});

}  // namespace trocar::contours
