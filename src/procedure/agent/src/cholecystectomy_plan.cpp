// SPDX-License-Identifier: Apache-2.0
// The operation, part by part; each part looks at what has come of it and goes on until it is enough.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using roles::TubeRole;
using scene::AssistantCommand;
using simulation::InstrumentSnapshot;
using simulation::Snapshot;

namespace {

using instrument::ToolKind;

constexpr double kLowerShare = 0.44;  // of the bed that is freed before the view [-]
constexpr int kRounds = 4, kBedRounds = 12, kRoundsOfWay = 2;
constexpr double kPedicleWeight = 3.0;  // of fibres on the cystic duct and artery, among others
constexpr double kBesideView = 0.05;    // of a tool, out of the way of the view [m]
constexpr double kGrip = 0.07;          // of the jaws: 14 N of pinch
/// Of the hold about the duct, so that tools come to the other side of the triangle [m].
constexpr double kOpenNeck = 0.014;
constexpr double kSwungAside = 0.050;  // of a gallbladder that hangs free, off the hook's way [m]
constexpr double kPeelShare = 0.2;  // of the bed's fibres that are left: where the gallbladder peels off [-]
/// How far the flap is folded back at first [m], and how steeply [-].
constexpr double kFold = 0.030, kFoldUp = 0.6;
constexpr double kOutOfTheWay = 0.080;  // of a tool that waits while the bag leaves [m]

}  // namespace

void CholecystectomySurgeon::PlanOperation() {
  FreeGallbladder();
  Remove();
}

/// From the first look until the gallbladder hangs on nothing.
void CholecystectomySurgeon::FreeGallbladder() {
  const Place neck = Place::AtNode(known_.neck);
  picture_.follows = true;
  Add(SurgeonAct::Kind::kAssist, "assistant: retract", 8.0).command = AssistantCommand::kRetract;
  LookAt(neck, 0.0, 0.090);
  HoldOn(neck);
  const std::size_t duct = FindTube(TubeRole::kCysticDuct);
  const Vec3 duct_way = math::Normalized(known_.rest[known_.tube_nodes[duct].front()] -
                                         known_.rest[known_.tube_nodes[duct].back()]);
  DrawGently(kLeft, 0.006 * duct_way + 0.003 * known_.bed_normal);
  ClearTriangle(kRounds);
  FreeLowerThird(kRounds);
  ShowCriticalView(kRounds);
  // without the view nothing is clipped; a gallbladder that is still tied is not taken off its bed
  Decide(SurgeonAct::Kind::kTimeOut, "time-out");
  Divide(known_.entering);
  StopBleeding();
  Decide(SurgeonAct::Kind::kCheckStumps, "look at the stumps");
  FreeFromBed(kBedRounds);
}

/// Takes the gallbladder with the left hand, clear of the liver, and again elsewhere when nothing was taken.
void CholecystectomySurgeon::HoldOn(const Place& near, int tries, const HoldFilter& may) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kChooseHold, "choose a hold");
  act.place = near;
  act.count = tries;
  act.may = may;
}

void CholecystectomySurgeon::ChooseHold(const SurgeonAct& act, const Snapshot& seen) {
  if (act.count <= 0) return;
  if (seen.instruments[kLeft].is_grasping) LetGo(kLeft);
  SurgeonAct& next = Decide(SurgeonAct::Kind::kTakeHold, act.doing);
  next.place = act.place;
  next.count = act.count;
  next.may = act.may;
}

void CholecystectomySurgeon::TakeHold(const SurgeonAct& act, const Snapshot& seen) {
  const std::uint32_t node = FindHold(seen, Find(act.place, seen), missed_holds_, act.may);
  Grasp(kLeft, Place::AtNode(node), kGrip);
  SurgeonAct& next = Decide(SurgeonAct::Kind::kCheckHold, "look at the hold");
  next.place = act.place;
  next.count = act.count;
  next.may = act.may;
  next.node = node;
}

void CholecystectomySurgeon::CheckHold(const SurgeonAct& act, const Snapshot& seen) {
  const InstrumentSnapshot& hand = seen.instruments[kLeft];
  if (hand.is_grasping && hand.organ == known_.gallbladder) return;
  missed_holds_.push_back(act.node);
  LetGo(kLeft);
  HoldOn(act.place, act.count - 1, act.may);
}

/// The hepatocystic triangle: bluntly, beside ducts too; what is left elsewhere, with the hook.
/// \param is_second_look  the critical view was looked for and not found
void CholecystectomySurgeon::ClearTriangle(int rounds, bool is_second_look) {
  SurgeonAct& act = Decide(SurgeonAct::Kind::kClearTriangle, "look at the triangle");
  act.count = rounds;
  act.is_on = is_second_look;
}

