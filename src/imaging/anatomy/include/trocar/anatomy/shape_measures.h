// SPDX-License-Identifier: Apache-2.0
/// \file shape_measures.h  How liver and gallbladder are shaped, in numbers that can be compared between people:
/// generated patients, patients from images, the literature. docs/shapes.md compares them.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// One number.
struct ShapeMeasure {
  std::string_view name;   ///< "gallbladder_inclination"
  std::string_view unit;   ///< "mm", "mL", "deg", "mm^2", "" for shares
  std::string_view about;  ///< how it is measured, one line
  double value = 0;
  bool is_seen = true;  ///< false: it hangs on a duct that was placed by landmarks
};

/// Measures a patient. Lengths are in millimetres, angles in degrees.
///
/// The gallbladder's axis runs straight from the infundibulum to the fundus. Its cross-sections are 20 slabs across
/// that axis; a slab's diameter is twice the mean distance of its wall from the slab's centre.
/// \return kPatientInvalid where liver, gallbladder, its bed, infundibulum or fundus are missing
/// \note Not real-time safe; pure.
base::Result<std::vector<ShapeMeasure>> MeasureShapes(const patient::Patient& patient);

/// Range of a measure in the literature.
struct ShapeRange {
  std::string_view measure;
  double low = 0, high = 0;
  std::string_view source;
};
std::span<const ShapeRange> LiteratureRanges();

}  // namespace trocar::anatomy
