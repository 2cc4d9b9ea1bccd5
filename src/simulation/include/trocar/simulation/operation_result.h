// SPDX-License-Identifier: Apache-2.0
/// \file operation_result.h  How an operation stands: what is judged of it now, and at its end.
#pragma once

#include "trocar/surgery/flow_network.h"
#include "trocar/training/critical_view.h"
#include "trocar/training/injury.h"
#include "trocar/training/operation_error.h"
#include "trocar/training/triplet.h"

namespace trocar::simulation {

/// What has become of the patient's gallstones.
struct StoneCount {
  int all = 0;
  int inside = 0;   ///< of the gallbladder
  int spilled = 0;  ///< in the abdomen, those between jaws among them
  int in_bag = 0;   ///< of its own, beside the gallbladder
  int aspirated = 0;
  int taken_out = 0;  ///< through a trocar
};

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
