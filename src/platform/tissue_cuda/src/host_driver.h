// SPDX-License-Identifier: Apache-2.0
/// \file host_driver.h  A GPU made of the processor: the driver's functions over the host executor. The whole
/// path of a solve (copies, arguments, launches, results) then runs without a GPU, with the bits that a GPU
/// gives.
#pragma once

#include "driver.h"

namespace trocar::tissue_cuda {

/// Its functions; never fail but for a wrong address, a full memory or an unknown kernel. Not for several
/// threads.
DriverFunctions HostDriver();

/// A source that uses it.
DriverSource HostSource();

/// Number of multiprocessors that its cuDeviceGetAttribute returns: enough that any mesh of the tests stays resident.
inline constexpr int kHostMultiprocessors = 4096;

}  // namespace trocar::tissue_cuda
