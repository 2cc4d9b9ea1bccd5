// SPDX-License-Identifier: Apache-2.0
/// \file allocation_counter.h  Counts every operator new of this test program.
#pragma once

namespace trocar::simulation {

/// Allocations of all threads since the start.
long CountAllocations();

}  // namespace trocar::simulation
