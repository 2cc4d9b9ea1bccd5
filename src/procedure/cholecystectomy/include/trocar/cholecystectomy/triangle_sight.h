// SPDX-License-Identifier: Apache-2.0
/// \file triangle_sight.h  Points of the hepatocystic triangle that an eye has to see, and the fat that hides them.
///
/// The main duct beside the triangle keeps its fat (triangle_window.h). While the triangle is spread, that lump lies beside the
/// window; where the gallbladder was swung aside, it can come between the eye and the cystic duct.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/collision/queries.h"
#include "trocar/math/vector.h"
#include "trocar/surgery/fat_lobules.h"

namespace trocar::cholecystectomy {

/// A duct or artery beside the gallbladder, between two of its nodes.
struct TubeEntry {
  std::uint32_t tube = 0;
  std::array<std::uint32_t, 2> nodes{};
  double share = 0;  ///< of the way from the first to the second, 0 to 1 [-]
};

class TriangleSight {
 public:
  TriangleSight() = default;
  /// \param cystic_duct, hepatic_duct  nodes, from where they meet on; without one of them there is no triangle
  /// \param kept_share  of the cystic duct, from where they meet on, that keeps its fat because a main duct or artery lies beside
  ///                    it: nobody can be asked to see that part [-]
  /// \param entries   of what enters the gallbladder
  /// \param fat       of the triangle
  /// \param kept_fat  beside the hepatic duct, which is no part of the window: TriangleWindowSettings [m]
  TriangleSight(std::vector<std::uint32_t> cystic_duct, std::vector<std::uint32_t> hepatic_duct,
                double kept_share, std::vector<TubeEntry> entries, surgery::FatLobules fat, double kept_fat);

  bool HasTriangle() const noexcept { return !cystic_duct_.empty() && !hepatic_duct_.empty(); }
  /// \param is_intact   (strands) 0 for each that was divided
  /// \param is_divided  bool(std::uint32_t tube): of those that enter; what is divided enters no more
  /// \note Real-time safe.
  template <class IsDivided>
  void Update(std::span<const std::uint8_t> is_intact, const IsDivided& is_divided) noexcept {
    fat_.Update(is_intact);
    for (std::size_t i = 0; i < entries_.size(); ++i) enters_[i] = is_divided(entries_[i].tube) ? 0 : 1;
  }
  /// Points that have to be seen: two on the cystic duct, the middle of the window beside it, all beyond the part that keeps
  /// its fat, and where each tube that was whole at the last Update enters the gallbladder [m].
  /// \param positions  (nodes) [m]
  /// \return valid until the next call
  /// \pre HasTriangle()
  /// \note Real-time safe.
  std::span<const math::Vec3> FindPoints(std::span<const math::Vec3> positions) noexcept;
  /// From the eye to the skin of what lies about a point.
  static collision::Segment LineTo(const math::Vec3& point, const math::Vec3& eye) noexcept;
  /// Whether the fat that was left at the last Update hides a point.
  /// \param positions  (nodes) [m]
  /// \note Real-time safe.
  bool DoesFatHide(std::span<const math::Vec3> positions, const math::Vec3& point,
                   const math::Vec3& eye) const noexcept {
    return fat_.Hide(positions, LineTo(point, eye));
  }

 private:
  std::vector<std::uint32_t> cystic_duct_, hepatic_duct_;
  double kept_share_ = 0;
  std::vector<TubeEntry> entries_;
  std::vector<std::uint8_t> enters_;  // (entries) at the last Update
  std::vector<math::Vec3> points_;    // room for all
  surgery::FatLobules fat_;
  double kept_fat_ = 0;  // [m]
};

}  // namespace trocar::cholecystectomy
