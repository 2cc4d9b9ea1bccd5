// SPDX-License-Identifier: Apache-2.0
/// \file gallstones.h  Gallstones: how many and how large, which hole lets one through, and how a loose one falls and
/// comes to lie.
///
/// A loose stone is a ball that slides without rolling and does not bounce: what it falls on is wet and soft. Once it
/// lies still it moves with the surface that carries it, until that has become too steep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/surgery/organ_surface.h"

namespace trocar::surgery {

inline constexpr int kMostGallstones = 40;

/// The stones of a patient.
struct GallstoneSettings {
  int count = 0;                   ///< 0 to kMostGallstones
  double median_diameter = 0.008;  ///< [m], > 0
};

/// Draws the stones' diameters. Stones of one organ have grown together and are much alike: lognormal about the
/// median, the logarithm's deviation 0.25 (general knowledge, a tunable). Together they fill at most half of the
/// organ: those that do not fit are left out.
///
/// \param capacity  volume of the organ [m^3]
/// \return diameters [m], in the order in which the bile brings them to a hole
std::vector<double> DrawGallstones(const GallstoneSettings& settings, double capacity, std::uint64_t seed);

/// The largest stone that passes a hole in a wall that bends but does not stretch: it fills the rim [m].
/// \param rim  length of the hole's rim [m]
double CalcPassingDiameter(double rim) noexcept;

/// How many of the stones that fit leave with what runs out: as many in a volume as in what is inside.
///
/// \param leaked   ran out in this tick [m^3], >= 0
/// \param content  bile inside before [m^3]
/// \return stones, not whole
double CalcStoneOutflow(double leaked, double content, std::size_t fitting) noexcept;

/// Part of a tool that pushes stones aside.
struct StonePusher {
  math::Vec3 a, b;    ///< ends of its axis, world frame [m]
  double radius = 0;  ///< [m]
};

/// Surroundings of loose stones: the surfaces on which they fall, gravity, and the tools that push them.
struct StoneGround {
  std::span<const OrganSurface> organs;
  std::span<const math::Vec3> positions;      ///< (n) of the nodes under the organs [m]
  const OrganSurface* bed = nullptr;          ///< the fixed sheet below the organs, or nullptr
  std::span<const math::Vec3> bed_positions;  ///< (bed) [m]
  math::Vec3 gravity;                         ///< [m/s^2]
  std::span<const StonePusher> pushers;
  double deepest = -1;  ///< z below which nothing falls [m]
};

/// A stone outside of its organ.
struct LooseStone {
  static constexpr std::int32_t kOnNothing = -1, kOnBed = -2, kOnFloor = -3;

  double radius = 0;    ///< [m], > 0
  math::Vec3 position;  ///< of its centre, world frame [m]
  math::Vec3 velocity;  ///< [m/s]
  /// Surface on which it lies: an index of StoneGround::organs, or one of the constants above.
  std::int32_t support = kOnNothing;
  std::uint32_t triangle = 0;       ///< of the support
  std::array<double, 3> weights{};  ///< barycentric, of the point under it
  math::Vec3 offset;   ///< from that point, along the triangle's first edge, across it, and up [m]
  double upright = 0;  ///< cosine of the slope on which it came to lie [-]
  math::Vec3 anchor;   ///< where it has been for `still_seconds`, nearly [m]
  double still_seconds = 0;

  bool IsLying() const { return support != kOnNothing; }
};
/// All but the radius.
void VisitState(base::StateArchive& archive, LooseStone& stone);

/// One tick of all loose stones, in their order: those that fall, slide and come to rest, and those that lie and are
/// carried along.
///
/// \param seconds  > 0
/// \note Real-time safe. The work is bounded: at most kMostSubsteps searches of every surface a stone.
void MoveStones(const StoneGround& ground, double seconds, std::span<LooseStone* const> stones) noexcept;
inline constexpr int kMostSubsteps = 12;

/// After a cut the triangles of the organs are others: what lay on them is looked for anew.
void ForgetSupports(std::span<LooseStone* const> stones) noexcept;

}  // namespace trocar::surgery
