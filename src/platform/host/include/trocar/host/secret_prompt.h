// SPDX-License-Identifier: Apache-2.0
/// \file secret_prompt.h  Asks a person for a secret without showing it.
#pragma once

#include <optional>
#include <string>

namespace trocar::host {

/// Asks on standard error and reads a line of standard input, which the terminal does not show. Signals wait meanwhile.
/// \return nothing where nobody sits at a terminal
std::optional<std::string> AskInSecret(const std::string& question);

}  // namespace trocar::host