void CholecystectomySurgeon::PlanTriangle(const SurgeonAct& act, const Snapshot& seen) {
  std::vector<std::uint32_t> fat = known_.window_strands;
  std::vector<std::uint32_t> covering;
  if (!AreTubesBare(seen)) covering = CoveringStrands(seen);
  const bool is_clear = seen.operation.facts.cleared_share >= kCleared && covering.empty();
  if (is_clear) return;
  if (act.count <= 0) return OpenTriangle(act, seen);
  Spreading work;
  work.strands = covering;
  work.weights.assign(covering.size(), kPedicleWeight);
  for (const std::uint32_t i : fat) {
    if (std::find(covering.begin(), covering.end(), i) != covering.end()) continue;
    work.strands.push_back(i);
    work.weights.push_back(1.0);
  }
  spreading_ = std::move(work);
  Take(ToolKind::kDissector);
  Spread();
  SurgeonAct& next = Decide(SurgeonAct::Kind::kCheckTriangle, "look at the triangle");
  next.strands = std::move(fat);
  next.count = act.count;
  next.is_on = act.is_on;
}

void CholecystectomySurgeon::CheckTriangle(const SurgeonAct& act, const Snapshot& seen) {
  if (!IsTriangleClear(seen)) {
    std::vector<std::uint32_t> left = act.strands;
    if (!AreTubesBare(seen)) {
      const std::vector<std::uint32_t> over = CoveringStrands(seen);
      left.insert(left.end(), over.begin(), over.end());
    }
    std::vector<double> order;
    // the front first
    for (const std::uint32_t i : left)
      order.push_back(-0.25 * (known_.rest[known_.strands[i].a] + known_.rest[known_.strands[i].b]).z);
    DissectionGoal goal{"the hepatocystic triangle", left, order, 1.0, DissectionGoal::Until::kTriangleClear};
    if (HangsFree(seen)) SwingOutOfWay(seen, goal);
    Take(ToolKind::kHook);
    Dissect(std::move(goal));
  }
  ClearTriangle(act.count - 1, act.is_on);
}

/// A gallbladder that is off its bed stands before the triangle: the assistant lets go of it, and the left hand swings it by
/// the fundus off the hook's way.
void CholecystectomySurgeon::SwingOutOfWay(const Snapshot& seen, DissectionGoal& goal) {
  Add(SurgeonAct::Kind::kAssist, "assistant: release", 4.0).command = AssistantCommand::kRelease;
  goal.may = {HoldFilter::Kind::kFundus, std::numeric_limits<double>::infinity()};
  HoldOn(Place::Of(Place::Kind::kGallbladder), kHoldTries, goal.may);
  const Vec3 duct = TubePoint(seen, FindTube(TubeRole::kCysticDuct), 0.0);
  const Vec3 in = math::Normalized(duct - hands_[kRight].Port());
  const Vec3 off = seen.positions[known_.fundus] - duct;
  goal.traction = kSwungAside;
  goal.way = math::Normalized(off - math::Dot(off, in) * in, known_.bed_normal);
}

/// Fat that neither tool comes to lies behind the duct or under the neck: the left hand turns the neck to one side, then to
/// the other, and takes it elsewhere, as far as ways are left.
void CholecystectomySurgeon::OpenTriangle(const SurgeonAct& act, const Snapshot& seen) {
  // fibres on duct and artery alone may come off with the lower third
  const bool is_fat_left = seen.operation.facts.cleared_share < kCleared;
  if (!is_fat_left && !act.is_on) return;
  if ((!is_fat_left || triangle_ways_left_ <= 0) && CutLastFibres(act, seen)) return;
  if (triangle_ways_left_ <= 0) return;
  const int way = kTriangleWays - triangle_ways_left_--;
  if (way >= kTriangleWays / 2) HoldOn(Place::AtNode(known_.neck));
  SurgeonAct& turn = Decide(SurgeonAct::Kind::kTurnNeck, "turn the neck");
  turn.side = way % 2 == 0 ? 1 : -1;
  // the second way comes from the first one's side
  turn.amount = way == 1 ? 2 * kOpenNeck : kOpenNeck;
  ClearTriangle(kRoundsOfWay, act.is_on);
}

