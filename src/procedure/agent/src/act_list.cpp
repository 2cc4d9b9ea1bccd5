// SPDX-License-Identifier: Apache-2.0
#include "act_list.h"

#include <algorithm>
#include <utility>

namespace trocar::agent {

using instrument::kRight;
using scene::AssistantCommand;

namespace {

/// Open jaws wait so far before a hold, and close so far past it [m].
constexpr double kBeforeHold = 0.015, kPastHold = 0.005;
constexpr double kWithdrawn = 0.020;  // [m]

}  // namespace

SurgeonAct& ActList::Add(SurgeonAct::Kind kind, std::string doing, double time_limit) {
  SurgeonAct act;
  act.kind = kind;
  act.doing = std::move(doing);
  act.time_limit = time_limit;
  acts.push_back(std::move(act));
  return acts.back();
}

SurgeonAct& ActList::Decide(SurgeonAct::Kind kind, std::string doing) {
  return Add(kind, std::move(doing), 1.0);
}

void ActList::Reach(int hand, const Place& tip, double hurry) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kReach, "reach", 5.0);
  act.hand = hand;
  act.place = tip;
  act.hurry = hurry;
}

void ActList::Jaw(int hand, double share) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kJaw, share > 0.5 ? "open" : "close", 2.0);
  act.hand = hand;
  act.amount = share;
}

void ActList::SetJaw(std::string doing, double jaw) {
  Add(SurgeonAct::Kind::kSetJaw, std::move(doing), 2.0).amount = jaw;
}

void ActList::Wait(double seconds) {
  Add(SurgeonAct::Kind::kWait, "wait", seconds + 1.0).seconds = seconds;
}

void ActList::Exchange(int hand, instrument::ToolKind kind, bool over_field) {
  const auto& tray = (*instruments_)[static_cast<std::size_t>(hand)].tray;
  const auto found =
      std::find_if(tray.begin(), tray.end(), [&](const instrument::Tool& tool) { return tool.kind == kind; });
  if (over_field) {
    Place waiting = Place::Of(Place::Kind::kOverField);
    waiting.hand = hand;
    Reach(hand, waiting);
  }
  SurgeonAct& act = Add(SurgeonAct::Kind::kExchange,
                        "exchange " + (found != tray.end() ? found->name : std::string("nothing")), 6.0);
  act.hand = hand;
  act.tool = static_cast<std::uint8_t>(found - tray.begin());
  // what comes in comes in closed; an open clip applier that closes would lose its clip
  Jaw(hand, 0.0);
}

void ActList::Take(instrument::ToolKind kind) {
  Decide(SurgeonAct::Kind::kTake, "take a tool").tool_kind = kind;
}

void ActList::Grasp(int hand, const Place& at, double squeeze) {
  Place before = at, in = at;
  before.hand = in.hand = hand;
  before.back = kBeforeHold;
  in.back = -kPastHold;
  Jaw(hand, 0.8);
  Reach(hand, before);
  // deep enough that the jaws close over what lies there
  Reach(hand, in, 0.5);
  Jaw(hand, squeeze);
  Wait(0.2);
}

void ActList::Draw(int hand, const math::Vec3& by) {
  Place drawn = Place::Of(Place::Kind::kFromTip);
  drawn.hand = hand;
  drawn.p = by;
  Reach(hand, drawn, 0.25);
  Wait(0.3);
}

void ActList::DrawGently(int hand, const math::Vec3& by, double roll) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kDraw, "draw", 5.0);
  act.hand = hand;
  act.by = by;
  act.amount = roll;
  Wait(0.2);
}

void ActList::Ease(int hand) {
  Add(SurgeonAct::Kind::kEase, "ease", 3.0).hand = hand;
}

void ActList::LetGo(int hand) {
  Ease(hand);
  Jaw(hand, 0.8);
  Reach(hand, Place::BehindTip(hand, 0.025));
  // not closed: that would take what lies there
  Jaw(hand, 0.3);
}

void ActList::Withdraw() {
  Reach(kRight, Place::BehindTip(kRight, kWithdrawn), 0.6);
}

void ActList::Burn(int hand, const Place& at, double seconds) {
  Reach(hand, at, 0.5);
  SurgeonAct& act = Add(SurgeonAct::Kind::kBurn, "burn", seconds + 1.0);
  act.hand = hand;
  act.seconds = seconds;
}

void ActList::Rinse(const Place& at, double rinse_seconds, double aspirate_seconds) {
  constexpr double kInPool = 0.003;  // [m]
  Place pool = Place::Of(Place::Kind::kPool);
  Reach(kRight, at, 0.5);
  Add(SurgeonAct::Kind::kRinse, "rinse", rinse_seconds + 1.0).seconds = rinse_seconds;
  pool.back = kInPool;
  Reach(kRight, pool, 0.5);
  Add(SurgeonAct::Kind::kAspirate, "aspirate", aspirate_seconds + 1.0).seconds = aspirate_seconds;
}

void ActList::LookAt(const Place& target, double turn, double distance) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kLook, "look", 8.0);
  act.place = target;
  act.amount = turn;
  act.distance = distance;
}

void ActList::HoldOn(const Place& near, int tries, const HoldFilter& may) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kChooseHold, "choose a hold");
  act.place = near;
  act.count = tries;
  act.may = may;
}

void ActList::Assist(AssistantCommand command) {
  if (command == AssistantCommand::kRelease) {
    Add(SurgeonAct::Kind::kAssist, "assistant: release", 4.0).command = command;
  } else {
    Add(SurgeonAct::Kind::kAssist, "assistant: retract", 8.0).command = command;
  }
}

}  // namespace trocar::agent
