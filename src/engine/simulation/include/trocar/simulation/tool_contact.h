// SPDX-License-Identifier: Apache-2.0
/// \file tool_contact.h  One point at which a tool touches tissue or a thing.
#pragma once

#include <cstdint>

#include "trocar/math/vector.h"

namespace trocar::simulation {

struct ToolContact {
  math::Vec3 point;           ///< on what is touched, world frame [m]
  math::Vec3 normal;          ///< unit, towards the tool
  math::Vec3 force;           ///< on the tool, friction included [N]
  std::int32_t hand = 0;      ///< whose tool
  std::int32_t surface = -1;  ///< of Simulation::Surfaces(), or -1
  std::int32_t object = -1;   ///< of Scene::objects, or -1
};

}  // namespace trocar::simulation
