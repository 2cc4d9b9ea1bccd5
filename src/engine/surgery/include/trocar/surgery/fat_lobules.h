// SPDX-License-Identifier: Apache-2.0
/// \file fat_lobules.h  Fat about the strands that are dissected, as it is drawn and as it hides what lies behind it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/collision/queries.h"
#include "trocar/math/vector.h"

namespace trocar::surgery {

struct FatStrand {
  std::uint32_t strand = 0;    ///< index of its intact flag
  std::uint32_t a = 0, b = 0;  ///< nodes
};

/// Two lobules on each strand. They are as full as the strands that meet at its ends are whole, and what is left of a body of
/// fat that was divided is a thin layer: full ones overlap so much that a tenth of them would look like all.
class FatLobules {
 public:
  FatLobules() = default;
  /// \param rest    (nodes) [m]
  /// \param radius  of a full lobule, about; > 0 [m]
  /// \pre the strands' nodes lie in `rest` (TROCAR_ASSERT)
  /// \note Not real-time safe: allocates, and takes the square of their number.
  FatLobules(std::span<const FatStrand> strands, std::span<const math::Vec3> rest, double radius);

  /// Sizes, where strands were divided since, or are whole again.
  /// \param is_intact  (strands) 0 for each that was divided; those beyond its end are whole
  /// \note Real-time safe.
  void Update(std::span<const std::uint8_t> is_intact) noexcept;

  std::size_t Count() const noexcept { return lobules_.size(); }
  bool IsThere(std::size_t lobule) const noexcept { return strands_[lobule / kOnStrand].is_intact; }
  double Radius(std::size_t lobule) const noexcept { return lobules_[lobule].radius; }  ///< [m]
  const math::Vec3& Rest(std::size_t lobule) const noexcept {
    return lobules_[lobule].rest;
  }  ///< its centre [m]
  /// Its centre [m].
  /// \param positions  (nodes) [m]
  math::Vec3 Centre(std::size_t lobule, std::span<const math::Vec3> positions) const noexcept;

  /// Whether a lobule lies on a line of sight.
  /// \param positions  (nodes) [m]
  /// \note Real-time safe.
  bool Hide(std::span<const math::Vec3> positions, const collision::Segment& sight) const noexcept;

 private:
  static constexpr std::size_t kOnStrand = 2;
  struct Strand {
    FatStrand of;
    std::array<std::uint32_t, 2> ends{};  // in ends_
    bool is_intact = true;
  };
  /// A node in which strands of fat meet.
  struct End {
    int strands = 0, intact = 0;
    double Filling() const { return static_cast<double>(intact) / static_cast<double>(strands); }
  };
  struct Lobule {
    double along = 0;             // its strand, from a on [-]
    math::Vec3 offset, rest;      // beside its strand; centre at rest [m]
    double full = 0;              // radius where all strands are whole [m]
    int near = 0, left = 0;       // lobules of its body, itself among them; those of them that are there
    double thin = 1, radius = 0;  // its size by its body [-]; radius now [m]
  };
  void CountNear(std::size_t lobule, int change) noexcept;
  void Resize() noexcept;

  std::vector<Strand> strands_;
  std::vector<End> ends_;
  std::vector<Lobule> lobules_;  // (strands, kOnStrand)
};

}  // namespace trocar::surgery
