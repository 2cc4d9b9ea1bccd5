// SPDX-License-Identifier: Apache-2.0
// Blunt dissection: the dissector's jaws open among fibres, beside ducts where no current may flow.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"

namespace trocar::agent {
namespace {

constexpr double kBack = 0.008;       // of the tip before the next spread [m]
constexpr double kOpenSeconds = 1.0;  // that it waits for opening jaws [s]
constexpr std::size_t kFew = 2;       // fibres: a spread that parts fewer was hardly worth it
constexpr int kMostFruitless = 8;     // such spreads in a row
constexpr double kPoor = 0.3;         // of what was hoped for

}  // namespace

/// Works on `spreading_`.
void CholecystectomySurgeon::Spread() {
  spreading_.tries.assign(spreading_.strands.size(), 0);
  Add(SurgeonAct::Kind::kSpread, "spread the hepatocystic triangle", 600.0);
}

bool CholecystectomySurgeon::GoOnSpreading(Spreading& work, const Snapshot& seen) {
  HandMotion& hand = HandOf(kRight);
  const instrument::Tool& tool = *instrument::FindTool("maryland");
  const auto is_intact = [&](std::uint32_t strand) { return seen.operation.strand_is_intact[strand] != 0; };
  const auto left =
      static_cast<std::size_t>(std::count_if(work.strands.begin(), work.strands.end(), is_intact));
  switch (work.stage) {
    case Spreading::Stage::kChoose: {
      if (left == 0 || IsTriangleClear(seen) || work.fruitless >= kMostFruitless) break;
      SpreadField field;
      std::vector<std::uint8_t> tries;
      std::vector<std::uint32_t> index;
      for (std::uint32_t i = 0; i < work.strands.size(); ++i) {
        if (!is_intact(work.strands[i])) continue;
        const StrandInfo& strand = known_.strands[work.strands[i]];
        field.fibres.push_back({seen.positions[strand.a], seen.positions[strand.b]});
        field.weights.push_back(work.weights[i]);
        tries.push_back(work.tries[i]);
        index.push_back(i);
      }
      for (std::size_t t = 0; t < known_.tube_nodes.size(); ++t) {
        const TubeLine line = LineOf(seen, t);
        for (std::size_t k = 0; k < line.points.size(); ++k)
          field.tubes.push_back({line.points[k], line.radii[k]});
      }
      field.port = hand.Port();
      field.tip = hand.Tip();
      field.spin = hand.Spin();
      field.tool = &tool;
      field.clearance = [&](const collision::Segment& segment) { return Clearance(seen, segment); };
      const auto pose = FindSpread(field, tries);
      if (!pose) break;
      work.pose = *pose;
      work.aim = index[pose->aim];
      work.left_before = left;
      hand.Turn(pose->spin);
      hand.SetJaw(kNarrow * tool.max_jaw);
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
      hand.SetJaw(work.pose.opening * tool.max_jaw);
      work.stage = Spreading::Stage::kOpen;
      act_seconds_ = 0;
      return false;
    case Spreading::Stage::kOpen:
      if (hand.IsTurning() && act_seconds_ < kOpenSeconds) return false;
      // the jaws may have been kept off by what they met
      if (static_cast<double>(work.left_before - left) < kPoor * work.pose.worth) ++work.tries[work.aim];
      work.fruitless = work.left_before - left < kFew ? work.fruitless + 1 : 0;
      work.stage = Spreading::Stage::kChoose;
      return false;
  }
  hand.SetJaw(kNarrow * tool.max_jaw);
  return true;
}

}  // namespace trocar::agent
