// SPDX-License-Identifier: Apache-2.0
/// \file ct_phantom.h  A CT of a person who never lay in a scanner: a label map's organs inside a drawn body.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/ct_render.h"
#include "trocar/images/image_stack.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

struct CtPhantom {
  images::CtVolume ct;
  images::LabelVolume labels;  ///< the map's, at the CT's voxels
};

/// Draws wall, ribs, spine, gut, kidneys, spleen, heart and lungs around the map's liver and gallbladder, and the
/// diaphragm on the liver, and renders all of it.
///
/// Labels that FindLabels understands as neighbours, bile ducts, arteries or hepatic veins are drawn, too; other labels are not.
/// Where no label is the portal vein, vessels are drawn inside the liver. The gallbladder has a wall of 2 mm.
/// \param labels  as FindLabels understands them; steps at right angles
/// \return kLabelsMismatch without liver or gallbladder, or for oblique steps; kUsage for a setting out of range; kCancelled
base::Result<CtPhantom> MakeCtPhantom(const images::LabelVolume& labels, const images::CtSettings& settings,
                                      std::stop_token stop = {}, const images::Progress& progress = {});

/// Names and labels of the Visible Human's reference map (docs/measurements.md); the file itself has no names.
std::vector<std::pair<std::string, int>> VisibleHumanLabels();

/// The organs of a patient as a label map, to make a phantom of.
/// \return kPatientInvalid without liver or gallbladder
base::Result<images::LabelVolume> DrawLabels(const patient::Patient& patient,
                                             const images::Progress& progress = {}, double pixel_mm = 0.8,
                                             double slice_mm = 1.0);

/// Writes slices/ (a DICOM series) and labels.nrrd (the truth) into a folder.
/// \param folder  is made; it must not exist, or be empty
/// \return kFileUnwritable
base::Status WriteCtPhantom(const std::filesystem::path& folder, const CtPhantom& phantom,
                            const images::Progress& progress = {});

}  // namespace trocar::anatomy
