// SPDX-License-Identifier: Apache-2.0
/// \file operation_result.h  How an operation stands: what is judged of it now, and at its end.
#pragma once

#include "trocar/scene/procedure.h"
#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/surgery_snapshot.h"

namespace trocar::simulation {

struct OperationResult {
  scene::ProcedureResult procedure;  ///< empty where nobody judges
  surgery::FluidLedger fluids;
  double bed_blood = 0;  ///< that the organ's bed has oozed, part of `fluids` [m^3]
  surgery::StoneCount stones;
  bool is_organ_free = false;  ///< nothing holds what is taken out
  bool is_in_bag = false;
  bool is_completed = false;  ///< it has left the abdomen in its bag
};

}  // namespace trocar::simulation
