// SPDX-License-Identifier: Apache-2.0
/// \file tissue_heat.h  Electrosurgery as heat: it flows, blanches, boils water off, chars and parts tissue.
///
/// Every node of the tissue holds heat and water; links carry heat to neighbours; blood carries it away (Pennes,
/// J Appl Physiol 1948). Proteins are damaged by the Arrhenius integral (Henriques and Moritz, Am J Pathol 1947). At
/// 100 degrees further heat boils water, as an electrode does that cuts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"

namespace trocar::surgery {

inline constexpr double kBodyTemperature = 37.0;      ///< [deg C]
inline constexpr double kBoilingTemperature = 100.0;  ///< [deg C]

/// Constants of soft tissue; values are general knowledge, to be tuned.
struct HeatConstants {
  double specific_heat = 3600;  ///< [J/(kg K)]
  double conductivity = 0.52;   ///< [W/(m K)]
  double water_share = 0.75;    ///< of the mass [-]
  double latent_heat = 2.26e6;  ///< of water [J/kg]
  /// Share of a node's warmth that blood carries away in a second, until damage seals its vessels [1/s].
  double perfusion = 6.4e-3;
  double damage_rate = 7.39e39;    ///< Arrhenius' frequency factor, liver [1/s]
  double damage_energy = 2.577e5;  ///< Arrhenius' activation energy, liver [J/mol]
  double char_temperature = 180;   ///< where dry tissue blackens [deg C]
  double most_temperature = 400;   ///< of dry tissue: what goes beyond is radiated [deg C]

  friend bool operator==(const HeatConstants&, const HeatConstants&) = default;
};

/// A part of tissue that has one temperature.
struct HeatNode {
  double mass = 0;             ///< [kg], > 0
  double perfusion_scale = 1;  ///< 0: no blood
};

/// Two parts that touch.
struct HeatLink {
  std::uint32_t a = 0, b = 0;
  double conductance = 0;  ///< [W/K], >= 0
};

/// Conductance of a strip of tissue [W/K].
/// \param width, depth  of its section [m]
/// \param length  [m], > 0
double CalcHeatConductance(const HeatConstants& constants, double width, double depth,
                           double length) noexcept;

/// State of the heat: all that a tick changes.
struct HeatState {
  std::vector<double> temperature;  ///< (n) [deg C]
  std::vector<double> water;        ///< (n) left, of the water at the start, 0 to 1 [-]
  std::vector<double> damage;       ///< (n) Arrhenius integral; at 1 63 % of the proteins are changed [-]
  std::vector<double> charring;     ///< (n) 0 pink to 1 black [-]
};

void VisitState(base::StateArchive& archive, HeatState& state);

/// Heat injury that a node has suffered so far, from none to worst.
enum class HeatInjury : std::uint8_t {
  kNone,
  kBlanched,  ///< damage >= 1: white, and its small vessels are sealed
  kParted,    ///< a third of its water is left: fibres and walls part there
  kCharred
};

/// Heat in a body of nodes and links.
class TissueHeat {
 public:
  /// \pre masses > 0, link ends in range, conductances >= 0, all finite (TROCAR_ASSERT)
  TissueHeat(std::span<const HeatNode> nodes, std::span<const HeatLink> links,
             const HeatConstants& constants = {});

  HeatState MakeState() const;
  std::size_t Size() const { return capacity_.size(); }

  /// Heat that the electrode leaves in a node.
  struct Source {
    std::uint32_t node = 0;
    double power = 0;  ///< [W], >= 0
  };

  /// One tick.
  ///
  /// \param sources  empty while no pedal is pressed or nothing is touched
  /// \param seconds  > 0
  /// \return heat that left with blood, steam and radiation [J]: sources - this = change of CalcHeat
  /// \note Real-time safe. Substeps keep the explicit scheme stable; their number depends on the links alone.
  double Step(std::span<const Source> sources, double seconds, HeatState& state) noexcept;

  /// Heat above body temperature, without that which is bound in steam [J].
  double CalcHeat(const HeatState& state) const noexcept;

  static HeatInjury InjuryOf(const HeatState& state, std::size_t node) noexcept;

 private:
  HeatConstants constants_;
  std::vector<double> capacity_;      // (n) wet [J/K]
  std::vector<double> water_energy_;  // (n) that boils all of it off [J]
  std::vector<double> blood_;         // (n) [W/K]
  std::vector<std::uint32_t> starts_, others_;
  std::vector<double> conductance_;    // with others_
  std::vector<double> gain_;           // (n) scratch [W]
  std::vector<std::uint8_t> is_warm_;  // (n) scratch
  double longest_step_ = 0;            // stable [s]
};

}  // namespace trocar::surgery
