// SPDX-License-Identifier: Apache-2.0
/// \file split_quality.h  Where a vertex may be put without making slivers.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/geometry/editable_mesh.h"

namespace trocar::geometry {

/// Whether edge h may be split at t: neither at rest nor now does a triangle get an angle below the limit [rad]. A
/// triangle that is squashed now is judged by its rest shape alone.
bool MaySplit(const EditableMesh& mesh, std::uint32_t h, double t, double min_angle);

/// Whether a vertex may be put into a triangle; one that is squashed now takes none.
bool MayInsert(const EditableMesh& mesh, std::uint32_t t, const std::array<double, 3>& weights,
               double min_angle);

/// Barycentric weights of a point of a triangle, present positions.
std::array<double, 3> CalcWeights(const EditableMesh& mesh, std::uint32_t t, const math::Vec3& p);

}  // namespace trocar::geometry
