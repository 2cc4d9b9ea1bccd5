// SPDX-License-Identifier: Apache-2.0
#include "division_planner.h"

#include <algorithm>
#include <cmath>

#include "state_fields.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

constexpr double kStandOff = 0.012;      // of a tool's tip from the vessel while it is lined up [m]
constexpr double kFromTips = 0.0004;     // of a flattened vessel's edge from the ends of the legs [m]
constexpr double kBetweenLegs = 0.0012;  // of a vessel's axis from the legs' middle line [m]
constexpr double kMostOff = 0.004;       // by which a hand aims beside what it wants to meet [m]

}  // namespace

void Division::VisitState(base::StateArchive& archive) {
  archive.Field("tubes", tubes);
  archive.Field("avoid", avoid);
  archive.Field("acts_left", acts_left);
  archive.Field("care", care);
}

Vec3 JawAim::FindTip(const Vec3& p_world_port, const Vec3& p, double jaw_length) const noexcept {
  return PointBeyond(p_world_port, p, beyond * jaw_length) + offset;
}

void JawAim::Correct(const Pose& X_world_tool, const Vec3& p, double jaw_length) noexcept {
  const Vec3 middle = X_world_tool * Vec3{0, 0, beyond * jaw_length};
  const Vec3 off = offset + p - middle;
  offset = math::Norm(off) > kMostOff ? kMostOff * math::Normalized(off) : off;
}

DivisionField SeenVessels::FieldOf(std::size_t tube, double care) const {
  DivisionField field;
  field.care = care;
  field.tube = &lines[tube];
  for (std::size_t other = 0; other < lines.size(); ++other) {
    // a stump gives way
    if (other == tube || (care < 1.0 && is_divided[other])) continue;
    field.others.push_back(&lines[other]);
  }
  field.port = port;
  field.applier = instrument::FindTool("clip_applier");
  field.scissors = instrument::FindTool("scissors");
  field.clearance = clearance;
  return field;
}

std::optional<NextDivision> FindNext(const SeenVessels& vessels, const Division& work) {
  std::vector<DivisionStep> steps;
  for (std::size_t which = 0; which < work.tubes.size(); ++which) {
    const std::size_t tube = work.tubes[which];
    steps.push_back(vessels.is_divided[tube] ? DivisionStep{}
                                             : FindNextStep(vessels.FieldOf(tube, work.care),
                                                            vessels.clips[tube], work.avoid[which]));
  }
  for (const auto kind : {DivisionStep::Kind::kClip, DivisionStep::Kind::kCut}) {
    for (std::size_t which = 0; which < steps.size(); ++which) {
      if (steps[which].kind == kind) return NextDivision{which, steps[which]};
    }
  }
  return std::nullopt;
}

HandGoal LineUpClip(const SeenVessels& vessels, std::size_t tube, double arc, double care, JawAim& aim) {
  aim.offset = {};
  aim.beyond = FindClip(vessels.FieldOf(tube, care), arc).value_or(0.5);
  const TubeLine& line = vessels.lines[tube];
  return LineUpAcross(vessels.port, line.At(arc), line.DirectionAt(arc), kStandOff,
                      instrument::FindTool("clip_applier")->max_jaw);
}

std::optional<HandGoal> LineUpScissors(const SeenVessels& vessels, std::size_t tube, double arc, double care,
                                       JawAim& aim) {
  aim.offset = {};
  const auto pose = FindCut(vessels.FieldOf(tube, care), arc);
  if (!pose) return std::nullopt;
  aim.beyond = pose->beyond;
  HandGoal goal;
  goal.spin = pose->spin;
  goal.jaw = pose->jaw;
  goal.tip = PointBeyond(vessels.port, vessels.lines[tube].At(arc), -kStandOff);
  return goal;
}

bool IsBetweenLegs(const SeenVessels& vessels, std::size_t tube, const Pose& X_world_tool, double care) {
  const double length = instrument::FindTool("clip_applier")->jaw_length;
  const collision::Segment legs{X_world_tool.translation, X_world_tool * Vec3{0, 0, length}};
  const std::vector<TubeLine>& lines = vessels.lines;
  const TubeLine::Near near = lines[tube].FindNearest(legs);
  const Vec3 in = math::Inverse(X_world_tool) * lines[tube].At(near.arc);
  // closed, it is half its girth wide
  const double half = 0.5 * M_PI * lines[tube].RadiusAt(near.arc) + kFromTips;
  bool is_good = near.distance < kBetweenLegs && in.z > half && in.z < length - half;
  for (std::size_t other = 0; other < lines.size(); ++other) {
    // a stump may come between, but not in the place of the vessel
    const double room = care < 1.0 && vessels.is_divided[other] ? 0.0 : care * kBetweenLegs;
    if (other != tube && lines[other].FindNearest(legs).distance < near.distance + room) is_good = false;
  }
  for (const double clip : vessels.clips[tube])
    if (std::fabs(clip - near.arc) < kLeastGap) is_good = false;
  return is_good;
}

bool IsCutSafe(const SeenVessels& vessels, std::size_t tube, const Pose& X_world_tool) {
  const double length = instrument::FindTool("scissors")->jaw_length;
  const double here =
      vessels.lines[tube]
          .FindNearest(collision::Segment{X_world_tool.translation, X_world_tool * Vec3{0, 0, length}})
          .arc;
  const std::vector<double>& clips = vessels.clips[tube];
  const auto distal = std::count_if(clips.begin(), clips.end(), [&](double clip) { return clip < here; });
  return distal >= 1 && static_cast<std::ptrdiff_t>(clips.size()) - distal >= 2;
}

void AvoidAround(Division& work, std::size_t which, double arc) {
  for (const double gaps : {-1.0, -0.5, 0.0, 0.5, 1.0}) work.avoid[which].push_back(arc + gaps * kLeastGap);
}

}  // namespace trocar::agent
