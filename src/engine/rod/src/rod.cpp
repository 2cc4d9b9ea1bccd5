// SPDX-License-Identifier: Apache-2.0
#include "trocar/rod/rod.h"

#include <cmath>
#include <string>

#include "rod_elements.h"
#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"

namespace trocar::rod {

using math::Vec3;

RodMaterial MakeRoundMaterial(double diameter, double young_modulus, double poisson_ratio, double density) {
  TROCAR_ASSERT(diameter > 0.0 && young_modulus > 0.0 && poisson_ratio > -1.0 && poisson_ratio <= 0.5);
  const double radius = 0.5 * diameter, area = M_PI * radius * radius;
  const double second_moment = 0.25 * area * radius * radius;
  // G = E / (2 (1 + nu)), J = 2 I
  return {.radius = radius,
          .bending = young_modulus * second_moment,
          .twisting = young_modulus * second_moment / (1.0 + poisson_ratio),
          .stretching = young_modulus * area,
          .mass_per_length = density * area};
}

base::Result<RodModel> MakeRodModel(const RodDefinition& definition) {
  const auto refuse = [](const std::string& why) { return base::Error{base::ErrorCode::kSceneInvalid, why}; };
  const std::size_t n = definition.nodes.size();
  if (n < 3) return refuse("a rod has " + std::to_string(n) + " nodes; give it three at least");
  const RodMaterial& m = definition.material;
  if (!(m.radius > 0.0 && std::isfinite(m.radius))) return refuse("a rod has no radius; give one above 0");
  if (!(m.bending >= 0.0 && std::isfinite(m.bending) && m.twisting >= 0.0 && std::isfinite(m.twisting)))
    return refuse("a rod has a stiffness against bending or twist below 0 or none at all; give 0 or more");
  if (!(m.stretching > 0.0 && std::isfinite(m.stretching)))
    return refuse("a rod has no stiffness along its length; give one above 0");
  if (!(m.mass_per_length >= 0.0 && std::isfinite(m.mass_per_length)))
    return refuse("a rod has a mass below 0 or none at all; give 0 or more");
  RodModel model;
  model.material = m;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double length = math::Distance(definition.nodes[i], definition.nodes[i + 1]);
    if (!(length > 0.0 && std::isfinite(length)))
      return refuse("a rod has no length between its nodes " + std::to_string(i) + " and " +
                    std::to_string(i + 1) + "; give each node a place of its own");
    model.length.push_back(length);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double before = i > 0 ? model.length[i - 1] : 0.0, behind = i + 1 < n ? model.length[i] : 0.0;
    model.reach.push_back(0.5 * (before + behind));
  }
  return model;
}

RodState MakeRodState(const RodModel& model, std::span<const Vec3> nodes) {
  TROCAR_ASSERT(nodes.size() == model.NodeCount());
  RodState state;
  const std::size_t segments = model.SegmentCount();
  state.position.assign(nodes.begin(), nodes.end());
  state.angle.resize(segments), state.tension.resize(segments), state.is_angle_held.resize(segments);
  state.reference_twist.resize(nodes.size()), state.is_held.resize(nodes.size());
  Vec3 direction, reference;
  for (std::size_t s = 0; s < segments; ++s) {
    const Vec3 next = math::Normalized(nodes[s + 1] - nodes[s]);
    reference = s == 0 ? math::AnyPerpendicular(next) : Transport(reference, direction, next);
    state.reference.push_back(reference);
    state.direction.push_back(next);
    direction = next;
  }
  return state;
}

void VisitState(base::StateArchive& archive, RodState& state) {
  archive.FixedField("position", state.position);
  archive.FixedField("angle", state.angle);
  archive.FixedField("direction", state.direction);
  archive.FixedField("reference", state.reference);
  archive.FixedField("reference_twist", state.reference_twist);
  archive.FixedField("tension", state.tension);
  archive.FixedField("is_held", state.is_held);
  archive.FixedField("is_angle_held", state.is_angle_held);
}

}  // namespace trocar::rod
