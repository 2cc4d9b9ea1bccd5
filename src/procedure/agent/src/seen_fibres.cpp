// SPDX-License-Identifier: Apache-2.0
#include "seen_fibres.h"
#include "trocar/cholecystectomy/cholecystectomy.h"

#include <algorithm>
#include <utility>

#include "trocar/base/to_integer.h"

namespace trocar::agent {

namespace {

using Kind = scene::StrandInfo::Kind;

constexpr double kBare = 0.0103;          // of each of them, or all that is exposable, for the view [m]
constexpr double kSkeletonised = 0.0125;  // likewise of each tube that enters, from the gallbladder on [m]
constexpr double kOffBed = 0.1;           // of the bed's fibres: with fewer the gallbladder hangs free [-]
constexpr double kPeelShare = 0.2;  // of the bed's fibres that are left: where the gallbladder peels off [-]

bool Covers(Kind kind) {
  return kind == Kind::kTriangle || kind == Kind::kPeritoneum || kind == Kind::kAdhesion;
}

}  // namespace

double ShareLeft(const SurgeonView& view, const std::vector<std::uint32_t>& strands) {
  const auto left =
      std::count_if(strands.begin(), strands.end(), [&](std::uint32_t i) { return view.IsIntact(i); });
  return strands.empty() ? 0.0 : static_cast<double>(left) / static_cast<double>(strands.size());
}

std::vector<std::uint32_t> FindCoveringStrands(const SurgeonView& view) {
  const PatientKnowledge& known = view.known;
  const auto& positions = view.seen.positions;
  std::vector<std::uint8_t> is_end(known.rest.size(), 0);
  for (const std::size_t tube : known.entering) {
    double arc = 0, length = 0;
    const auto& nodes = known.tube_nodes[tube];
    const double wanted = std::min(kBare, known.exposable[tube]);
    // a covered node ends what is bare at the node before it; a tube that is pushed together shows less than at rest
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const bool is_short = length < wanted;
      const bool is_exposable = arc < known.exposable[tube];
      arc += math::Distance(known.rest[nodes[k - 1]], known.rest[nodes[k]]);
      length += math::Distance(positions[nodes[k - 1]], positions[nodes[k]]);
      if (is_short || (is_exposable && arc < kSkeletonised)) is_end[nodes[k]] = 1;
    }
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < known.strands.size(); ++i) {
    const scene::StrandInfo& strand = known.strands[i];
    if (Covers(strand.kind) && (is_end[strand.a] || is_end[strand.b])) found.push_back(i);
  }
  return found;
}

bool AreTubesBare(const SurgeonView& view) {
  const PatientKnowledge& known = view.known;
  if (view.seen.operation.procedure.view.IsWhole(cholecystectomy::kTwoStructures)) return true;
  std::vector<std::uint8_t> is_covered(known.rest.size(), 0);
  for (std::uint32_t i = 0; i < known.strands.size(); ++i) {
    if (Covers(known.strands[i].kind) && view.IsIntact(i))
      is_covered[known.strands[i].a] = is_covered[known.strands[i].b] = 1;
  }
  return std::all_of(known.entering.begin(), known.entering.end(), [&](std::size_t tube) {
    if (view.IsDivided(tube)) return true;
    const auto& nodes = known.tube_nodes[tube];
    double length = 0;
    for (std::size_t k = 1; k < nodes.size() && !is_covered[nodes[k]]; ++k)
      length += math::Distance(view.seen.positions[nodes[k - 1]], view.seen.positions[nodes[k]]);
    return length >= std::min(kBare, known.exposable[tube]);
  });
}

bool IsTriangleClear(const SurgeonView& view) {
  return view.seen.operation.procedure.Measure(cholecystectomy::kClearedShare) >= kCleared &&
         AreTubesBare(view);
}

bool IsLowerThirdFree(const SurgeonView& view) {
  return view.seen.operation.procedure.view.IsWhole(cholecystectomy::kPlate);
}

bool HangsFree(const SurgeonView& view) {
  return ShareLeft(view, view.known.BedStrands(1.0)) < kOffBed;
}

std::vector<std::uint32_t> FindPeelStrands(const SurgeonView& view, const std::vector<std::uint32_t>& bed,
                                           bool is_from_fundus) {
  const PatientKnowledge& known = view.known;
  std::vector<std::pair<double, std::uint32_t>> along;
  for (const std::uint32_t i : bed) {
    if (view.IsIntact(i)) along.emplace_back(known.AlongBed(known.strands[i].a), i);
  }
  std::sort(along.begin(), along.end());
  if (is_from_fundus) std::reverse(along.begin(), along.end());
  along.resize(std::max<std::size_t>(1, base::TruncateTo<std::size_t>(kPeelShare * along.size())));
  std::vector<std::uint32_t> peel;
  for (const auto& [place, strand] : along) peel.push_back(strand);
  return peel;
}

std::vector<collision::Segment> FindWholeEntries(const SurgeonView& view) {
  const PatientKnowledge& known = view.known;
  std::vector<std::uint32_t> whole;  // first nodes of the tubes that are
  for (const std::size_t tube : known.entering) {
    if (!view.IsDivided(tube)) whole.push_back(known.tube_nodes[tube].front());
  }
  std::vector<collision::Segment> entries;
  for (const std::uint32_t i : known.end_strands) {
    const scene::StrandInfo& strand = known.strands[i];
    if (std::find(whole.begin(), whole.end(), strand.a) != whole.end())
      entries.push_back({view.seen.positions[strand.a], view.seen.positions[strand.b]});
  }
  return entries;
}

}  // namespace trocar::agent
