// SPDX-License-Identifier: Apache-2.0
#include "pressed_tissue.h"

#include <algorithm>
#include <cmath>

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kJaw = 0.014;                          // m from the tip that holds
constexpr double kLeastPinch = 0.5, kFullPinch = 6.0;   // N: it begins to whiten, it is as white as it gets
constexpr double kLeastForce = 0.15, kFullForce = 2.0;  // N, of a tip that presses
constexpr double kWhitest = 0.85;
constexpr double kTip = 0.002;                       // m from the tip that presses
constexpr double kInside = 0.0035, kReach = 0.0095;  // m from the piece: all of it, nothing any more

double CalcStrength(double force, double least, double full) noexcept {
  // vessels are squeezed empty early: twice the force is not twice as white
  return kWhitest * std::sqrt(std::clamp((force - least) / (full - least), 0.0, 1.0));
}

}  // namespace

std::vector<Press> FindPresses(const simulation::Snapshot& snapshot) {
  std::vector<Press> presses;
  for (const simulation::InstrumentSnapshot& tool : snapshot.instruments) {
    if (tool.organ < 0) continue;
    const math::Pose& X = tool.X_world_tool;
    if (tool.is_grasping) {
      if (const double strength = CalcStrength(tool.pinch, kLeastPinch, kFullPinch); strength > 0.0)
        presses.push_back({X.translation, X * Vec3{0, 0, kJaw}, strength, tool.organ});
    } else if (tool.is_touching) {
      if (const double strength = CalcStrength(math::Norm(tool.force), kLeastForce, kFullForce);
          strength > 0.0)
        presses.push_back({X.translation, X * Vec3{0, 0, kTip}, strength, tool.organ});
    }
  }
  return presses;
}

double CalcPressedPallor(std::span<const Press> presses, std::int32_t surface, const Vec3& p_world) noexcept {
  double pallor = 0;
  for (const Press& press : presses) {
    if (press.surface != surface) continue;
    const Vec3 along = press.b - press.a;
    const double t = std::clamp(math::Dot(p_world - press.a, along) / math::SquaredNorm(along), 0.0, 1.0);
    const double distance = math::Distance(p_world, press.a + t * along);
    const double share = std::clamp((kReach - distance) / (kReach - kInside), 0.0, 1.0);
    pallor = std::max(pallor, press.strength * share * share * (3.0 - 2.0 * share));
  }
  return pallor;
}

}  // namespace trocar::view
