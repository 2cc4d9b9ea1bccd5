// SPDX-License-Identifier: Apache-2.0
/// \file operation_result.h  How an operation stands: what is judged of it now, and at its end.
#pragma once

#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/surgery_snapshot.h"
#include "trocar/training/critical_view.h"
#include "trocar/training/injury.h"
#include "trocar/training/operation_error.h"
#include "trocar/training/triplet.h"

namespace trocar::simulation {

using surgery::StoneCount;

struct OperationResult {
  training::ErrorLog errors;
  training::DissectionFacts facts;
  training::CriticalViewScore critical_view;  ///< now
  bool was_critical_view_achieved = false;    ///< at some time before
  training::InjuryReport injuries;
  surgery::FluidLedger fluids;
  double bed_blood = 0;  ///< that the liver's bed has oozed, part of `fluids` [m^3]
  StoneCount stones;
  training::Phase phase = training::Phase::kPreparation;
  bool is_gallbladder_free = false;
  bool is_in_bag = false;
  bool is_completed = false;  ///< the gallbladder has left the abdomen in its bag
};

}  // namespace trocar::simulation
