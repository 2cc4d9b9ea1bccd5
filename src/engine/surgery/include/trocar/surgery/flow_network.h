// SPDX-License-Identifier: Apache-2.0
/// \file flow_network.h  Bile and blood in ducts and arteries: what flows where, and what runs out of what was
/// cut.
///
/// Vessels are pipes between junctions (Poiseuille); what supplies and drains them is a pressure behind a
/// conductance; what leaves through an opening obeys the law of an orifice. Flow is steady within a tick: the
/// tubes are short and stiff, so that their waves pass in milliseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"

namespace trocar::surgery {

enum class Fluid : std::uint8_t { kBile, kBlood };
inline constexpr int kFluidCount = 2;
struct VesselClip;
struct VesselOpening;
void VisitState(base::StateArchive& archive, VesselClip& clip);
void VisitState(base::StateArchive& archive, VesselOpening& opening);

/// Of one fluid.
struct FluidProperties {
  double viscosity = 0;  ///< dynamic [Pa s], > 0
  double density = 0;    ///< [kg/m^3], > 0

  friend bool operator==(const FluidProperties&, const FluidProperties&) = default;
};
/// By Fluid.
using FluidTable = std::array<FluidProperties, kFluidCount>;
/// Viscosities are general knowledge, densities the domain facts' section 2.
inline constexpr FluidTable kBileAndBlood{{{1.0e-3, 1010.0}, {3.5e-3, 1060.0}}};

/// A duct or vessel from one junction to another.
struct FlowVessel {
  Fluid fluid = Fluid::kBile;
  std::uint32_t from = 0, to = 0;  ///< junctions
  double length = 0;               ///< [m], > 0
  double radius = 0;               ///< inside [m], > 0
};

/// Where vessels meet, are supplied or drained. Pressures are above that of the abdomen, which the gas sets.
struct FlowJunction {
  double pressure = 0;     ///< behind the conductance [Pa]
  double conductance = 0;  ///< of what supplies or drains it [m^3/(Pa s)]; 0: a mere junction

  friend bool operator==(const FlowJunction&, const FlowJunction&) = default;
};

/// A clip across a vessel. It narrows the clipped 3 mm to the radius (1 - closure) of before.
struct VesselClip {
  std::uint32_t vessel = 0;
  double position = 0;  ///< from the vessel's `from` end [m]
  double closure = 1;   ///< 0 open to 1 tight [-]
};

/// An opening in a vessel: cut across, or a hole in its side.
struct VesselOpening {
  std::uint32_t vessel = 0;
  double position = 0;  ///< from the vessel's `from` end [m]
  bool is_cut = true;   ///< cut across: two open ends; else one hole
  double area = 0;      ///< of the hole [m^2]; a cut end has the vessel's own section
  std::array<double, 2>
      sealed{};  ///< share of the end towards `from`, and towards `to`, that is coagulated or
                 ///< pressed shut, 0 to 1 [-]; a hole uses the first
};

/// Clips on the vessels and openings in them; part of the state of a surgery.
struct VesselActs {
  static constexpr std::size_t kMostClips = 32, kMostOpenings = 16;
  std::vector<VesselClip> clips;        ///< in the order in which they were placed
  std::vector<VesselOpening> openings;  ///< in the order in which they were made

  /// Reserves, so that acts allocate nothing later.
  VesselActs();
};

/// \pre when restoring: of the same network
void VisitState(base::StateArchive& archive, VesselActs& acts);

/// Leak from one end of an opening; its rate is in [m^3/s], >= 0.
struct Leak {
  std::uint32_t opening = 0;
  std::uint8_t end = 0;  ///< 0 towards `from` (or the hole), 1 towards `to`
  Fluid fluid = Fluid::kBile;
  double rate = 0;
};

/// Flow in one tick.
struct FlowReport {
  std::array<Leak, 2 * VesselActs::kMostOpenings> leaks;
  std::size_t leak_count = 0;
  std::array<double, kFluidCount> rate{};  ///< sum of the leaks of each fluid [m^3/s]

