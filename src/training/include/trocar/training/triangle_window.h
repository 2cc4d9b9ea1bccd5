// SPDX-License-Identifier: Apache-2.0
/// \file triangle_window.h  The window of the hepatocystic triangle: where the eye has to see through it, and which fat
/// covers it.
///
/// The triangle lies between cystic duct, common hepatic duct and the liver's edge. It is cut into patches along its
/// plane, so that a patch is the same from the front and from behind. What lies before or behind a patch covers it,
/// whatever else it lies near. The main ducts need not be exposed: a border beside them is no part of the window.
/// Source: Strasberg 1995 and 2010 (criterion and borders), Sanford and Strasberg 2014 (scored on a view from the front
/// and one from behind).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/math/vector.h"

namespace trocar::training {

/// All at rest, world frame [m].
struct TriangleBorders {
  std::vector<math::Vec3> cystic_duct, hepatic_duct;  ///< from where they meet on
  std::vector<math::Vec3> main_ducts;                 ///< points of every duct that must stay
};

/// A strand of fat or peritoneum at rest.
struct TriangleFat {
  std::uint32_t strand = 0;
  std::array<math::Vec3, 2> ends;  ///< world frame [m]
};

struct TriangleWindowSettings {
  double kept_fat = 0.005;       ///< beside the middle line of a main duct, which need not be cleared [m]
  double lobule_radius = 0.002;  ///< of the fat around a strand [m]
};

class TriangleWindow {
 public:
  TriangleWindow() = default;
  /// Without a triangle there is no window. Where the border leaves nothing of a narrow triangle, all of it is window.
  /// \note Not real-time safe: allocates.
  TriangleWindow(const TriangleBorders& borders, std::span<const TriangleFat> fat,
                 const TriangleWindowSettings& settings);

  /// Share of the window that nothing covers, 0 to 1; 1 without a window [-].
  /// \param is_intact  (strands) 0 for each that was divided
  /// \note Real-time safe.
  double CalcOpenShare(std::span<const std::uint8_t> is_intact) const noexcept;

  /// Strands that cover some of it at the start, ascending.
  std::vector<std::uint32_t> Strands() const;
  /// Area [m^2].
  double Area() const noexcept;

 private:
  geometry::Rows covering_;  // (patches) strands
};

}  // namespace trocar::training
