// SPDX-License-Identifier: Apache-2.0
// Dissection beside ducts, where no current may flow: the dissector's jaws open among fibres, and scissors take the last ones
// that neither jaws nor hook come to, one by one.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {

using instrument::kRight;
using simulation::Snapshot;

namespace {

constexpr double kBack = 0.008;       // of the tip before the next spread [m]
constexpr double kOpenSeconds = 1.0;  // that it waits for opening jaws [s]
constexpr std::size_t kFew = 2;       // fibres: a spread that parts fewer was hardly worth it
constexpr int kMostFruitless = 8;     // such spreads in a row
constexpr double kPoor = 0.3;         // of what was hoped for
constexpr int kBladeParts = 4;        // of the way from one point of a duct to the next, for blades beside it

}  // namespace

/// Works on `spreading_`.
void CholecystectomySurgeon::Spread() {
  spreading_.tries.assign(spreading_.strands.size(), 0);
  Add(SurgeonAct::Kind::kSpread,
      spreading_.is_sharp ? "cut the last fibres" : "spread the hepatocystic triangle", 600.0);
}

/// What lies before the jaws now.
/// \param[out] index  (fibres) among the work's strands
SpreadField CholecystectomySurgeon::SeeSpreadField(const Spreading& work, const Snapshot& seen,
                                                   std::vector<std::uint32_t>& index) {
  SpreadField field;
  for (std::uint32_t i = 0; i < work.strands.size(); ++i) {
    if (seen.operation.strand_is_intact[work.strands[i]] == 0) continue;
    const scene::StrandInfo& strand = known_.strands[work.strands[i]];
    field.fibres.push_back({seen.positions[strand.a], seen.positions[strand.b]});
    field.weights.push_back(work.weights[i]);
    index.push_back(i);
  }
  const int parts = work.is_sharp ? kBladeParts : 1;
  for (std::size_t t = 0; t < known_.tube_nodes.size(); ++t) {
    const TubeLine line = LineOf(seen, t);
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      for (int part = 0; part < (k + 1 < line.points.size() ? parts : 1); ++part) {
        const double share = static_cast<double>(part) / parts;
        const std::size_t next = std::min(k + 1, line.points.size() - 1);
        field.tubes.push_back({math::Lerp(line.points[k], line.points[next], share),
                               std::max(line.radii[k], line.radii[next])});
      }
    }
  }
  if (work.is_sharp) {
    // what holds duct and artery to the gallbladder
    for (const std::uint32_t i : known_.end_strands) {
      for (int part = 0; part <= kBladeParts; ++part) {
        const double share = static_cast<double>(part) / kBladeParts;
        field.tubes.push_back(
            {math::Lerp(seen.positions[known_.strands[i].a], seen.positions[known_.strands[i].b], share)});
      }
    }
  }
  const HandMotion& hand = HandOf(kRight);
  field.port = hand.Port();
  field.tip = hand.Tip();
  field.spin = hand.Spin();
  field.tool = ToolOf(work);
  field.clearance = [&](const collision::Segment& segment) { return Clearance(seen, segment); };
  return field;
}

const instrument::Tool* CholecystectomySurgeon::ToolOf(const Spreading& work) {
  return instrument::FindTool(work.is_sharp ? "scissors" : "maryland");
}

bool CholecystectomySurgeon::GoOnSpreading(Spreading& work, const Snapshot& seen) {
  HandMotion& hand = HandOf(kRight);
  const instrument::Tool& tool = *ToolOf(work);
  const auto is_intact = [&](std::uint32_t strand) { return seen.operation.strand_is_intact[strand] != 0; };
  const auto left =
      static_cast<std::size_t>(std::count_if(work.strands.begin(), work.strands.end(), is_intact));
  switch (work.stage) {
    case Spreading::Stage::kChoose: {
      if (left == 0 || IsTriangleClear(seen) || work.fruitless >= kMostFruitless) break;
      std::vector<std::uint32_t> index;
      const SpreadField field = SeeSpreadField(work, seen, index);
      std::vector<std::uint8_t> tries;
      for (const std::uint32_t i : index) tries.push_back(work.tries[i]);
      const auto pose = work.is_sharp ? FindSnip(field, tries) : FindSpread(field, tries);
      if (!pose) break;
      work.pose = *pose;
      work.aim = index[pose->aim];
      work.left_before = left;
      hand.Turn(pose->spin);
      hand.SetJaw((work.is_sharp ? pose->opening : kNarrow) * tool.max_jaw);
      hand.MoveTo(pose->tip + kBack * math::Normalized(hand.Port() - pose->tip));
      work.stage = Spreading::Stage::kApproach;
      return false;
    }
    case Spreading::Stage::kApproach:
      if (hand.IsMoving() || hand.IsTurning()) return false;
      hand.MoveTo(work.pose.tip, 0.6);
      work.stage = Spreading::Stage::kEnter;
      return false;
    case Spreading::Stage::kEnter:
      if (hand.IsMoving()) return false;
      if (work.is_sharp && !MayClose(work, seen)) {
        ++work.tries[work.aim];
        ++work.fruitless;
        work.stage = Spreading::Stage::kChoose;
        return false;
      }
      hand.SetJaw(work.is_sharp ? 0.0 : work.pose.opening * tool.max_jaw);
      work.stage = Spreading::Stage::kOpen;
      act_seconds_ = 0;
      return false;
    case Spreading::Stage::kOpen:
      if (hand.IsTurning() && act_seconds_ < kOpenSeconds) return false;
      // the jaws may have been kept off by what they met
      if (work.is_sharp ? is_intact(work.strands[work.aim])
                        : static_cast<double>(work.left_before - left) < kPoor * work.pose.worth)
        ++work.tries[work.aim];
      work.fruitless = work.left_before - left < (work.is_sharp ? 1 : kFew) ? work.fruitless + 1 : 0;
      work.stage = Spreading::Stage::kChoose;
      return false;
  }
  hand.SetJaw(kNarrow * tool.max_jaw);
  return true;
}

/// Whether the blades, as they stand now, would take the fibre that is meant and nothing that must stay.
bool CholecystectomySurgeon::MayClose(const Spreading& work, const Snapshot& seen) {
  std::vector<std::uint32_t> index;
  const SpreadField field = SeeSpreadField(work, seen, index);
  const auto aim = std::find(index.begin(), index.end(), work.aim);
  return aim != index.end() && FindSnipRoom(field, static_cast<std::size_t>(aim - index.begin()),
                                            seen.instruments[kRight].X_world_tool, work.pose.opening);
}

}  // namespace trocar::agent
