// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/injury.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::cholecystectomy {
namespace {

using surgery::VesselActs;
using surgery::VesselClip;
using surgery::VesselOpening;

constexpr double kE2Length = 0.020;      // below the confluence [m]
constexpr double kAtConfluence = 0.002;  // as near counts as at it [m]
constexpr double kLeakRate = 1e-12;  // below this nothing leaks: a microlitre in a quarter of an hour [m^3/s]
constexpr double kObstructs = 0.5;   // closure from which a clip on a main duct is an injury

bool IsMainDuct(VesselRole role) noexcept {
  return role == VesselRole::kCommonHepaticDuct || role == VesselRole::kCommonBileDuct ||
         role == VesselRole::kRightHepaticDuct || role == VesselRole::kLeftHepaticDuct;
}

/// Class of a cut through, or a clip across, a main duct.
Strasberg ClassOfDivision(const scene::VesselAnatomy& anatomy, std::uint32_t vessel, double position,
                          double length) noexcept {
  const VesselRole role = anatomy.roles[vessel];
  if (role == VesselRole::kRightHepaticDuct || role == VesselRole::kLeftHepaticDuct) return Strasberg::kE4;
  const double along = anatomy.is_upstream_from[vessel] ? position : length - position;
  const double below = anatomy.below_source[vessel] + along;
  if (below <= kAtConfluence) return Strasberg::kE3;
  return below < kE2Length ? Strasberg::kE2 : Strasberg::kE1;
}

}  // namespace

bool MayBeDivided(VesselRole role) noexcept {
  return std::find(kDividedVessels.begin(), kDividedVessels.end(), role) != kDividedVessels.end();
}

std::string_view StrasbergName(Strasberg injury) noexcept {
  constexpr std::string_view kNames[] = {"none", "A", "B", "C", "D", "E1", "E2", "E3", "E4", "E5"};
  return kNames[static_cast<std::size_t>(injury)];
}

InjuryReport JudgeInjuries(const scene::VesselAnatomy& anatomy, const VesselActs& acts,
                           surgery::FlowNetwork& network) {
  const auto vessels = network.Vessels();
  TROCAR_ASSERT(anatomy.roles.size() == vessels.size() && anatomy.below_source.size() == vessels.size() &&
                anatomy.is_upstream_from.size() == vessels.size());
  InjuryReport report;
  const auto is_placed = [&](std::uint32_t vessel, double position) {
    return vessel < vessels.size() && position >= 0 && position <= vessels[vessel].length;
  };
  bool has_main_division = false, has_aberrant_division = false;
  const auto worsen = [&](Strasberg injury) { report.strasberg = std::max(report.strasberg, injury); };
  const auto note_wrong = [&](std::uint32_t vessel) {
    if (!MayBeDivided(anatomy.roles[vessel])) report.wrong_vessels.push_back(vessel);
  };
  const auto divide = [&](std::uint32_t vessel, double position) {
    worsen(ClassOfDivision(anatomy, vessel, position, vessels[vessel].length));
    has_main_division = true;
  };

  for (const VesselClip& clip : acts.clips) {
    if (!is_placed(clip.vessel, clip.position) || !(clip.closure >= kObstructs)) continue;
    note_wrong(clip.vessel);
    const VesselRole role = anatomy.roles[clip.vessel];
    if (IsMainDuct(role)) divide(clip.vessel, clip.position);
    if (role == VesselRole::kAberrantRightDuct) worsen(Strasberg::kB), has_aberrant_division = true;
  }
  for (const VesselOpening& opening : acts.openings) {
    if (!is_placed(opening.vessel, opening.position)) continue;
    note_wrong(opening.vessel);
    const VesselRole role = anatomy.roles[opening.vessel];
    if (IsMainDuct(role)) {
      opening.is_cut ? divide(opening.vessel, opening.position) : worsen(Strasberg::kD);
    } else if (role == VesselRole::kAberrantRightDuct) {
      has_aberrant_division = has_aberrant_division || opening.is_cut;
    }
  }
  if (has_main_division && has_aberrant_division) worsen(Strasberg::kE5);

  const surgery::FlowReport flow = network.Solve(acts);
  report.bile_rate = flow.rate[static_cast<std::size_t>(surgery::Fluid::kBile)];
  report.blood_rate = flow.rate[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  for (const surgery::Leak& leak : flow.Leaks()) {
    if (leak.rate < kLeakRate) continue;
    const VesselRole role = anatomy.roles[acts.openings[leak.opening].vessel];
    if (role == VesselRole::kCysticDuct || role == VesselRole::kSubvesicalDuct) worsen(Strasberg::kA);
    if (role == VesselRole::kAberrantRightDuct) worsen(Strasberg::kC);
  }
  std::sort(report.wrong_vessels.begin(), report.wrong_vessels.end());
  report.wrong_vessels.erase(std::unique(report.wrong_vessels.begin(), report.wrong_vessels.end()),
                             report.wrong_vessels.end());

  if (anatomy.liver && anatomy.bowel)
    report.drains_no_bile = !network.AreConnected(acts, *anatomy.liver, *anatomy.bowel);
  if (anatomy.aorta && anatomy.right_liver)
    report.is_right_liver_without_blood = !network.AreConnected(acts, *anatomy.aorta, *anatomy.right_liver);
  const auto is_at_gallbladder = [&](std::uint32_t junction) {
    return std::find(anatomy.hollow_organ.begin(), anatomy.hollow_organ.end(), junction) !=
           anatomy.hollow_organ.end();
  };
  for (std::uint32_t v = 0; v < vessels.size(); ++v) {
    if (!is_at_gallbladder(vessels[v].from) && !is_at_gallbladder(vessels[v].to)) continue;
    const bool is_cut = std::any_of(acts.openings.begin(), acts.openings.end(), [&](const VesselOpening& o) {
      return o.vessel == v && o.is_cut && is_placed(v, o.position);
    });
    report.structures_entering += is_cut ? 0 : 1;
  }
  return report;
}

}  // namespace trocar::cholecystectomy
