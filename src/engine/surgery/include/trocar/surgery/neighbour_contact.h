// SPDX-License-Identifier: Apache-2.0
/// \file neighbour_contact.h  Tools against what lies beside the operated organs: stomach, colon, great vessels, bones.
///
/// Neighbours are no part of the system of nodes. Tools find them by the same sweeps, springs and proxy limits as tissue, but
/// nothing is solved: a neighbour answers a push with a dent, a shift of its surface round the place that is pressed, which grows
/// with the force as over a spring and ends where it gives no more way. See docs/contact.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/surgery/contact.h"
#include "trocar/surgery/tool_proxy.h"

namespace trocar::surgery {

/// A surface that does not belong to the tissue, and how it gives way.
struct NeighbourSurface {
  geometry::TriangleMesh mesh;  ///< closed, outward [m]
  double stiffness = 0;         ///< of a dent [N/m]; infinite: it does not give way
  double deepest = 0;           ///< how far it gives way at most [m]
};

/// Where one tool has pressed a neighbour in.
struct Dent {
  std::int32_t neighbour = -1;  ///< or -1: nowhere
  math::Vec3 centre;            ///< [m]
  math::Vec3 push;              ///< of the surface there [m]

  /// How far a point of that neighbour's surface at rest is shifted; smooth, none from kDentRadius on [m].
  math::Vec3 ShiftOf(const math::Vec3& p) const noexcept;
};
inline constexpr double kDentRadius = 0.030;  ///< [m]
inline constexpr int kDentCount = 2;          ///< one for each hand

/// Called in the order of its members, once a tick each; nothing allocates but Make.
class NeighbourContact {
 public:
  /// \return kMeshInvalid
  static base::Result<NeighbourContact> Make(std::span<const NeighbourSurface> surfaces);
  bool IsEmpty() const { return surfaces_.empty(); }

  /// No dent, nothing touched.
  void Reset() noexcept;
  /// Contacts of the tools on their way. \param motions  one for each hand; what they grasp is no neighbour
  void Find(std::span<const ToolMotion> motions) noexcept;
  /// Forces of the contacts, and the dents that they make. \param is_good  false: of a tick that was taken back
  void Press(bool is_good) noexcept;
  /// On the tool of that hand [N].
  const math::Vec3& ForceOn(int hand) const { return forces_[static_cast<std::size_t>(hand)]; }
  void AddLimits(int hand, ProxyLimits& limits) const noexcept;
  /// For AddOverlapLimits.
  ContactCandidates Candidates() const noexcept;
  const std::array<Dent, kDentCount>& Dents() const { return dents_; }

  void VisitState(base::StateArchive& archive);

 private:
  void Place() noexcept;

  // constant
  std::vector<double> compliance_, deepest_;  // (neighbours) [m/N], [m]
  std::vector<math::Vec3> rest_;              // (n) of all of them [m]
  ContactSettings settings_;

  // state
  std::array<Dent, kDentCount> dents_, dents_before_;
  ContactSet contacts_, last_;

  // scratch
  std::vector<OrganSurface> surfaces_;  // (neighbours)
  std::vector<math::Vec3> positions_, positions_before_;
  std::vector<double> motion_;           // (neighbours + 1)
  std::vector<std::uint8_t> is_dented_;  // (neighbours)
  std::array<math::Vec3, kDentCount> forces_;
};

}  // namespace trocar::surgery
