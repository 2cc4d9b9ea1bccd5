// SPDX-License-Identifier: Apache-2.0
#include "division_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trocar/agent/hand_motion.h"
#include "trocar/base/to_integer.h"
#include "trocar/collision/segment_distance.h"
#include "trocar/geometry/distance.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using math::Vec3;

namespace {

using collision::Segment;
using math::Pose;

constexpr double kStep = 0.0004;          // between the places that are looked at [m]
constexpr double kFromWall = 0.0020;      // of a clip, from the organ [m]
constexpr double kFromJunction = 0.0025;  // of a clip, from the axis of the vessel that this one joins [m]
constexpr double kBesideLegs = 0.0017;    // of another vessel's axis, beside the legs' middle line [m]
constexpr double kBesideBlades = 0.0007;  // of anything else, beside the open blades [m]
constexpr double kWiderThan = 0.0010;     // than the vessel, on either side, blades are opened [m]
constexpr double kOwnLoop = 0.005;        // along the tube: farther off it is as another one [m]
constexpr double kShaftWay = 0.09;        // of the shaft, beyond the tip, which has to be clear [m]
constexpr double kTried = 0.0007;         // a place this near to one that failed is the same [m]
/// Between neighbours among clips and cut, the best first [m].
constexpr double kGaps[] = {0.0035, 0.0030, 0.0026, 0.0022, 0.0019, kLeastGap};
constexpr double kSpins[] = {0.0, 0.35, -0.35, 0.7, -0.7};
/// Shares of legs and blades at which a vessel is taken, the best first: the less of them is beyond it, the less else
/// lies there.
constexpr double kLegShares[] = {0.5, 0.4, 0.3, 0.22, 0.6, 0.7}, kBladeShares[] = {0.4, 0.3, 0.2, 0.12};
constexpr double kNotYet = 0.1;       // share of the blades that still close before they come to the vessel
constexpr double kFromEnds = 0.0006;  // of a flattened vessel's edge from the ends of the legs [m]

Vec3 ShaftDirection(const DivisionField& field, double arc) {
  return math::Normalized(field.tube->At(arc) - field.port, {0, 0, -1});
}

/// Triangle that open blades sweep.
struct Blades {
  Vec3 hinge, upper, lower;

  bool IsNear(const Vec3& p, double distance) const {
    return math::Distance(p, geometry::FindNearestOnTriangle(p, hinge, upper, lower).point) < distance;
  }
  double Clearance(const std::function<double(const Segment&)>& clearance) const {
    return std::min({clearance({hinge, upper}), clearance({hinge, lower}), clearance({upper, lower})});
  }
};

bool IsNearLine(const Blades& blades, const TubeLine& line, double beside, double from, double to) {
  double arc = 0;
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const double length = math::Distance(line.points[i], line.points[i + 1]);
    constexpr int kParts = 4;
    for (int part = 0; part < kParts; ++part) {
      const double t = static_cast<double>(part) / kParts, here = arc + t * length;
      if (here > from && here < to) continue;
      if (blades.IsNear(math::Lerp(line.points[i], line.points[i + 1], t), line.radii[i] + beside))
        return true;
    }
    arc += length;
  }
  return false;
}

bool IsApart(double arc, std::span<const double> others, double gap) {
  return std::none_of(others.begin(), others.end(),
                      [&](double other) { return std::fabs(other - arc) < gap; });
}

}  // namespace

double TubeLine::Length() const {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += math::Distance(points[i - 1], points[i]);
  return length;
}

Vec3 TubeLine::At(double arc) const {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = math::Distance(points[i - 1], points[i]);
    if (arc <= length || i + 1 == points.size())
      return math::Lerp(points[i - 1], points[i], length > 0.0 ? std::clamp(arc / length, 0.0, 1.0) : 0.0);
    arc -= length;
  }
  return points.front();
}

double TubeLine::RadiusAt(double arc) const {
  const double share = std::clamp(arc / std::max(1e-9, Length()), 0.0, 1.0);
  return radii[base::RoundTo<std::size_t>(share * static_cast<double>(radii.size() - 1))];
}

Vec3 TubeLine::DirectionAt(double arc) const {
  constexpr double kOver = 0.002;
  return math::Normalized(At(arc + kOver) - At(arc - kOver), {1, 0, 0});
}

TubeLine::Near TubeLine::FindNearest(const Segment& segment) const {
  Near best{0, std::numeric_limits<double>::infinity()};
  double arc = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto near = collision::FindNearestSegmentSegment({points[i - 1], points[i]}, segment);
    const double length = math::Distance(points[i - 1], points[i]);
    if (const double distance = std::sqrt(near.squared_distance); distance < best.distance)
      best = {arc + near.parameter_a * length, distance};
    arc += length;
  }
  return best;
}

TubeLine::Near TubeLine::FindNearest(const Vec3& p) const {
  return FindNearest(Segment{p, p});
}

namespace {

/// Whether jaws and shaft come there past the organs.
bool HasClearance(const DivisionField& field, const instrument::Tool& tool, const Segment& jaws,
                  const Vec3& tip) {
  const Vec3 out = math::Normalized(field.port - tip, {0, 0, 1});
  const Segment shaft{tip + tool.jaw_length * out, tip + kShaftWay * out};
  return field.clearance(jaws) >= field.care * 0.5 * tool.jaw_width &&
         field.clearance(shaft) >= field.care * tool.shaft_radius;
}

}  // namespace

