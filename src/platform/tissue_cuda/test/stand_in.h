// SPDX-License-Identifier: Apache-2.0
/// \file stand_in.h  Points the GPU solver at the stand-in driver (stand_in_cuda.cpp).
#pragma once

#include <cstdlib>
#include <string>

#include "driver.h"

namespace trocar::tissue_cuda {

/// A driver that goes wrong as `plan` says, for as long as this lives.
class StandIn {
 public:
  explicit StandIn(const std::string& plan = "") { ::setenv("TROCAR_STAND_IN_CUDA", plan.c_str(), 1); }
  ~StandIn() { ::unsetenv("TROCAR_STAND_IN_CUDA"); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  /// The stand-in takes any code; only its presence counts.
  static DriverSource Source() {
    static constexpr unsigned char kCode[] = {1};
    return {TROCAR_STAND_IN_CUDA, std::nullopt, kCode, 12040};
  }
};

}  // namespace trocar::tissue_cuda
