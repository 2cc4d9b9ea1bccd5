// SPDX-License-Identifier: Apache-2.0
/// \file electrosurgery.h  Effect of the electrode's current: heat in nodes and strands, and the parting of those that it heats.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/surgery/surgery_settings.h"
#include "trocar/surgery/tissue_heat.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// Nodes of the tissue first, then its strands: each is a part that has one temperature.
class Electrosurgery {
 public:
  Electrosurgery() = default;
  /// \param definition  of the tissue, strands included
  /// \param heat_mass   (n) of the layer that warms with a node [kg], >= 0
  Electrosurgery(const tissue::TissueDefinition& definition, std::span<const double> heat_mass,
                 const ElectrosurgerySettings& settings = {});

  /// Everything cold and whole.
  void Reset();

  /// Electrode in the world: a bare segment [m], and what flows through it.
  struct Electrode {
    collision::Segment bare;
    double power = 0;  ///< [W]
    double reach = 0;  ///< of the current beside the metal [m]
  };
  struct Target {
    std::uint32_t part = 0;  ///< node, or node count + strand
    double distance = 0;     ///< from the metal [m]
    double share = 1;        ///< of one contact: a surface is touched once, by the corners of a triangle
  };
  /// Finds the parts that the metal touches, through which the current flows: strands that hold, and the nearest organ or tube.
  /// \return how many were put into `found`
  /// \note Real-time safe.
  std::size_t FindTargets(const Electrode& electrode, std::span<const OrganSurface> organs,
                          const TubeSet& tubes, const tissue::TissueState& tissue,
                          std::span<Target> found) const noexcept;

  /// Adds an electrode's power to the next Step, shared out by nearness.
  void AddPower(const Electrode& electrode, std::span<const Target> targets) noexcept;

  /// One tick: heat flows, strands that are parted give way.
  /// \param[out] parted_nodes  tissue nodes that were parted in this tick, ascending; the first ones that fit
  /// \return how many nodes
  /// \note Real-time safe.
  std::size_t Step(double seconds, tissue::TissueState& tissue,
                   std::span<std::uint32_t> parted_nodes) noexcept;

  /// A node that a cut has made is as warm and burnt as the one it was made from.
  void CopyNode(std::uint32_t from, std::uint32_t to) noexcept;

  HeatInjury InjuryOf(std::uint32_t part) const noexcept { return TissueHeat::InjuryOf(state_, part); }
  /// Strands that heat parted in the last Step.
  std::size_t PartedStrands() const { return parted_strands_; }
  double Power() const { return power_; }  ///< of the last Step [W]
  /// \param[out] blanching, charring  of the first nodes, 0 to 1 [-]
  void Publish(std::span<float> blanching, std::span<float> charring) const noexcept;
  const HeatState& State() const { return state_; }
  void VisitState(base::StateArchive& archive);

 private:
  static constexpr std::size_t kMostSources = 256;

  ElectrosurgerySettings settings_;
  std::size_t node_count_ = 0;
  std::vector<tissue::Strand> strands_;
  std::vector<TissueHeat> heat_;  // one, or none before it is made
  HeatState state_, cold_;
  std::vector<std::uint8_t> was_parted_;  // (nodes)
  std::vector<TissueHeat::Source> sources_;
  std::size_t parted_strands_ = 0;
  double power_ = 0;
  bool is_cold_ = true;
};

}  // namespace trocar::surgery
