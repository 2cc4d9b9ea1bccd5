// SPDX-License-Identifier: Apache-2.0
/// \file label_console.h  Listing on the console of what the labels of a segmentation were taken for.
#pragma once

#include <vector>

#include "trocar/patient/patient.h"

namespace trocar::cli {

/// A line for each organ with its reason, one for all neighbours that have the same reason; nothing for a patient without labels.
void PrintLabels(const std::vector<patient::SourceLabel>& labels);

}  // namespace trocar::cli
