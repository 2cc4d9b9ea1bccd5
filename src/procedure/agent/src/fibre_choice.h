// SPDX-License-Identifier: Apache-2.0
/// \file fibre_choice.h  Which fibre a hook takes next, and how it is turned to come to it.
#pragma once

#include "heat_memory.h"
#include "hook_planner.h"

namespace trocar::agent {

/// Chooses the fibre that lies open and near; none where none can be worked on: beside what must stay, where the tissue is warm,
/// after vain attempts, or where the shaft cannot come to it.
/// \param[in,out] work  its target, what is left, and whether it waits for a place to cool
/// \return share of the fibres that are parted [-]
double ChooseFibre(const HookField& field, Dissection& work, const HeatMemory& heat, const HandMotion& hook);

}  // namespace trocar::agent
