// SPDX-License-Identifier: Apache-2.0
/// \file node_balance.h  Contact force and force scale at one node, for the solvers that go node by node.
#pragma once

#include "node_force.h"

namespace trocar::tissue {

/// Force of the contacts on one node; few contacts, so a scan is enough for a reference.
inline math::Vec3 GatherContactForce(const TissueLoad& load, std::span<const math::Vec3> position,
                                     std::uint32_t node) noexcept {
  math::Vec3 force;
  for (const ContactSpring& contact : load.contacts) {
    const double depth = CalcContactDepth(contact, position);
    if (!(depth > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      if (contact.nodes[i] == node)
        force += (contact.weights[i] * contact.stiffness * depth) * contact.normal;
    }
  }
  return force;
}

/// Largest force on node i through one spring, load or contact [N].
inline double CalcForceScale(const TissueModel& model, const TissueLoad& load,
                             std::span<const math::Vec3> position, std::uint32_t i) noexcept {
  double largest =
      math::Max(load.shape_scale * model.shape_stiffness[i] * math::Distance(model.rest[i], position[i]),
                model.mass[i] * math::Norm(load.gravity));
  for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const double stretch = math::Distance(position[i], position[half.other]) - half.rest_length;
    largest = math::Max(largest, load.stiffness_scale * half.stiffness * std::fabs(stretch));
  }
  if (!load.external_force.empty()) largest = math::Max(largest, math::Norm(load.external_force[i]));
  return largest;
}

}  // namespace trocar::tissue
