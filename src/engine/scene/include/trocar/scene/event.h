// SPDX-License-Identifier: Apache-2.0
/// \file event.h  Events: the facts of a tick that are remembered for a while, and the verdicts of a judge.
#pragma once

#include <cstdint>

#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"
#include "trocar/surgery/fact.h"

namespace trocar::scene {

/// A fact, or a verdict, as the state remembers it.
struct Event {
  surgery::FactKind kind;  ///< IsEvent, or kVerdict
  std::uint64_t tick;
  std::int32_t hand;         ///< Hand, or -1
  std::int32_t organ;        ///< index into Simulation::Surfaces(), or -1
  double force;              ///< the fact's amount [N], 0 where it means nothing
  std::int32_t object = -1;  ///< Scene::objects that is meant, or -1
  std::int32_t error = -1;   ///< of a verdict: row of Procedure::errors, or -1
  math::Vec3 p_rest;         ///< of a clip or a cut: where on its vessel at rest, world frame [m]
};

void VisitState(base::StateArchive& archive, Event& event);

}  // namespace trocar::scene
