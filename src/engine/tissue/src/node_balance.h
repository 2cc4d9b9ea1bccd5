// SPDX-License-Identifier: Apache-2.0
/// \file node_balance.h  Force of contacts and elements and force scale at one node, for the solvers that go node by node.
#pragma once

#include "node_force.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {

/// Force of contacts and elements on one node; they are few, so a scan is enough for a reference.
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
  if (HasElements(load)) force += CalcElementForceOn(*load.elements, position, node).sum;
  return force;
}

/// Largest force on node i through one spring, load or element [N].
inline double CalcForceScale(const TissueModel& model, const TissueLoad& load,
                             std::span<const math::Vec3> position, std::uint32_t i) noexcept {
  double largest =
      math::Max(load.shape_scale * model.shape_stiffness[i] * math::Distance(model.rest[i], position[i]),
                model.mass[i] * math::Norm(load.gravity));
  largest = math::Max(largest, FindLargestTension(model, load.stiffness_scale, position, i));
  if (!load.external_force.empty()) largest = math::Max(largest, math::Norm(load.external_force[i]));
  if (HasElements(load))
    largest = math::Max(largest, CalcElementForceOn(*load.elements, position, i).largest);
  return largest;
}

}  // namespace trocar::tissue
