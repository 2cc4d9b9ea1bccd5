// SPDX-License-Identifier: Apache-2.0
/// \file image_frame.h  How the axes of a stack of images lie in the patient. Files say LPS or RAS; their
/// headers arrive here as LPS already (import_protocol.h), and leave as words.
#pragma once

#include <array>
#include <string>

#include "trocar/base/result.h"
#include "trocar/math/vector.h"

namespace trocar::images {

/// Largest angle between an axis of the images and the body's: beyond it, a word would mislead.
inline constexpr double kMostTiltDeg = 20.0;

/// Words for column, row and slice number.
struct NamedAxes {
  std::array<std::string, 3> axes;  ///< "left", "posterior", "superior", ...
  double tilt_deg = 0;              ///< largest angle between an axis and what its word says
};

/// \param direction  [column, row, slice number] unit vectors, LPS
/// \return kImageGeometryInvalid when they are not at right angles (0.5 degrees) or too oblique
base::Result<NamedAxes> NameAxes(const std::array<math::Vec3, 3>& direction);

/// Unit vectors, LPS, of three words.
/// \return kUsage unless they are one each of left/right, anterior/posterior and superior/inferior
base::Result<std::array<math::Vec3, 3>> FindDirections(const std::array<std::string, 3>& axes);

}  // namespace trocar::images