  std::span<const Leak> Leaks() const { return std::span(leaks).first(leak_count); }
};

/// A network of vessels, constant while a surgery runs, and its solver.
class FlowNetwork {
 public:
  static constexpr std::size_t kMostJunctions = 24, kMostVessels = 24;

  /// \return kPatientInvalid where a vessel names no junction, has no length or radius, is not finite, joins
  /// vessels of another fluid, or where there are too many
  static base::Result<FlowNetwork> Make(std::vector<FlowVessel> vessels, std::vector<FlowJunction> junctions,
                                        const FluidTable& fluids = kBileAndBlood);

  std::span<const FlowVessel> Vessels() const { return vessels_; }
  std::span<const FlowJunction> Junctions() const { return junctions_; }
  /// Pressure of a junction's supply, for organs whose pressure changes, such as a hollow one that is squeezed.
  /// \pre finite (TROCAR_ASSERT)
  void SetPressure(std::size_t junction, double pressure) noexcept;

  /// Clips and openings whose vessel or position lies outside are as if they were not there.
  /// \pre acts within their capacity (TROCAR_ASSERT)
  /// \note Real-time safe: no allocation, lock or throw.
  FlowReport Solve(const VesselActs& acts) noexcept;

  /// After Solve: pressure of a junction [Pa]; NaN where nothing supplies it.
  double PressureAt(std::size_t junction) const noexcept { return pressure_[junction]; }
  /// After Solve: what a junction's supply gives to the network [m^3/s]; negative: it takes.
  double SupplyAt(std::size_t junction) const noexcept;

  /// Whether fluid can pass between two junctions: no tight clip and no cut between them.
  bool AreConnected(const VesselActs& acts, std::size_t a, std::size_t b) const noexcept;

  /// Pressures: of supplies, and those that Solve found.
  void VisitState(base::StateArchive& archive);

 private:
  struct Piece;
  struct Outlet;
  FlowNetwork(std::vector<FlowVessel> vessels, std::vector<FlowJunction> junctions, const FluidTable& fluids)
      : vessels_(std::move(vessels)), junctions_(std::move(junctions)), fluids_(fluids) {}
  std::size_t CutIntoPieces(const VesselActs& acts, std::span<Piece> pieces, std::span<Outlet> outlets,
                            std::size_t& piece_count, std::size_t& outlet_count) const noexcept;

  static constexpr std::size_t kMostNodes = kMostJunctions + 2 * VesselActs::kMostOpenings;
  static constexpr std::size_t kMostPieces = kMostVessels + VesselActs::kMostOpenings;

  std::vector<FlowVessel> vessels_;
  std::vector<FlowJunction> junctions_;
  FluidTable fluids_;  // constant
  std::array<double, kMostNodes> pressure_{};
};

void VisitState(base::StateArchive& archive, FlowReport& report);

/// Where every drop is that has left the vessels. The balance always closes: left = pooled + aspirated.
struct FluidLedger {
  struct Account {
    double left = 0;       ///< the vessels or organs, since the start [m^3]
    double pooled = 0;     ///< lies in the abdomen [m^3]
    double aspirated = 0;  ///< taken out by suction [m^3]
  };
  std::array<Account, kFluidCount> fluids;
  double rinse_pooled = 0;  ///< irrigation fluid in the abdomen [m^3]
  double rinse_aspirated = 0;

  /// \pre volume >= 0 (TROCAR_ASSERT)
  void Leak(Fluid fluid, double volume) noexcept;
  void Rinse(double volume) noexcept;
  /// Takes from the pool, of each fluid in proportion to what lies there.
  /// \return how much was there to take, at most `volume` [m^3]
  double Aspirate(double volume) noexcept;
  double Pooled() const noexcept;
};
void VisitState(base::StateArchive& archive, FluidLedger& ledger);

}  // namespace trocar::surgery
