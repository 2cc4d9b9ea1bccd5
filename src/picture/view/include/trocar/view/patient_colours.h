// SPDX-License-Identifier: Apache-2.0
/// \file patient_colours.h  In which colours a patient is drawn from outside, read from a file.
#pragma once

#include <filesystem>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"
#include "trocar/render/figure.h"

namespace trocar::view {

/// sRGB, shares from 0 to 1. The defaults are those of the delivered file.
struct PatientColours {
  render::SrgbColour liver{0.66, 0.36, 0.31}, gallbladder{0.49, 0.62, 0.38}, other_organ{0.7, 0.7, 0.7};
  render::SrgbColour diaphragmatic_face{0.38, 0.57, 0.86}, falciform{0.97, 0.74, 0.26},
      coronary{0.74, 0.47, 0.88}, gallbladder_bed{0.30, 0.80, 0.62}, other_region{0.7, 0.7, 0.7};
  render::SrgbColour artery{0.88, 0.24, 0.22}, cystic_duct{0.80, 0.86, 0.32}, other_duct{0.58, 0.72, 0.26};
  render::SrgbColour attachment{0.95, 0.93, 0.80}, landmark{1.0, 1.0, 1.0};

  /// Of an organ's surface outside of its regions.
  const render::SrgbColour& Of(roles::OrganRole organ) const noexcept;
  const render::SrgbColour& Of(roles::RegionRole region) const noexcept;
  const render::SrgbColour& Of(const patient::Tube& tube) const noexcept;

  friend bool operator==(const PatientColours&, const PatientColours&) = default;
};

/// Where they lie in the data folder.
inline constexpr const char* kPatientColoursFile = "assets/looks/patient.json";

/// Reads colours (schemas/patient-colours.schema.json); each must be there.
/// \return the file's error: kFileMissing, kJsonSyntax or kJsonField with the place
base::Result<PatientColours> ReadPatientColours(const std::filesystem::path& path);

}  // namespace trocar::view
