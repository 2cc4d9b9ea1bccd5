// SPDX-License-Identifier: Apache-2.0
/// \file cavity.h  Cavity around the organs: the insufflated abdominal wall in front, the dome of the diaphragm above the
/// liver, and the floor behind. Images of the organs do not show them, so they are analytic surfaces, fitted to the ports
/// and to the organs themselves.
///
/// World frame: x to the patient's left, y cranial, z anterior.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/surgery/contact.h"

namespace trocar::surgery {

/// Parts of the cavity, in the order of Cavity::FindClearances.
enum class CavityPart : std::uint8_t { kFrontWall, kDiaphragm, kFloor };
inline constexpr int kCavityParts = 3;

/// Distance of a point to one part, and the way back inside.
struct CavityClearance {
  double distance = 0;  ///< > 0 inside of the cavity [m]
  math::Vec3 inwards;   ///< unit
};

/// Made by FitCavity; a part that does not exist is infinitely far.
struct Cavity {
  /// Front wall: z = wall_top - across x^2 - along y^2, a dome that curves more across the body than along it.
  double wall_top = 0;                ///< at the umbilicus [m]
  double across = 2.3, along = 0.27;  ///< [1/m]; see FitCavity
  bool has_wall = false;

  /// Diaphragm: y = dome_top - dome_across (x - x0)^2 - dome_deep (z - z0)^2.
  double dome_top = 0, dome_x = 0, dome_z = 0;  ///< its highest point [m]
  double dome_across = 0, dome_deep = 0;        ///< half its curvatures there [1/m]
  bool has_dome = false;

  double floor = 0;  ///< z of the plane behind the organs [m]
  bool has_floor = false;

  /// \note Real-time safe. Distances to the two domes are of first order: height over slope, right near them.
  std::array<CavityClearance, kCavityParts> FindClearances(const math::Vec3& p) const noexcept;
};

/// Front wall through the ports (least squares of its height; its curvatures are those of the standard four ports of the
/// upper abdomen: epigastric, midclavicular and lateral lie 5, 15 and 45 mm behind the umbilicus); diaphragm through
/// the upper half of the liver's diaphragmatic face (least squares of its height); floor behind the hindmost point.
///
/// \param ports      of tools and laparoscope [m]; empty: no front wall
/// \param diaphragm  points of the liver's diaphragmatic face [m]; fewer than kLeastDomePoints, or a face that is no dome:
///                   no diaphragm
/// \param organs     every node of every organ [m]; empty: no floor
Cavity FitCavity(std::span<const math::Vec3> ports, std::span<const math::Vec3> diaphragm,
                 std::span<const math::Vec3> organs);
inline constexpr std::size_t kLeastDomePoints = 24;

struct CavityContactSettings {
  double stiffness = 100.0;  ///< of each spring [N/m]
  /// Play before a vertex that lay at a wall when imaged presses it [m]: what is at rest makes no springs.
  double play = 0.0001;
};

/// One organ in the cavity.
struct CavityContact {
  std::uint8_t organ = 0;
  /// (vertices) distance to each part that is allowed, <= -play: imaged organs may lie beyond a fitted wall [m]
  std::vector<std::array<double, kCavityParts>> allowed;
  std::vector<std::uint8_t> is_held;  ///< (vertices) by anatomy, at that wall or elsewhere: needs no contact
};

void VisitState(base::StateArchive& archive, CavityContact& contact);

/// \param positions  (n) of the whole system, at rest [m]
/// \param is_fixed   (n) held at rest by anatomy
CavityContact MakeCavityContact(const Cavity& cavity, std::span<const OrganSurface> organs,
                                std::span<const math::Vec3> positions, std::span<const std::uint8_t> is_fixed,
                                std::uint8_t organ, const CavityContactSettings& settings);

/// After a cut of the organ: new vertices may lie where they are.
/// \note Not real-time safe: allocates.
void UpdateTopology(const Cavity& cavity, std::span<const OrganSurface> organs,
                    std::span<const math::Vec3> positions, const CavityContactSettings& settings,
                    CavityContact& contact);

/// Adds the springs of one organ's vertices against the parts that they are at; links carry kNoHand.
///
/// \param positions_before  (n) before the last solve [m]: springs are made as far ahead as a vertex went outwards in it
/// \note Real-time safe.
void FindCavityContacts(const Cavity& cavity, std::span<const OrganSurface> organs,
                        std::span<const math::Vec3> positions, std::span<const math::Vec3> positions_before,
                        const CavityContactSettings& settings, const CavityContact& contact,
                        ContactSet& contacts) noexcept;

}  // namespace trocar::surgery
