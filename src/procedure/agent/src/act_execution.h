// SPDX-License-Identifier: Apache-2.0
/// \file act_execution.h  How each act of an operation begins, and when it is done.
#pragma once

#include "act_list.h"
#include "operation_memory.h"
#include "surgeon_act.h"
#include "surgeon_view.h"

namespace trocar::agent {

/// Sets hands, pedals, camera and assistant going.
/// \pre !act.IsDecision()
void BeginAct(const SurgeonAct& act, const SurgeonView& view, OperationMemory& memory);

/// One tick of an act that has begun.
/// \param[in,out] seconds  since it began; a spread begins anew while the jaws open [s]
/// \param[in,out] plan     what has to be done next, where the act cannot be gone on with
bool StepAct(const SurgeonAct& act, const SurgeonView& view, OperationMemory& memory, double& seconds,
             ActList& plan);

}  // namespace trocar::agent