/// A fibre in the corner between duct, artery and gallbladder is too near to them for jaws that open and for current: scissors
/// take it.
/// \return whether there is one that they come to, and they were planned
bool CholecystectomySurgeon::CutLastFibres(const SurgeonAct& act, const Snapshot& seen) {
  if (sharp_rounds_left_ <= 0) return false;
  Spreading work;
  work.is_sharp = true;
  for (const std::uint32_t i : CoveringStrands(seen))
    if (seen.operation.strand_is_intact[i] != 0) work.strands.push_back(i);
  if (seen.operation.facts.cleared_share < kCleared) {
    for (const std::uint32_t i : known_.window_strands) {
      const bool is_new = std::find(work.strands.begin(), work.strands.end(), i) == work.strands.end();
      if (is_new && seen.operation.strand_is_intact[i] != 0) work.strands.push_back(i);
    }
  }
  work.weights.assign(work.strands.size(), 1.0);
  std::vector<std::uint32_t> index;
  const SpreadField field = SeeSpreadField(work, seen, index);
  if (!FindSnip(field, std::vector<std::uint8_t>(index.size(), 0))) return false;
  --sharp_rounds_left_;
  spreading_ = std::move(work);
  Take(ToolKind::kScissors);
  Spread();
  ClearTriangle(0, act.is_on);
  return true;
}

/// Draws what the left hand holds about the cystic duct.
/// \param side  from where the neck is to be seen, +1 or -1
/// \param turn  of the hold about the duct [rad]
void CholecystectomySurgeon::TurnNeck(const Snapshot& seen, int side, double by, double turn) {
  if (!seen.instruments[kLeft].is_grasping) return;
  const std::size_t duct = FindTube(TubeRole::kCysticDuct);
  const Vec3 axis = math::Normalized(TubePoint(seen, duct, 0.0) - TubePoint(seen, duct, 1.0));
  const HandMotion& hand = HandOf(kLeft);
  const Vec3 arm = hand.Tip() - TubePoint(seen, duct, 0.0);
  const Vec3 off_axis = math::Normalized(arm - math::Dot(arm, axis) * axis, known_.bed_normal);
  DrawGently(kLeft, -side * by * math::Cross(axis, off_axis),
             FindRoll(hand.Port(), hand.Tip(), axis, -side * turn));
}

void CholecystectomySurgeon::FreeLowerThird(int rounds) {
  Decide(SurgeonAct::Kind::kFreeLowerThird, "look at the bed").count = rounds;
}

void CholecystectomySurgeon::PlanLowerThird(const SurgeonAct& act, const Snapshot& seen) {
  const std::vector<std::uint32_t> lower = BedStrands(kLowerShare);
  const bool is_enough = seen.operation.critical_view.criteria[1] == 2;
  if (is_enough || ShareLeft(seen, lower) == 0.0) return;
  if (act.count <= 0) {
    if (!has_begun_at_fundus_) FreeFromFundus(kBedRounds);
    return;
  }
  const Vec3 axis = BedAxis();
  const std::vector<double> order = BedOrder(lower);
  // by the infundibulum, which is drawn off the liver, to the sides and back over what is not free
  const Vec3 back = math::Normalized(axis - math::Dot(axis, known_.bed_normal) * known_.bed_normal);
  const Vec3 way = math::Normalized(known_.bed_normal + back);
  Take(ToolKind::kHook);
  HoldOn(MiddleOf(PeelStrands(seen, lower)), kHoldTries, {HoldFilter::Kind::kInfundibulum});
  DrawGently(kLeft, 0.010 * way);
  Dissect(
      {"the lower third of the bed", lower, order, 0.97, DissectionGoal::Until::kLowerThirdFree, 0.028, way});
  FreeLowerThird(act.count - 1);
}

/// Where the lower third does not come off from the infundibulum on: from the fundus on, until it does. The assistant lets
/// go of the fundus meanwhile.
void CholecystectomySurgeon::FreeFromFundus(int rounds) {
  has_begun_at_fundus_ = true;
  Add(SurgeonAct::Kind::kAssist, "assistant: release", 4.0).command = AssistantCommand::kRelease;
  Decide(SurgeonAct::Kind::kFundusFirst, "fundus first").count = rounds;
  Add(SurgeonAct::Kind::kAssist, "assistant: retract", 8.0).command = AssistantCommand::kRetract;
}

