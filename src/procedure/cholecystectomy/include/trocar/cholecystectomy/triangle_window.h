// SPDX-License-Identifier: Apache-2.0
/// \file triangle_window.h  The window of the hepatocystic triangle: where the eye has to see through it, and which fat
/// covers it.
///
/// The triangle lies between cystic duct, common hepatic duct and the liver's edge. It is seen along its normal: what
/// lies before it hides it from the front, what lies behind it hides it from behind. A strand hides some of it where its
/// lobule of fat reaches over, also from beyond the edge. Main ducts and arteries need not be exposed: a border beside
/// the ducts is no part of the window, and the sheath of an artery in it may stay.
/// Source: Strasberg 1995 and 2010 (criterion and borders), Sanford and Strasberg 2014 (scored on a view from the front
/// and one from behind).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::cholecystectomy {

/// All at rest, world frame [m].
struct TriangleBorders {
  std::vector<math::Vec3> cystic_duct, hepatic_duct;  ///< from where they meet on
  std::vector<math::Vec3> main_ducts;                 ///< points of every duct that must stay
  std::vector<math::Vec3> main_arteries;              ///< points of every artery that must stay
};

/// A strand of fat or peritoneum at rest.
struct TriangleFat {
  std::uint32_t strand = 0;
  std::array<math::Vec3, 2> ends;  ///< world frame [m]
};

struct TriangleWindowSettings {
  double kept_fat = 0.005;        ///< beside the middle line of a main duct, as seen [m]
  double kept_sheath = 0.003;     ///< about the middle line of a main artery [m]
  double lobule_radius = 0.0021;  ///< of the fat about a strand [m]
};

class TriangleWindow {
 public:
  TriangleWindow() = default;
  /// Without a triangle there is no window. Where the border leaves nothing of a narrow triangle, all of it is window.
  /// \note Not real-time safe: allocates.
  TriangleWindow(const TriangleBorders& borders, std::span<const TriangleFat> fat,
                 const TriangleWindowSettings& settings);

  /// Share of the strands hiding some of the window at the start that are divided, 0 to 1; 1 without any [-].
  /// \param is_intact  (strands) 0 for each that was divided
  /// \note Real-time safe.
  double CalcClearedShare(std::span<const std::uint8_t> is_intact) const noexcept;

  /// The strands that hide some of the window at the start, ascending.
  const std::vector<std::uint32_t>& Strands() const noexcept { return strands_; }
  /// [m^2]
  double Area() const noexcept { return area_; }

 private:
  std::vector<std::uint32_t> strands_;
  double area_ = 0;
};

}  // namespace trocar::cholecystectomy
