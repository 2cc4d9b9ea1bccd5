// SPDX-License-Identifier: Apache-2.0
/// \file threads.h  Threads of oneTBB for the engine.
#pragma once

#include "trocar/base/threads.h"

namespace trocar::host {

/// \param count  with the caller; less than 1 is 1
base::Threads UseThreads(int count) noexcept;

}  // namespace trocar::host