void CholecystectomySurgeon::PlanFundusFirst(const SurgeonAct& act, const Snapshot& seen) {
  const std::vector<std::uint32_t> bed = BedStrands(1.0);
  const bool is_enough = seen.operation.critical_view.criteria[1] == 2;
  const double share_left = ShareLeft(seen, bed);
  const bool has_gained = act.amount == 0.0 || share_left < act.amount;
  if (is_enough || share_left == 0.0 || act.count <= 0 || !has_gained) return;
  const Vec3 axis = BedAxis();
  const std::vector<std::uint32_t> peel = PeelStrands(seen, bed, true);
  const Place left = MiddleOf(peel);
  const HoldFilter is_free{
      HoldFilter::Kind::kFundus,
      math::Dot(known_.rest[known_.strands[peel[peel.size() / 2]].a] - known_.rest[known_.neck], axis)};
  const Vec3 back = math::Normalized(axis - math::Dot(axis, known_.bed_normal) * known_.bed_normal);
  const Vec3 fold = math::Normalized(kFoldUp * known_.bed_normal - back);
  Take(ToolKind::kHook);
  LookAt(left, 0.0, 0.100);
  HoldOn(left, kHoldTries, is_free);
  DrawGently(kLeft, kFold * fold);
  Dissect({"the gallbladder from the fundus on", bed, BedOrder(bed, true), 1.0,
           DissectionGoal::Until::kBedStep, 0.070, fold, is_free, share_left});
  SurgeonAct& next = Decide(SurgeonAct::Kind::kFundusFirst, "fundus first");
  next.count = act.count - 1;
  next.amount = share_left;
}

/// Both views; where something is missing, back to it first. A second cystic artery is divided before: only two structures
/// may be left.
void CholecystectomySurgeon::ShowCriticalView(int rounds) {
  Decide(SurgeonAct::Kind::kShowCriticalView, "look for what is missing").count = rounds;
}

void CholecystectomySurgeon::PlanCriticalView(const SurgeonAct& act, const Snapshot& seen) {
  if (seen.operation.critical_view.IsAchieved() || act.count <= 0) return;
  ClearTriangle(2, act.count < kRounds);
  FreeLowerThird(2);
  Decide(SurgeonAct::Kind::kDivideExtraArtery, "count what enters");
  Place out_of_the_way = Place::AtNode(known_.neck);
  out_of_the_way.back = kBesideView;
  Reach(kRight, out_of_the_way);
  Decide(SurgeonAct::Kind::kFollowWithCamera, "look").is_on = false;
  for (const int side : {+1, -1}) LookFromSide(side);
  LookAt(Place::OnTube(FindTube(TubeRole::kCysticDuct), 0.4), 0.0, 0.080);
  Decide(SurgeonAct::Kind::kFollowWithCamera, "look").is_on = true;
  ShowCriticalView(act.count - 1);
}

/// Where more than two structures enter, an artery that can be divided.
std::optional<std::size_t> CholecystectomySurgeon::FindExtraArtery(const Snapshot& seen) {
  std::vector<std::size_t> arteries;
  for (const std::size_t tube : known_.entering) {
    const bool is_artery = scene_->patient.tubes[tube].kind == patient::TubeKind::kArtery;
    if (is_artery && !IsDivided(seen, tube)) arteries.push_back(tube);
  }
  if (arteries.size() < 2) return std::nullopt;
  const std::vector<TubeLine> lines = LinesOf(seen);
  for (const double care : {1.0, 0.7, 0.4}) {
    for (const std::size_t tube : arteries) {
      const auto step = FindNextStep(FieldOf(seen, tube, lines, care), ClipsOn(seen, tube), {});
      if (step.kind != DivisionStep::Kind::kNone) return tube;
    }
  }
  return arteries.back();
}

/// What comes first where the bed is opened from the infundibulum or from the fundus on [m].
std::vector<double> CholecystectomySurgeon::BedOrder(const std::vector<std::uint32_t>& bed,
                                                     bool is_from_fundus) const {
  const Vec3 axis = BedAxis();
  std::vector<double> order;
  for (const std::uint32_t i : bed) {
    const double along = 0.5 * math::Dot(known_.rest[known_.strands[i].a] - known_.rest[known_.neck], axis);
    order.push_back(is_from_fundus ? -along : along);
  }
  return order;
}

/// The first fibres of those that are left, from the neck or from the fundus on: there the gallbladder peels off. At least
/// one.
/// \pre one is left
std::vector<std::uint32_t> CholecystectomySurgeon::PeelStrands(const Snapshot& seen,
                                                               const std::vector<std::uint32_t>& bed,
                                                               bool is_from_fundus) const {
  const Vec3 axis = math::Normalized(known_.rest[known_.fundus] - known_.rest[known_.neck]);
  std::vector<std::pair<double, std::uint32_t>> along;
  for (const std::uint32_t i : bed) {
    if (seen.operation.strand_is_intact[i])
      along.emplace_back(math::Dot(known_.rest[known_.strands[i].a] - known_.rest[known_.neck], axis), i);
  }
  std::sort(along.begin(), along.end());
  if (is_from_fundus) std::reverse(along.begin(), along.end());
  along.resize(std::max<std::size_t>(1, static_cast<std::size_t>(kPeelShare * along.size())));
  std::vector<std::uint32_t> peel;
  for (const auto& [place, strand] : along) peel.push_back(strand);
  return peel;
}

