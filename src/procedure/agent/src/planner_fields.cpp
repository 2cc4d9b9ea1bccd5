// SPDX-License-Identifier: Apache-2.0
#include "planner_fields.h"

#include <algorithm>

#include "seen_fibres.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;

namespace {

constexpr int kBladeParts = 4;    // of the way from one point of a duct to the next, for blades beside it
constexpr double kBedStep = 0.2;  // of the bed's fibres, after which the hold is chosen anew [-]

bool IsReached(const SurgeonView& view, const DissectionGoal& goal) {
  switch (static_cast<DissectionEnd>(goal.until)) {
    case DissectionEnd::kParted:
      return false;
    case DissectionEnd::kTriangleClear:
      return IsTriangleClear(view);
    case DissectionEnd::kLowerThirdFree:
      return IsLowerThirdFree(view);
    case DissectionEnd::kBedStep:
      return ShareLeft(view, goal.strands) < goal.left_before - kBedStep;
  }
  return false;
}

/// Points along a duct or artery, `parts` to each of its pieces.
void AddTube(const TubeLine& line, int parts, std::vector<SpreadField::Round>& tubes) {
  for (std::size_t k = 0; k < line.points.size(); ++k) {
    for (int part = 0; part < (k + 1 < line.points.size() ? parts : 1); ++part) {
      const double share = static_cast<double>(part) / parts;
      const std::size_t next = std::min(k + 1, line.points.size() - 1);
      tubes.push_back(
          {math::Lerp(line.points[k], line.points[next], share), std::max(line.radii[k], line.radii[next])});
    }
  }
}

}  // namespace

HoldField SeeHold(const SurgeonView& view, const HoldFilter& may) {
  const auto liver = static_cast<std::size_t>(view.known.liver);
  HoldField field;
  field.organ = &view.known.surfaces[static_cast<std::size_t>(view.known.gallbladder)];
  field.positions = view.seen.positions;
  field.port = view.Hand(kLeft).Port();
  field.jaw_length = view.scene.instruments[kLeft].tool.jaw_length;
  field.spared_clearance = [&view, liver](const collision::Segment& segment, double most) {
    return view.organs.FindTo(liver, view.seen, segment, most);
  };
  field.clearance = [&view](const collision::Segment& segment) { return view.Clearance(segment); };
  field.may = [&view, may](std::uint32_t node) { return view.known.MayHold(may, node); };
  return field;
}

HookField SeeHook(const SurgeonView& view) {
  HookField field;
  field.strands = view.known.strands;
  field.rest = view.known.rest;
  field.positions = view.seen.positions;
  field.is_intact = view.seen.operation.strand_is_intact;
  field.main_ducts = view.known.main_ducts;
  field.careful_nodes = view.known.careful_nodes;
  field.entries = FindWholeEntries(view);
  field.clearance = [&view](const collision::Segment& segment) { return view.Clearance(segment); };
  field.is_reached = [&view](const DissectionGoal& goal) { return IsReached(view, goal); };
  field.X_world_hook = view.Tool(kRight).X_world_tool;
  field.hook_force = view.Tool(kRight).force;
  field.held = {view.Tool(kLeft).is_grasping, view.Tool(kLeft).force};
  field.X_world_lens = view.seen.X_world_laparoscope;
  field.field_of_view = view.scene.laparoscope.field_of_view;
  field.dt = view.scene.tick_seconds;
  return field;
}

SeenSpread SeeSpread(const SurgeonView& view, const Spreading& work) {
  const PatientKnowledge& known = view.known;
  const auto& positions = view.seen.positions;
  SeenSpread found;
  SpreadField& field = found.field;
  for (std::uint32_t i = 0; i < work.strands.size(); ++i) {
    if (!view.IsIntact(work.strands[i])) continue;
    const scene::StrandInfo& strand = known.strands[work.strands[i]];
    field.fibres.push_back({positions[strand.a], positions[strand.b]});
    field.weights.push_back(work.weights[i]);
    found.index.push_back(i);
  }
  for (const TubeLine& line : view.Lines()) AddTube(line, work.is_sharp ? kBladeParts : 1, field.tubes);
  if (work.is_sharp) {
    // what holds duct and artery to the gallbladder
    for (const std::uint32_t i : known.end_strands) {
      for (int part = 0; part <= kBladeParts; ++part) {
        const double share = static_cast<double>(part) / kBladeParts;
        field.tubes.push_back(
            {math::Lerp(positions[known.strands[i].a], positions[known.strands[i].b], share)});
      }
    }
  }
  const HandMotion& hand = view.Hand(kRight);
  field.port = hand.Port();
  field.tip = hand.Tip();
  field.spin = hand.Spin();
  field.tool = &FindSpreadTool(work);
  field.clearance = [&view](const collision::Segment& segment) { return view.Clearance(segment); };
  return found;
}

SpreadSight SeeSpreading(const SurgeonView& view) {
  return {view.seen.operation.strand_is_intact,
          [&view](const Spreading& work) { return SeeSpread(view, work); },
          [&view] { return IsTriangleClear(view); }, view.Tool(kRight).X_world_tool};
}

SeenVessels SeeVessels(const SurgeonView& view) {
  SeenVessels vessels;
  vessels.lines = view.Lines();
  vessels.clips = view.FindClips(vessels.lines);
  for (std::size_t tube = 0; tube < vessels.lines.size(); ++tube)
    vessels.is_divided.push_back(view.IsDivided(tube) ? 1 : 0);
  vessels.port = view.Hand(kRight).Port();
  vessels.clearance = [&view](const collision::Segment& segment) { return view.Clearance(segment); };
  return vessels;
}

}  // namespace trocar::agent
