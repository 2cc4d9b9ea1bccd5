// SPDX-License-Identifier: Apache-2.0
/// \file label_schemes.h  The numbers by which public programs and data sets write organs, for maps without names.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "trocar/anatomy/structure.h"

namespace trocar::anatomy {

struct LabelScheme {
  const char* name;    ///< "TotalSegmentator 2"
  const char* source;  ///< where the numbers stand
  std::map<int, Structure> numbers;

  bool Holds(int label) const { return numbers.contains(label); }
};

/// Every scheme that is known. docs/patients.md lists them with their sources.
const std::vector<LabelScheme>& LabelSchemes();

}  // namespace trocar::anatomy
