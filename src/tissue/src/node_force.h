// SPDX-License-Identifier: Apache-2.0
/// \file node_force.h  The force on one node, gathered from its neighbours: shared by every solver.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Springs, strands, virtual spring, weight and external force on node i; contacts are added apart [N].
/// Zero-length springs exert no force: they have no direction.
/// \note Real-time safe.
inline Vec3 GatherNodeForce(const TissueModel& model, std::span<const std::uint8_t> strand_is_intact,
                            const TissueLoad& load, std::span<const Vec3> position,
                            std::uint32_t i) noexcept {
  const Vec3 here = position[i];
  Vec3 springs;
  for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const Vec3 along = position[half.other] - here;
    const double length = std::sqrt(math::SquaredNorm(along));
    if (length > 0.0) springs += (half.stiffness * (length - half.rest_length) / length) * along;
  }
  for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
    const auto& half = model.half_strands[h];
    if (!strand_is_intact[half.strand]) continue;
    springs += half.stiffness * ((position[half.other] - here) - (model.rest[half.other] - model.rest[i]));
  }
  Vec3 force = load.stiffness_scale * springs +
               (load.shape_scale * model.shape_stiffness[i]) * (model.rest[i] - here) +
               model.mass[i] * load.gravity;
  if (!load.external_force.empty()) force += load.external_force[i];
  return force;
}

/// Adds every pressing contact's force to its three nodes.
inline void AddContactForce(std::span<const ContactSpring> contacts, std::span<const Vec3> position,
                            std::span<Vec3> force) noexcept {
  for (const ContactSpring& contact : contacts) {
    const double depth = CalcContactDepth(contact, position);
    if (!(depth > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      force[contact.nodes[i]] += (contact.weights[i] * contact.stiffness * depth) * contact.normal;
    }
  }
}

}  // namespace trocar::tissue
