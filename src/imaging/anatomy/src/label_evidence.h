// SPDX-License-Identifier: Apache-2.0
/// \file label_evidence.h  Whether labels can be what somebody takes them for, by their sizes and by where they lie to each other.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "label_sights.h"
#include "trocar/anatomy/structure.h"

namespace trocar::anatomy {

/// Structure that each label is taken for.
using Meanings = std::map<int, Structure>;

/// Finds what contradicts these structures, by sizes, places and, where there is a CT, densities: clauses, the gravest first;
/// empty where all are possible. The bounds are wide: they admit organs of sick, small and large persons, and no other organs.
/// Sources: sizes in public segmentations of 1,228 CT series (Wasserthal et al., Radiology: Artificial Intelligence 2023); places from
/// textbooks of topographic anatomy, with a margin; the gallbladder's contact with the liver from label_sights of the Visible Human and
/// of generated patients.
/// \param mirrored  as if left and right of the map were swapped
std::vector<std::string> FindContradictions(const LabelSights& sights, const Meanings& meanings,
                                            bool mirrored = false);

/// The label that is the liver, or the gallbladder; 0 where there is none or several.
int LabelOf(const Meanings& meanings, Structure structure);

/// "31 mL, 43 % of its surface at the liver, 28 mm below and 56 mm in front of the liver's middle".
std::string DescribeGallbladder(const LabelSights& sights, int liver, int gallbladder);

}  // namespace trocar::anatomy
