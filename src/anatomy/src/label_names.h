// SPDX-License-Identifier: Apache-2.0
/// \file label_names.h  Tables that say which label of a map is what.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "trocar/core/result.h"

namespace trocar::anatomy {

/// Reads a table of labels: JSON, {"liver": 5} or {"5": "liver"}, also as the member `labels` of nnU-Net's
/// dataset.json; a colour table of 3D Slicer (lines of number, name, colour); a label description of ITK-SNAP
/// (lines that begin with a number and end with a name in quotation marks). Label 0 is left out.
/// \return kFileMissing, kJsonSyntax, kJsonField, or kLabelsMismatch where a line is no entry, a label is no whole number from 0
///         to kLargestLabel, or one has two names
core::Result<std::vector<std::pair<std::string, int>>> ReadLabelNames(const std::filesystem::path& path);

}  // namespace trocar::anatomy
