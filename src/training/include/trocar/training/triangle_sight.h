// SPDX-License-Identifier: Apache-2.0
/// \file triangle_sight.h  What an eye has to see of the hepatocystic triangle, and the fat that hides it.
///
/// The main duct beside the triangle keeps its fat (triangle_window.h). While the triangle is spread, that lump lies beside the
/// window; where the gallbladder was swung aside, it can come between the eye and the cystic duct.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/collision/queries.h"
#include "trocar/math/vector.h"
#include "trocar/surgery/fat_lobules.h"

namespace trocar::training {

class TriangleSight {
 public:
  TriangleSight() = default;
  /// \param cystic_duct, hepatic_duct  nodes, from where they meet on; without one of them there is no triangle
  /// \param fat       of the triangle
  /// \param kept_fat  beside the hepatic duct, which is no part of the window: TriangleWindowSettings [m]
  TriangleSight(std::vector<std::uint32_t> cystic_duct, std::vector<std::uint32_t> hepatic_duct,
                surgery::FatLobules fat, double kept_fat);

  bool HasTriangle() const noexcept { return !cystic_duct_.empty() && !hepatic_duct_.empty(); }
  /// Two places of the cystic duct, and the middle of the window beside it [m].
  /// \param positions  (nodes) [m]
  /// \pre HasTriangle()
  /// \note Real-time safe.
  std::array<math::Vec3, 3> Points(std::span<const math::Vec3> positions) const noexcept;
  /// From the eye to the skin of what lies about a point.
  static collision::Segment LineTo(const math::Vec3& point, const math::Vec3& eye) noexcept;

  /// \param is_intact  (strands) 0 for each that was divided
  /// \note Real-time safe.
  void Update(std::span<const std::uint8_t> is_intact) noexcept { fat_.Update(is_intact); }
  /// Whether the fat that was left at the last Update hides a point.
  /// \param positions  (nodes) [m]
  /// \note Real-time safe.
  bool DoesFatHide(std::span<const math::Vec3> positions, const math::Vec3& point,
                   const math::Vec3& eye) const noexcept {
    return fat_.Hide(positions, LineTo(point, eye));
  }

 private:
  std::vector<std::uint32_t> cystic_duct_, hepatic_duct_;
  surgery::FatLobules fat_;
  double kept_fat_ = 0;  // [m]
};

}  // namespace trocar::training
