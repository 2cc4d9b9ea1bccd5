// SPDX-License-Identifier: Apache-2.0
/// \file patient_frame.h  The frame and unit of a patient's files, LPS millimetres.
#pragma once

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::files {

inline constexpr double kMmPerMetre = 1000.0;

/// World metres (left, cranial, anterior) to LPS millimetres (left, posterior, superior).
inline math::Vec3 ToLps(const math::Vec3& p) {
  return {kMmPerMetre * p.x, -kMmPerMetre * p.z, kMmPerMetre * p.y};
}
inline math::Vec3 FromLps(const math::Vec3& p) {
  return {p.x / kMmPerMetre, p.z / kMmPerMetre, -p.y / kMmPerMetre};
}

inline geometry::TriangleMesh Converted(geometry::TriangleMesh mesh,
                                        math::Vec3 (*convert)(const math::Vec3&)) {
  for (math::Vec3& p : mesh.positions) p = convert(p);
  return mesh;
}

}  // namespace trocar::files
