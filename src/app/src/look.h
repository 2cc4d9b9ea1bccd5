// SPDX-License-Identifier: Apache-2.0
/// \file look.h  Dark theme of the window.
#pragma once

namespace trocar::app {

/// Style sheet for the whole display. A display must be open.
void ApplyLook();

}  // namespace trocar::app
