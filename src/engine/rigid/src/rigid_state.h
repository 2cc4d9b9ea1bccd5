// SPDX-License-Identifier: Apache-2.0
/// \file rigid_state.h  State of Bullet's objects that has to be restored for the next step to have the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bullet_units.h"
#include "trocar/base/state_archive.h"
#include "trocar/rigid/rigid_world.h"

namespace trocar::rigid {

using TransformState = std::array<double, 12>;  // rows of the rotation, then the origin [cm]

struct BodyState {
  TransformState X_world_body{};
  std::array<double, 3> velocity{}, turn{};  // [cm/s], [rad/s]
  double deactivation_seconds = 0;
  std::int64_t activation = 0;  // Bullet's
  std::uint64_t touches = 0;
};

struct ToolState {
  std::array<TransformState, kToolPartCount> parts{}, from{};
  TransformState X_carrier_body{};  // of what it holds
  double hold_force = 0;
  std::int32_t held = -1, ticks_over = 0;
  math::Vec3 force;
};

/// One point of a contact manifold, with what warm-starts the next step.
struct ContactPointState {
  std::array<std::int32_t, 4> pair{};      // user index and tool part of both bodies
  std::array<std::int32_t, 4> children{};  // part and child shape of both
  std::array<std::array<double, 3>, 7> vectors{};
  std::array<double, 14> numbers{};
  std::int32_t flags = 0, life_time = 0;
};

/// All that the next step depends on, in an order that depends on nothing else.
struct RigidState {
  std::vector<BodyState> bodies;
  std::vector<ToolState> tools;
  std::vector<std::vector<std::uint8_t>> touched;  ///< (tools x parts) by body
  std::vector<ContactPointState> contacts;         ///< by pair and children
  math::Vec3 gravity;

  bool Fits(std::size_t body_count, std::size_t tool_count) const;
  void VisitState(base::StateArchive& archive);
};

TransformState SaveTransform(const btTransform& X);
btTransform LoadTransform(const TransformState& state);
std::array<double, 3> Numbers(const btVector3& v);
btVector3 Vector(const std::array<double, 3>& v);

/// Bodies of a manifold by what does not change when they are made anew.
std::array<std::int32_t, 4> PairOf(const btPersistentManifold& manifold);
std::array<std::int32_t, 4> ChildrenOf(const btManifoldPoint& p);
ContactPointState SavePoint(const btPersistentManifold& manifold, const btManifoldPoint& p);
btManifoldPoint LoadPoint(const ContactPointState& state);
/// Gives the manifolds that Bullet has just found their saved points; those that were not saved have none.
void LoadContacts(const std::vector<ContactPointState>& contacts, btDispatcher& dispatcher);

}  // namespace trocar::rigid

namespace trocar::base {
template <>
inline constexpr bool kIsPlainState<rigid::BodyState> = sizeof(rigid::BodyState) == 21 * 8;
template <>
inline constexpr bool kIsPlainState<rigid::ToolState> = sizeof(rigid::ToolState) == 89 * 8;
template <>
inline constexpr bool kIsPlainState<rigid::ContactPointState> = sizeof(rigid::ContactPointState) == 40 * 8;
}  // namespace trocar::base
