// SPDX-License-Identifier: Apache-2.0
/// \file trocar_motion.cpp  The fulcrum: a hand that moves left moves the tip right.
#include <cmath>
#include <cstdio>

#include "trocar/instrument/trocar_kinematics.h"

int main() {
  using namespace trocar;
  const math::Vec3 port{0, 0, 0};
  const instrument::TrocarJoints joints{std::asin(0.1), 0, 0, 0.1, 0};  // 100 mm deep, panned
  const math::Pose X_world_tool = instrument::CalcToolPose(port, joints);
  const math::Vec3 handle = X_world_tool * math::Vec3{0, 0, 0.3};
  std::printf("the handle goes %.1f mm to the patient's left, the tip goes %.1f mm to the patient's right\n",
              1000.0 * handle.x, -1000.0 * X_world_tool.translation.x);
}
