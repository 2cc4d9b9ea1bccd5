// SPDX-License-Identifier: Apache-2.0
/// \file passphrase.h  Asks for a secret without showing it.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/base/result.h"

namespace trocar::cli {

/// For a new key: of the environment, else asked for twice at the terminal; empty where there is neither, or where the person
/// wants none.
/// \return kUsage where the two differ
base::Result<std::string> FindNewPassphrase(const std::filesystem::path& key);

/// Of a key that is there: empty where it is not encrypted; else of the environment or asked for at the terminal.
/// \return the key's error
base::Result<std::string> FindPassphrase(const std::filesystem::path& key);

}  // namespace trocar::cli
