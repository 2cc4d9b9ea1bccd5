// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy_goals.h  The cholecystectomy as a table of goals, in order.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <span>

#include "act_list.h"
#include "cholecystectomy_steps.h"
#include "patient_knowledge.h"
#include "surgeon_act.h"
#include "trocar/cholecystectomy/triplet.h"
#include "trocar/scene/scene.h"

namespace trocar::agent {

/// One goal of an operation. When it is reached in the plan, its condition is looked at; while that does not hold, a round is
/// attempted, after which the goal is next again, with one round less.
struct OperationGoal {
  SurgeonAct::Kind kind = SurgeonAct::Kind::kWait;                      ///< by which the plan names it
  cholecystectomy::Phase phase = cholecystectomy::Phase::kPreparation;  ///< to which its work belongs
  const char* doing = "";                                               ///< what a person is told meanwhile
  int rounds = 0;                                                       ///< at most
  bool (*is_reached)(const Planning&, const SurgeonAct&) = nullptr;
  /// \param again  the next round, which it may change
  void (*attempt)(Planning&, const SurgeonAct&, SurgeonAct& again) = nullptr;
  /// What is done when no round is left; null: the operation goes on all the same.
  void (*without)(Planning&, const SurgeonAct&) = nullptr;
  /// Whether the attempt plans the next round itself.
  bool plans_again = false;
  /// Acts that are written into the plan as it is made; null: the goal itself.
  void (*write)(const OperationGoal&, const PatientKnowledge&, ActList&) = nullptr;
};

/// From the first look to the bag.
std::span<const OperationGoal> CholecystectomyGoals();

/// Adds each goal of an operation to a plan.
void WritePlan(std::span<const OperationGoal> goals, const PatientKnowledge& known, ActList& plan);

/// Phase of the goal that a plan is at.
/// \param acts  the plan, its first act under way; not empty
std::optional<cholecystectomy::Phase> FindPlannedPhase(
    const std::deque<SurgeonAct>& acts,
    const std::array<scene::InstrumentSetup, instrument::kHandCount>& instruments);

/// Goes on with a goal, or does a step of one, that has been reached in the plan.
/// \pre act.IsDecision()
void PlanOn(Planning& on, const SurgeonAct& act);

}  // namespace trocar::agent
