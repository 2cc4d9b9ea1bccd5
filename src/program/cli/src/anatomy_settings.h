// SPDX-License-Identifier: Apache-2.0
/// \file anatomy_settings.h  Parameters of a patient on the command line.
#pragma once

#include <string>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/base/result.h"

namespace trocar::cli {

/// Words like "hydrops=0.5".
/// \return kUsage for one that is not like that
base::Result<std::vector<anatomy::ParameterSetting>> ParseSettings(const std::vector<std::string>& texts);

}  // namespace trocar::cli
