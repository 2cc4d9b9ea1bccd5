// SPDX-License-Identifier: Apache-2.0
/// \file link_stiffness.h  How stiff one spring is in space.
#pragma once

#include "trocar/math/vector.h"

namespace trocar::tissue {

/// Stiffness of a spring that runs along `along`, isotropic I + axial u u^T. A spring shorter than at rest counts
/// along its direction only, so that sums stay positive definite.
struct LinkStiffness {
  double isotropic = 0;  ///< [N/m]
  double axial = 0;      ///< [N/m]
  math::Vec3 direction;  ///< u
};
inline LinkStiffness CalcLinkStiffness(const math::Vec3& along, double length, double stiffness,
                                       double rest_length) noexcept {
  if (!(length > 0.0)) return {};
  const double across = length > rest_length ? stiffness * (1.0 - rest_length / length) : 0.0;
  return {across, stiffness - across, along / length};
}

}  // namespace trocar::tissue
