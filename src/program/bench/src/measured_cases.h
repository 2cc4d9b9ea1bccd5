// SPDX-License-Identifier: Apache-2.0
/// \file measured_cases.h  What a benchmark printed with `--json`, read again.
#pragma once

#include <map>
#include <string>

#include "trocar/base/result.h"

namespace trocar::bench {

/// \param source  whose text it is, for messages
/// \return the value of each case by its name, in the case's own unit; kFileDamaged where the text is no such JSON
base::Result<std::map<std::string, double>> ReadMeasuredCases(const std::string& text,
                                                              const std::string& source);

}  // namespace trocar::bench