std::optional<double> FindClip(const DivisionField& field, double arc) {
  if (arc < kFromWall || arc > field.tube->Length() - kFromJunction) return std::nullopt;
  const Vec3 p = field.tube->At(arc), in = ShaftDirection(field, arc);
  const double length = field.applier->jaw_length;
  // closed, a vessel is half its girth wide
  const double half = 0.5 * M_PI * field.tube->RadiusAt(arc) + kFromEnds;
  for (const double beyond : kLegShares) {
    if (beyond * length < half || (1.0 - beyond) * length < half) continue;
    const Vec3 tip = p + beyond * length * in;
    const Segment legs{tip, tip - length * in};
    if (!HasClearance(field, *field.applier, legs, tip)) continue;
    const bool is_alone = std::none_of(field.others.begin(), field.others.end(), [&](const TubeLine* other) {
      return other->FindNearest(legs).distance < field.care * kBesideLegs;
    });
    if (is_alone) return beyond;
  }
  return std::nullopt;
}

std::optional<ScissorsPose> FindCut(const DivisionField& field, double arc) {
  const Vec3 p = field.tube->At(arc), in = ShaftDirection(field, arc);
  const double length = field.scissors->jaw_length;
  const double half = field.tube->RadiusAt(arc) + kWiderThan;
  for (const double beyond : kBladeShares) {
    if (beyond * length < half - kWiderThan) continue;  // the tips reach past the vessel
    const double reach = (1.0 - beyond) * length;
    // wide enough for the vessel, and so far open that they have not closed up to it yet
    const double jaw =
        std::max(2.0 * math::Asin(std::min(1.0, half / reach)), (beyond + kNotYet) * field.scissors->max_jaw);
    ScissorsPose pose{0.0, std::min(field.scissors->max_jaw, jaw), beyond};
    const Vec3 tip = p + beyond * length * in;
    const double across = FindSpin(field.port, tip, math::Cross(in, field.tube->DirectionAt(arc)));
    for (const double turn : kSpins) {
      pose.spin = across + turn;
      const Pose X =
          instrument::CalcToolPose(field.port, instrument::FindJoints(field.port, tip, pose.spin, pose.jaw));
      const Blades blades{X * instrument::JawHinge(*field.scissors),
                          X * instrument::JawTip(*field.scissors, pose.jaw, +1),
                          X * instrument::JawTip(*field.scissors, pose.jaw, -1)};
      const bool meets_other =
          std::any_of(field.others.begin(), field.others.end(), [&](const TubeLine* other) {
            return IsNearLine(blades, *other, field.care * kBesideBlades, 0.0, 0.0);
          });
      if (meets_other || IsNearLine(blades, *field.tube, kBesideBlades, arc - kOwnLoop, arc + kOwnLoop))
        continue;
      if (blades.Clearance(field.clearance) < field.care * kBesideBlades) continue;
      if (!HasClearance(field, *field.scissors, {tip, blades.hinge}, tip)) continue;
      return pose;
    }
  }
  return std::nullopt;
}

DivisionStep FindNextStep(const DivisionField& field, std::span<const double> clips,
                          std::span<const double> avoid) {
  std::vector<double> legs, cuts;
  for (double arc = 0; arc < field.tube->Length(); arc += kStep) {
    if (!IsApart(arc, avoid, kTried)) continue;
    if (FindClip(field, arc)) legs.push_back(arc);
    if (FindCut(field, arc)) cuts.push_back(arc);
  }
  DivisionStep best;
  std::size_t fewest = 4;
  for (const double gap : kGaps) {
    for (const double cut : cuts) {
      if (!IsApart(cut, clips, gap)) continue;
      const auto distal = std::count_if(clips.begin(), clips.end(), [&](double arc) { return arc < cut; });
      const auto staying = static_cast<std::ptrdiff_t>(clips.size()) - distal;
      std::vector<double> lie(clips.begin(), clips.end()), wanted;
      bool fits = true;
      if (distal < 1) {
        const auto place = std::find_if(legs.rbegin(), legs.rend(), [&](double arc) {
          return arc <= cut - gap && IsApart(arc, lie, gap);
        });
        fits = place != legs.rend();
        if (fits) wanted.push_back(*place), lie.push_back(*place);
      }
      for (std::ptrdiff_t i = staying; fits && i < 2; ++i) {
        const auto place = std::find_if(
            legs.begin(), legs.end(), [&](double arc) { return arc >= cut + gap && IsApart(arc, lie, gap); });
        fits = place != legs.end();
        if (fits) wanted.push_back(*place), lie.push_back(*place);
      }
      if (!fits || wanted.size() >= fewest) continue;
      fewest = wanted.size();
      best = wanted.empty() ? DivisionStep{DivisionStep::Kind::kCut, cut}
                            : DivisionStep{DivisionStep::Kind::kClip, wanted.front()};
    }
  }
  return best;
}

}  // namespace trocar::agent
