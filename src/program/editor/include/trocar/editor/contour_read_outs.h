// SPDX-License-Identifier: Apache-2.0
/// \file contour_read_outs.h  Texts of the contour window, from numbers.
#pragma once

#include <string>

#include "trocar/contours/mesh_job.h"
#include "trocar/editor/contour_editor.h"

namespace trocar::editor {

/// "Slice 480 · liver"
std::string SliceTitle(const ContourEditor& editor);
/// "2 contours, 1 hole · 43 points · 182.4 cm2", or what to do where there is none.
std::string SliceText(ContourEditor& editor);
/// Where the curve does not fit and why, one line a kind of problem; empty when it fits.
std::string SliceNotes(ContourEditor& editor);
/// "pixel 512.0, 240.5   LPS 12.3, -45.0, 120.0 mm"; empty when the pointer is elsewhere
std::string PointerText(const ContourEditor& editor);
/// "1280 x 720 px of 0.528 mm, slices of 1 mm · columns to left, rows to anterior · file: LPS"
std::string SeriesText(const images::ImageSeriesInfo& series);
/// How the series was read, where that is not plain: which one was taken, what was interpolated; else empty.
std::string SeriesNotes(const images::ImageSeriesInfo& series);
/// "liver: 5,000 triangles, 1403 mL · 2.1 mm": the lattice it was made on
std::string MeshText(const std::string& name, const contours::OrganMesh& mesh);

/// Area that the fitted contours enclose, holes taken off [mm^2].
double CalcArea(const contours::SliceFit& fit, double pixel_mm);

}  // namespace trocar::editor
