// SPDX-License-Identifier: Apache-2.0
/// \file operation_result.h  How an operation stands: what is judged of it now, and at its end.
#pragma once

#include "trocar/cholecystectomy/critical_view.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/operation_error.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/surgery_snapshot.h"

namespace trocar::simulation {

struct OperationResult {
  cholecystectomy::ErrorLog errors;
  cholecystectomy::DissectionFacts facts;
  cholecystectomy::CriticalViewScore critical_view;  ///< now
  bool was_critical_view_achieved = false;           ///< at some time before
  cholecystectomy::InjuryReport injuries;
  surgery::FluidLedger fluids;
  double bed_blood = 0;  ///< that the liver's bed has oozed, part of `fluids` [m^3]
  surgery::StoneCount stones;
  cholecystectomy::Phase phase = cholecystectomy::Phase::kPreparation;
  bool is_gallbladder_free = false;
  bool is_in_bag = false;
  bool is_completed = false;  ///< the gallbladder has left the abdomen in its bag
};

}  // namespace trocar::simulation