/// The middle of the gallbladder's ends of fibres.
Place CholecystectomySurgeon::MiddleOf(std::vector<std::uint32_t> strands) const {
  Place place = Place::Of(Place::Kind::kStrands);
  place.strands = std::move(strands);
  return place;
}

/// The gallbladder off its bed: holds change, because the old one may have slipped and what is free is drawn elsewhere.
void CholecystectomySurgeon::FreeFromBed(int rounds) {
  Decide(SurgeonAct::Kind::kFreeFromBed, "look at the bed").count = rounds;
}

void CholecystectomySurgeon::PlanBed(const SurgeonAct& act, const Snapshot& seen) {
  const std::vector<std::uint32_t> bed = BedStrands(1.0);
  if (ShareLeft(seen, bed) == 0.0) return;
  if (act.count <= 0)
    return BailOut(
        "duct and artery are divided, but the gallbladder does not come off its bed whatever it is held by");
  const Vec3 axis = BedAxis();
  const std::vector<double> order = BedOrder(bed);
  const std::vector<std::uint32_t> peel = PeelStrands(seen, bed);
  const Place left = MiddleOf(peel);
  // what is free is folded back over what is not: there the fibres lie open
  const HoldFilter is_free{
      HoldFilter::Kind::kFree,
      math::Dot(known_.rest[known_.strands[peel[peel.size() / 2]].a] - known_.rest[known_.neck], axis)};
  const Vec3 back = math::Normalized(axis - math::Dot(axis, known_.bed_normal) * known_.bed_normal);
  const Vec3 fold = math::Normalized(kFoldUp * known_.bed_normal + back);
  Take(ToolKind::kHook);
  LookAt(left, 0.0, 0.100);
  HoldOn(left, kHoldTries, is_free);
  DrawGently(kLeft, kFold * fold);
  Dissect({"the gallbladder from its bed", bed, order, 1.0, DissectionGoal::Until::kBedStep, 0.070, fold,
           is_free, ShareLeft(seen, bed)});
  FreeFromBed(act.count - 1);
}

/// Ends the operation here: what is done is safe, and a person would convert it or ask for help.
void CholecystectomySurgeon::BailOut(std::string reason) {
  stops_ = true;
  bail_out_ = std::move(reason);
  LeaveFibre(dissection_);
}

/// What keeps the critical view away, as it looks to the surgeon.
std::string CholecystectomySurgeon::ExplainMissingView(const Snapshot& seen) const {
  const cholecystectomy::CriticalViewScore& score = seen.operation.critical_view;
  const auto percent = [](double share) { return std::to_string(std::lround(100 * share)) + " %"; };
  std::string why;
  const auto add = [&](const std::string& text) { why += (why.empty() ? "" : "; ") + text; };
  if (score.criteria[0] < 2)
    add("beside what must stay no tool reaches the rest of the fat: " +
        percent(seen.operation.facts.cleared_share) + " of the triangle's window is clear");
  if (score.criteria[1] < 2) {
    add(std::string("the lower third does not come off the cystic plate") +
        (has_begun_at_fundus_ ? ", from the fundus on neither" : "") + ": " +
        percent(seen.operation.facts.detached_share) + " of the bed is free");
  }
  if (score.criteria[2] < 2)
    add(std::to_string(seen.operation.facts.structures_entering) +
        " structures enter the gallbladder, and not each of them could be bared");
  if (score.Sum() == 6) add("front and back of the triangle could not both be brought into the picture");
  return "no critical view: " + why;
}

void CholecystectomySurgeon::Remove() {
  Add(SurgeonAct::Kind::kAssist, "assistant: release", 4.0).command = AssistantCommand::kRelease;
  DrawGently(kLeft, 0.03 * known_.bed_normal);
  const Place middle = Place::Of(Place::Kind::kGallbladder);
  LookAt(middle, 0.0, 0.100);
  Exchange(kRight, ToolKind::kBag);
  Reach(kRight, middle);
  Add(SurgeonAct::Kind::kCloseBag, "close the bag", 4.0);
  LetGo(kLeft);
  // the bag goes by where the left hand's tool lies
  Reach(kLeft, Place::BehindTip(kLeft, kOutOfTheWay));
  Exchange(kRight, ToolKind::kHook);
  // it ends with the bag outside, not with a tool's jaws
  acts_.pop_back();
  acts_.back().kind = SurgeonAct::Kind::kTakeOut;
}

}  // namespace trocar::agent
