// SPDX-License-Identifier: Apache-2.0
/// \file division_plan.h  Where on a duct or artery clips and the cut go: what a surgeon plans before closing a clip.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "trocar/collision/queries.h"
#include "trocar/instrument/tool.h"

namespace trocar::agent {

/// A duct or artery as it lies now, from the organ that it enters on.
struct TubeLine {
  std::vector<math::Vec3> points;  ///< at least 2 [m]
  std::vector<double> radii;       ///< (points) [m]

  double Length() const;
  /// \param arc  from the first point [m]; outside is taken at the end
  math::Vec3 At(double arc) const;
  double RadiusAt(double arc) const;
  /// Unit, away from the organ, over a few millimetres.
  math::Vec3 DirectionAt(double arc) const;
  /// Arc of the nearest point, and how far it is [m].
  struct Near {
    double arc = 0, distance = 0;
  };
  Near FindNearest(const math::Vec3& p) const;
  Near FindNearest(const collision::Segment& segment) const;
};

/// One tube that is to be divided, and what lies around it.
struct DivisionField {
  const TubeLine* tube = nullptr;
  std::vector<const TubeLine*> others;  ///< that must not come between legs or blades
  math::Vec3 port;                      ///< of the hand that does it [m]
  const instrument::Tool* applier = nullptr;
  const instrument::Tool* scissors = nullptr;
  /// Distance from a segment to the nearest organ [m].
  std::function<double(const collision::Segment&)> clearance;
  double care = 1.0;  ///< how far off all else has to be: 1 well off, 0.5 just off [-]
};

/// How the scissors stand for a cut: no wider open than the vessel needs.
struct ScissorsPose {
  double spin = 0, jaw = 0;  ///< [rad]
  double beyond = 0;         ///< share of the blades, from their tips, at which they take the vessel [-]
};
/// Two clips nearer than this could come to lie over each other [m].
inline constexpr double kLeastGap = 0.0017;

/// How a clip closes around this tube there and around no other.
/// \return share of the legs, from their tips, at which they take the vessel; nothing where they cannot
std::optional<double> FindClip(const DivisionField& field, double arc);
/// How scissors cut this tube there and nothing else; nothing where they cannot.
std::optional<ScissorsPose> FindCut(const DivisionField& field, double arc);

/// Next step of a division, which is to end with one clip on the organ's side of the cut and two that stay.
struct DivisionStep {
  enum class Kind { kClip, kCut, kNone } kind = Kind::kNone;
  double arc = 0;  ///< from the organ [m]
};
/// \param clips  arcs of those that lie there already [m]
/// \param avoid  arcs at which it has failed before [m]
DivisionStep FindNextStep(const DivisionField& field, std::span<const double> clips,
                          std::span<const double> avoid);

}  // namespace trocar::agent
