// SPDX-License-Identifier: Apache-2.0
/// \file label_plausibility.h  Whether labels can be a person's liver and gallbladder, and what is wrong if not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "label_measures.h"
#include "trocar/anatomy/patient_from_labels.h"

namespace trocar::anatomy {

struct MeasuredLabels {
  OrganLabels labels;
  LabelMeasures liver, gallbladder;
  std::optional<math::Vec3> spleen;  ///< its centre, where the map has one [mm]
};

/// Measures the organs, and the spleen where it is known which label it is.
MeasuredLabels MeasureOrgans(const images::LabelVolume& volume, const OrganLabels& labels,
                             const VoxelFrame& frame);

/// Sizes, places and sides.
/// \return kLabelsMismatch with the likely reason: labels swapped, voxels in centimetres, metres or ten times too
///         large, organs far apart (two frames), turned upside down, left and right swapped or situs inversus
base::Status CheckBody(const MeasuredLabels& measured, bool is_mirrored);

/// That left and right are swapped.
/// \param sign  by what it is known: a clause
base::Error ExplainMirrored(const std::string& sign, bool is_mirrored);

/// Parts that do not hang together [mL], the largest first.
/// \return kLabelsMismatch where a large one would be lost (two livers, or one that the map cuts in two)
base::Status CheckParts(const std::string& organ, const std::vector<double>& parts_ml, bool takes_largest);

/// Remarks for the reader on a map that is accepted: parts that are left out, and where the map's border cuts an organ.
std::vector<std::string> DescribeLosses(const std::string& organ, const std::vector<double>& parts_ml,
                                        const std::vector<CutSide>& cuts);

}  // namespace trocar::anatomy
