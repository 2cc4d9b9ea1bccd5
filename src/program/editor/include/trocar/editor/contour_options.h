// SPDX-License-Identifier: Apache-2.0
/// \file contour_options.h  Options of the contour window.
#pragma once

#include <filesystem>

#include "trocar/gui/run_options.h"
#include "trocar/images/image_series.h"

namespace trocar::editor {

struct ContourOptions {
  std::filesystem::path images;       ///< pictures: a folder, a DICOM series or a volume
  std::filesystem::path points;       ///< file of contours, which need not exist yet; empty: none
  std::filesystem::path reference;    ///< label map to compare with; empty: none
  images::ImageSeriesOptions series;  ///< what the pictures do not say
  std::filesystem::path script;       ///< commands to begin with; empty: none
  gui::RunOptions run;
  bool has_autosave = false;  ///< also in a run that is not attended
  bool is_measuring = false;  ///< drag a point for some seconds, print the times and quit

  /// A person is there to answer.
  bool IsAttended() const { return run.IsAttended() && !is_measuring; }
};

}  // namespace trocar::editor
