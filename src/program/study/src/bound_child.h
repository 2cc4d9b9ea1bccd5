// SPDX-License-Identifier: Apache-2.0
/// \file bound_child.h  Processes that end with the one that started them, however that one ends.
#pragma once

#include <sys/types.h>

namespace trocar::study {

/// fork; the child gets `signal` when the calling thread's process dies. What it starts itself is its own affair.
/// \return as of fork
pid_t ForkBound(int signal);

}  // namespace trocar::study
