// SPDX-License-Identifier: Apache-2.0
/// \file organ_contact.h  Organ against organ: an organ that has come off its bed rests on the one that it lay on, and a duct that
/// is pressed on either does not go through it.
///
/// Each vertex of one organ, or node of a tube with its radius, is kept out of the other organ by two one-sided springs,
/// one on either side of the plane half way between them. They are made well ahead of touch, so an organ that falls in
/// one solve is stopped half way to the other in this tick and comes to rest on it in the next ones. What presses them is
/// kept from tick to tick and added to what the gap still asks for, so that soft springs bear any load without giving way
/// (an augmented Lagrangian: Hestenes, "Multiplier and gradient methods", JOTA 4, 1969). Each vertex knows on which side of
/// the surface it is, and a fold of the surface cannot persuade it otherwise. The shapes as they were imaged may overlap where
/// they touch, and ducts run inside of organs: that much stays allowed, so that nothing moves before anything acts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/surgery/contact.h"

namespace trocar::surgery {
struct ClearVertex;
}
template <>
inline constexpr bool trocar::base::kIsPlainState<trocar::surgery::ClearVertex> = true;  // four doubles

namespace trocar::surgery {

struct OrganContactSettings {
  double stiffness = 100.0;   ///< of each spring [N/m]
  double ahead = 0.0026;      ///< springs are made from this far ahead of touch [m]
  double reach = 0.008;       ///< a vertex deeper than this has no near wall to be pushed back through [m]
  double thickness = 0.0004;  ///< at which a vertex is kept off a surface, so that there is always a side [m]
};

/// Where a vertex lay when it was last looked at, outside and clear of the surface.
struct ClearVertex {
  math::Vec3 position;  ///< [m]
  /// It cannot have come near the surface while its own way and the surface's travel are together less than this [m].
  double until = 0;
};

static_assert(sizeof(ClearVertex) == 4 * sizeof(double));

/// Vertices of one organ, or nodes of one tube, against an organ's surface.
struct OrganPair {
  std::uint8_t nodes_of = 0;    ///< surface: an organ, or organs + tube
  std::uint8_t surface_of = 0;  ///< organ
  std::uint32_t first_node = 0, node_count = 0;
  std::vector<double> radii;                 ///< (node_count) of a tube [m], or empty
  std::vector<double> allowed_at_rest;       ///< (nodes at rest) signed distance that is allowed [m]
  std::vector<std::uint8_t> inside_at_rest;  ///< (nodes at rest)
  // state
  std::vector<double> allowed;          ///< (node_count) the same now: what has come out stays out [m]
  std::vector<std::uint8_t> is_inside;  ///< (node_count) of the surface
  std::vector<double> warm_start;  ///< (node_count) how far its springs were pressed by the last solve [m]
  std::vector<std::uint8_t> is_bound;        ///< (node_count) tied to the other organ: left to its strands
  std::vector<std::uint32_t> last_triangle;  ///< (node_count) where the search starts
  std::vector<std::uint32_t> spring;         ///< (node_count) the first of its two in the set, or kNoSpring
  std::vector<ClearVertex> clear;  ///< (node_count) spares most searches; changes nothing that is found
};
inline constexpr std::uint32_t kNoSpring = ~std::uint32_t{0};

/// Saves and restores a pair's state, but for that which is found anew in every tick.
void VisitState(base::StateArchive& archive, OrganPair& pair);

/// \param positions  (n) of the whole system, at rest [m]
/// \param bound      nodes of the first organ that strands hold to the other
OrganPair MakeOrganPair(std::span<const OrganSurface> organs, std::span<const math::Vec3> positions,
                        std::uint8_t vertices_of, std::uint8_t surface_of,
                        std::span<const std::uint32_t> bound, const OrganContactSettings& settings);
/// \param surface  of the tube: organs + tube
OrganPair MakeTubePair(std::span<const OrganSurface> organs, std::span<const math::Vec3> positions,
                       const TubeSurface& tube, std::uint8_t surface, std::uint8_t surface_of,
                       const OrganContactSettings& settings);

/// After a cut of an organ: new vertices keep off the other organ like any, and every search starts anew.
/// \note Not real-time safe: allocates.
void UpdateTopology(std::span<const OrganSurface> organs, std::uint8_t changed, OrganPair& pair);

/// As made. \note Real-time safe.
void ResetPair(OrganPair& pair) noexcept;

/// Adds the springs of one pair; links carry kNoHand.
/// \note Real-time safe.
void FindOrganContacts(std::span<const OrganSurface> organs, std::span<const math::Vec3> positions,
                       const OrganContactSettings& settings, OrganPair& pair, ContactSet& contacts) noexcept;

/// After the solve: keeps what presses each spring as the initial guess of its force in the next tick (warm start).
/// \param positions  (n) after it [m]
/// \note Real-time safe.
void KeepWarmStartForces(std::span<const math::Vec3> positions, const ContactSet& contacts,
                         OrganPair& pair) noexcept;

/// After a solve that was taken back.
/// \note Real-time safe.
void ForgetWarmStartForces(OrganPair& pair) noexcept;

/// Hand of a contact that no tool makes.
inline constexpr std::uint8_t kNoHand = 0xff;

}  // namespace trocar::surgery
