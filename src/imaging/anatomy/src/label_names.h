// SPDX-License-Identifier: Apache-2.0
/// \file label_names.h  Tables that say which label of a map is what.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::anatomy {

/// Names of labels, and what they are in SNOMED.
struct LabelTable {
  std::vector<std::pair<std::string, int>> names;
  std::vector<std::pair<std::string, int>> codes;  ///< as LabelVolume::codes; of dcmqi's tables
};

/// Reads a table of labels, UTF-8 or UTF-16, with or without a byte order mark:
/// - JSON: {"liver": 5} or {"5": "liver"}, also as the member `labels` of nnU-Net's dataset.json, with regions ({"liver": [1, 2]});
///   {"5": {"name": "liver"}}; a list of {"label": 5, "name": "liver"}; dcmqi's segmentAttributes.
/// - a table with a header, separated by commas, semicolons or tabs, which has a column of labels (label, index, value, id, ...) and
///   one of names (name, structure, organ, ...): CSV, TSV, BIDS's dseg.tsv, 3D Slicer's colour tables in CSV.
/// - lines of a number and a name: colour tables of 3D Slicer and FreeSurfer, label descriptions of ITK-SNAP, "5: liver", "liver = 5".
/// Label 0 is left out. A label of several regions has the name of the smallest first.
/// \return kFileMissing, kJsonSyntax, kJsonField, or kLabelsMismatch where something is no table (it says what it is, or which line or
///         field is no entry), a label is no whole number from 0 to kLargestLabel, or one has two names
base::Result<LabelTable> ReadLabelNames(const std::filesystem::path& path);

}  // namespace trocar::anatomy
