// SPDX-License-Identifier: Apache-2.0
/// \file act_list.h  Verbs of a surgeon: each adds the acts of which it consists to a list that is done in order.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hold_planner.h"
#include "place.h"
#include "surgeon_act.h"
#include "trocar/instrument/tool.h"
#include "trocar/scene/scene.h"

namespace trocar::agent {

/// How often a hold that was missed is tried elsewhere.
inline constexpr int kHoldTries = 3;

class ActList {
 public:
  /// \param instruments  whose trays tools are exchanged from; has to outlive the list
  explicit ActList(const std::array<scene::InstrumentSetup, instrument::kHandCount>& instruments)
      : instruments_(&instruments) {}

  /// \param time_limit  after which the act is left [s]
  /// \return the act, for what else it needs; valid until the next one is added
  SurgeonAct& Add(SurgeonAct::Kind kind, std::string doing, double time_limit);
  /// Adds an act that plans further ones when it is reached, from what is seen then.
  SurgeonAct& Decide(SurgeonAct::Kind kind, std::string doing);

  void Reach(int hand, const Place& tip, double hurry = 1);
  /// Opens or closes the jaws. \param share  of the tool's widest opening [-]
  void Jaw(int hand, double share);
  /// Sets the right hand's jaws, and waits for as long as jaws need to close over a vessel. \param jaw  [rad]
  void SetJaw(std::string doing, double jaw);
  void Wait(double seconds);
  /// \param over_field  the tool goes in over the field, in the picture
  void Exchange(int hand, instrument::ToolKind kind, bool over_field = true);
  /// Has the right hand take up a tool, unless it holds such a one when that is reached.
  void Take(instrument::ToolKind kind);
  /// \param at       a node of the tissue
  /// \param squeeze  opening that the jaws close to, as a share: less pinches harder [-]
  void Grasp(int hand, const Place& at, double squeeze = 0);
  void Draw(int hand, const math::Vec3& by);
  /// Draws until the pull is felt. \param roll  of the tool about its shaft meanwhile [rad]
  void DrawGently(int hand, const math::Vec3& by, double roll = 0);
  /// Gives way to what is held until hardly a pull is felt: what is let go under a pull springs back.
  void Ease(int hand);
  void LetGo(int hand);
  /// Draws the right hand's tool back along its shaft.
  void Withdraw();
  void Burn(int hand, const Place& at, double seconds);
  /// Washes a place from a little before it, and takes up what has gathered.
  void Rinse(const Place& at, double rinse_seconds, double aspirate_seconds);
  /// Turns the laparoscope so that it looks at a place from aside. \param turn  about the cystic duct [rad]
  void LookAt(const Place& target, double turn, double distance);
  /// Takes the gallbladder with the left hand near a place, and elsewhere where that was missed.
  void HoldOn(const Place& near, int tries = kHoldTries, const HoldFilter& may = {});
  void Assist(scene::AssistantCommand command);

  std::vector<SurgeonAct> acts;

 private:
  const std::array<scene::InstrumentSetup, instrument::kHandCount>* instruments_;
};

}  // namespace trocar::agent
