// SPDX-License-Identifier: Apache-2.0
#include "operation_memory.h"

#include <utility>

namespace trocar::agent {

void OperationMemory::BailOut(std::string reason) {
  stops = true;
  bail_out = std::move(reason);
  LeaveFibre(dissection, controls[instrument::kRight].coagulate);
}

}  // namespace trocar::agent
