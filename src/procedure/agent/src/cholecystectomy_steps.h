// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy_steps.h  Steps of a cholecystectomy: conditions, attempts and checks of which its goals consist.
///
/// Each looks at what is seen and adds acts to the plan. Which goal uses which is in cholecystectomy_goals.cpp.
#pragma once

#include <string>
#include <vector>

#include "act_list.h"
#include "operation_memory.h"
#include "surgeon_act.h"
#include "surgeon_view.h"

namespace trocar::agent {

/// What a decision plans from, and the plan that it adds to: what is added is done next.
struct Planning {
  const SurgeonView& view;
  OperationMemory& memory;
  ActList& plan;
};

// --- holds: cholecystectomy_holds.cpp
/// Lets go, and goes on to TakeHold.
void ChooseHold(Planning& on, const SurgeonAct& act);
void TakeHold(Planning& on, const SurgeonAct& act);
/// Tries elsewhere where nothing was taken, or something else.
void CheckHold(Planning& on, const SurgeonAct& act);
/// Exchanges the right hand's tool unless it is such a one already.
void TakeTool(Planning& on, const SurgeonAct& act);
/// Plans a dissection with the hook that the right hand holds then.
void AddDissection(Planning& on, DissectionGoal goal);
/// The left hand's hold slipped while the hook dissects: a new one, and on.
void HoldAnewAndGoOn(Planning& on);

// --- the hepatocystic triangle: cholecystectomy_triangle.cpp
bool IsTriangleDone(const Planning& on, const SurgeonAct& act);
/// A round: bluntly with the dissector, beside ducts too.
void SpreadTriangle(Planning& on, const SurgeonAct& act, SurgeonAct& again);
/// What is left then, with the hook; and the next round.
void HookTriangle(Planning& on, const SurgeonAct& act);
/// Fat that neither tool comes to: the neck is turned, held elsewhere, or scissors take the last fibres.
void OpenTriangle(Planning& on, const SurgeonAct& act);
void TurnNeck(Planning& on, const SurgeonAct& act);
/// Draws what the left hand holds about the cystic duct.
/// \param side  from where the neck is to be seen, +1 or -1
/// \param turn  of the hold about the duct [rad]
void TurnNeckAside(Planning& on, int side, double by, double turn);
/// Takes a gallbladder that hangs free round the duct by the hold; the assistant, who would hold it back, lets go.
void TakeRoundDuct(Planning& on, double angle);
void GoRoundDuct(Planning& on, const SurgeonAct& act);

// --- the bed: cholecystectomy_bed.cpp
bool IsLowerThirdDone(const Planning& on, const SurgeonAct& act);
void FreeLowerThird(Planning& on, const SurgeonAct& act, SurgeonAct& again);
/// Where it does not come off from the infundibulum on: from the fundus on, once.
void TurnToFundus(Planning& on, const SurgeonAct& act);
bool IsFundusFirstDone(const Planning& on, const SurgeonAct& act);
void FreeFromFundus(Planning& on, const SurgeonAct& act, SurgeonAct& again);
bool IsOffBed(const Planning& on, const SurgeonAct& act);
void FreeFromBed(Planning& on, const SurgeonAct& act, SurgeonAct& again);

// --- the critical view: cholecystectomy_views.cpp
inline constexpr int kViewRounds = 4;  // of looks for it
bool IsViewShown(const Planning& on, const SurgeonAct& act);
/// Where something is missing, back to it first; then both views.
void ShowCriticalView(Planning& on, const SurgeonAct& act, SurgeonAct& again);
bool HasSeenView(const Planning& on, const SurgeonAct& act);
void BailOutWithoutView(Planning& on, const SurgeonAct& act);
/// What keeps the critical view away, as it looks to the surgeon.
std::string ExplainMissingView(const SurgeonView& view, const WaysLeft& ways);
/// Looks at the triangle from one side of its front; where the picture does not get there, the left hand turns the neck towards
/// it, farther with each try, and at last by another hold.
void LookFromSide(Planning& on, const SurgeonAct& act);
/// Turns the picture so that the right hand's shaft does not hide the vessel that it works on.
void LookPastShaft(Planning& on, const SurgeonAct& act);
void FollowWithCamera(Planning& on, const SurgeonAct& act);

// --- clips and cuts: cholecystectomy_division.cpp
inline constexpr int kDivisionRounds = 3;  // with another hold each
bool AreAllDivided(const Planning& on, const SurgeonAct& act);
/// Every tube that enters the gallbladder.
bool AreStumpsThere(const Planning& on, const SurgeonAct& act);
/// Where nothing more fits, the gallbladder is held and drawn otherwise, and tools may come nearer to the rest.
void ClipAndCut(Planning& on, const SurgeonAct& act, SurgeonAct& again);
void GoOnDividing(Planning& on, const SurgeonAct& act);
/// Where more than two structures enter, an artery is divided before the view.
void DivideExtraArtery(Planning& on, const SurgeonAct& act);
void CheckClip(Planning& on, const SurgeonAct& act);
void CheckClosedClip(Planning& on, const SurgeonAct& act);
void CheckBlades(Planning& on, const SurgeonAct& act);
void CheckBeforeCut(Planning& on, const SurgeonAct& act);
void CheckDivision(Planning& on, const SurgeonAct& act);
bool IsDry(const Planning& on, const SurgeonAct& act);
/// A small vessel that still bleeds is shut by heat, where nothing that must stay is near.
void CoagulateLeak(Planning& on, const SurgeonAct& act, SurgeonAct& again);
void Coagulate(Planning& on, const SurgeonAct& act);

// --- of careless surgeons: careless_cholecystectomy.cpp
/// Closes a clip at a tube, after a look whether the vessel is between the legs.
void CheckPlacedClip(Planning& on, const SurgeonAct& act);

}  // namespace trocar::agent
