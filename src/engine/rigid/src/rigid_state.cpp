// SPDX-License-Identifier: Apache-2.0
#include "rigid_state.h"

#include <algorithm>
#include <utility>

#include "trocar/math/state_fields.h"

namespace trocar::rigid {

std::array<double, 3> Numbers(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btVector3 Vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

TransformState SaveTransform(const btTransform& X) {
  TransformState state{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      state[static_cast<std::size_t>(3 * row + column)] = X.getBasis()[row][column];
    state[static_cast<std::size_t>(9 + row)] = X.getOrigin()[row];
  }
  return state;
}
btTransform LoadTransform(const TransformState& s) {
  return btTransform(btMatrix3x3(s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]),
                     btVector3(s[9], s[10], s[11]));
}

std::array<std::int32_t, 4> PairOf(const btPersistentManifold& manifold) {
  return {manifold.getBody0()->getUserIndex(), manifold.getBody0()->getUserIndex2(),
          manifold.getBody1()->getUserIndex(), manifold.getBody1()->getUserIndex2()};
}
std::array<std::int32_t, 4> ChildrenOf(const btManifoldPoint& p) {
  return {p.m_partId0, p.m_index0, p.m_partId1, p.m_index1};
}

ContactPointState SavePoint(const btPersistentManifold& manifold, const btManifoldPoint& p) {
  ContactPointState state;
  state.pair = PairOf(manifold);
  state.children = ChildrenOf(p);
  state.vectors = {Numbers(p.m_localPointA),        Numbers(p.m_localPointB),
                   Numbers(p.m_positionWorldOnA),   Numbers(p.m_positionWorldOnB),
                   Numbers(p.m_normalWorldOnB),     Numbers(p.m_lateralFrictionDir1),
                   Numbers(p.m_lateralFrictionDir2)};
  state.numbers = {p.m_distance1,
                   p.m_combinedFriction,
                   p.m_combinedRollingFriction,
                   p.m_combinedSpinningFriction,
                   p.m_combinedRestitution,
                   p.m_appliedImpulse,
                   p.m_prevRHS,
                   p.m_appliedImpulseLateral1,
                   p.m_appliedImpulseLateral2,
                   p.m_contactMotion1,
                   p.m_contactMotion2,
                   p.m_contactCFM,
                   p.m_contactERP,
                   p.m_frictionCFM};
  state.flags = p.m_contactPointFlags;
  state.life_time = p.m_lifeTime;
  return state;
}

btManifoldPoint LoadPoint(const ContactPointState& state) {
  btManifoldPoint p;
  p.m_localPointA = Vector(state.vectors[0]);
  p.m_localPointB = Vector(state.vectors[1]);
  p.m_positionWorldOnA = Vector(state.vectors[2]);
  p.m_positionWorldOnB = Vector(state.vectors[3]);
  p.m_normalWorldOnB = Vector(state.vectors[4]);
  p.m_lateralFrictionDir1 = Vector(state.vectors[5]);
  p.m_lateralFrictionDir2 = Vector(state.vectors[6]);
  p.m_partId0 = state.children[0];
  p.m_index0 = state.children[1];
  p.m_partId1 = state.children[2];
  p.m_index1 = state.children[3];
  double* const into[] = {&p.m_distance1,
                          &p.m_combinedFriction,
                          &p.m_combinedRollingFriction,
                          &p.m_combinedSpinningFriction,
                          &p.m_combinedRestitution,
                          &p.m_appliedImpulse,
                          &p.m_prevRHS,
                          &p.m_appliedImpulseLateral1,
                          &p.m_appliedImpulseLateral2,
                          &p.m_contactMotion1,
                          &p.m_contactMotion2,
                          &p.m_contactCFM,
                          &p.m_contactERP,
                          &p.m_frictionCFM};
  for (std::size_t i = 0; i < std::size(into); ++i) *into[i] = state.numbers[i];
  p.m_contactPointFlags = state.flags;
  p.m_lifeTime = state.life_time;
  return p;
}

bool RigidState::Fits(std::size_t body_count, std::size_t tool_count) const {
  const auto is_body = [&](std::int32_t held) {
    return held >= -1 && held < static_cast<std::int32_t>(body_count);
  };
  return bodies.size() == body_count && tools.size() == tool_count &&
         touched.size() == tool_count * kToolPartCount &&
         std::all_of(touched.begin(), touched.end(),
                     [&](const auto& of_part) { return of_part.size() == body_count; }) &&
         std::all_of(tools.begin(), tools.end(), [&](const ToolState& tool) { return is_body(tool.held); });
}

void RigidState::VisitState(base::StateArchive& archive) {
  archive.Field("bodies", bodies);
  archive.Field("tools", tools);
  archive.Field("touched", touched);
  archive.Field("contacts", contacts);
  archive.Field("gravity", gravity);
}

void LoadContacts(const std::vector<ContactPointState>& contacts, btDispatcher& dispatcher) {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    if (manifold.getNumContacts() == 0) continue;
    const auto key = std::pair(PairOf(manifold), ChildrenOf(manifold.getContactPoint(0)));
    manifold.clearManifold();
    auto saved = std::lower_bound(contacts.begin(), contacts.end(), key,
                                  [](const ContactPointState& point, const auto& wanted) {
                                    return std::pair(point.pair, point.children) < wanted;
                                  });
    for (; saved != contacts.end() && std::pair(saved->pair, saved->children) == key &&
           manifold.getNumContacts() < MANIFOLD_CACHE_SIZE;
         ++saved) {
      manifold.setNumContacts(manifold.getNumContacts() + 1);
      manifold.getContactPoint(manifold.getNumContacts() - 1) = LoadPoint(*saved);
    }
  }
}

}  // namespace trocar::rigid
