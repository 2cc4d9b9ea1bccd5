// SPDX-License-Identifier: Apache-2.0
/// \file node_force.h  The force on one node, gathered from its neighbours: shared by every solver.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "trocar/tissue/spring_law.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Springs, strands, virtual spring, weight and external force on node i; contacts are added apart [N].
/// Zero-length springs exert no force: they have no direction.
/// \param tension  of a half-spring at a length [m]: [N] before load.stiffness_scale
/// \note Real-time safe.
template <typename Tension>
math::Vec3 GatherForce(const TissueModel& model, std::span<const std::uint8_t> strand_is_intact,
                       const TissueLoad& load, std::span<const math::Vec3> position, std::uint32_t i,
                       const Tension& tension) noexcept {
  const math::Vec3 here = position[i];
  math::Vec3 springs;
  for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const math::Vec3 along = position[half.other] - here;
    const double length = std::sqrt(math::SquaredNorm(along));
    if (length > 0.0) springs += (tension(half, length) / length) * along;
  }
  for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
    const auto& half = model.half_strands[h];
    if (!strand_is_intact[half.strand]) continue;
    springs += half.stiffness * ((position[half.other] - here) - (model.rest[half.other] - model.rest[i]));
  }
  math::Vec3 force = load.stiffness_scale * springs +
                     (load.shape_scale * model.shape_stiffness[i]) * (model.rest[i] - here) +
                     model.mass[i] * load.gravity;
  if (!load.external_force.empty()) force += load.external_force[i];
  return force;
}

/// Sum of the stiffnesses of a node's springs [N/m].
inline double SumSpringStiffness(const TissueModel& model, std::uint32_t node) noexcept {
  double sum = 0;
  for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h)
    sum += model.half_springs[h].stiffness;
  return sum;
}

/// Calls visit(other) for the node at the other end of each spring and strand, whether or not it holds.
template <typename Visit>
void ForEachNeighbour(const TissueModel& model, std::uint32_t node, const Visit& visit) noexcept {
  for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h)
    visit(model.half_springs[h].other);
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h)
    visit(model.half_strands[h].other);
}

/// Largest force of one spring on a node [N].
inline double FindLargestTension(const TissueModel& model, double stiffness_scale,
                                 std::span<const math::Vec3> position, std::uint32_t node) noexcept {
  double largest = 0;
  for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const double stretch = math::Distance(position[node], position[half.other]) - half.rest_length;
    largest = math::Max(largest, stiffness_scale * half.stiffness * std::fabs(stretch));
  }
  return largest;
}

/// By Hooke's law, every spring whole: what the solvers see, whose springs are linearised (spring_linearisation.h).
inline math::Vec3 GatherNodeForce(const TissueModel& model, std::span<const std::uint8_t> strand_is_intact,
                                  const TissueLoad& load, std::span<const math::Vec3> position,
                                  std::uint32_t i) noexcept {
  return GatherForce(model, strand_is_intact, load, position, i,
                     [](const TissueModel::HalfSpring& half, double length) {
                       return half.stiffness * (length - half.rest_length);
                     });
}

/// By each spring's own law and what is left of it.
inline math::Vec3 GatherLawForce(const TissueModel& model, const TissueState& state, const TissueLoad& load,
                                 std::uint32_t i) noexcept {
  return GatherForce(model, state.strand_is_intact, load, state.position, i,
                     [&](const TissueModel::HalfSpring& half, double length) {
                       return state.spring_factor[half.spring] *
                              CalcSpringTension(model.laws[model.spring_law[half.spring]], half.stiffness,
                                                half.rest_length, length);
                     });
}

/// Adds every pressing contact's force to its three nodes.
inline void AddContactForce(std::span<const ContactSpring> contacts, std::span<const math::Vec3> position,
                            std::span<math::Vec3> force) noexcept {
  for (const ContactSpring& contact : contacts) {
    const double depth = CalcContactDepth(contact, position);
    if (!(depth > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      force[contact.nodes[i]] += (contact.weights[i] * contact.stiffness * depth) * contact.normal;
    }
  }
}

}  // namespace trocar::tissue
