// SPDX-License-Identifier: Apache-2.0
/// \file surgery_settings.h  The tables of vessels, of the bed's oozing and of electrosurgery.
#pragma once

#include "trocar/surgery/clip_hold.h"
#include "trocar/surgery/tissue_heat.h"

namespace trocar::surgery {

struct VesselSettings {
  ClipHoldSettings clips;
  /// Heat seals vessels up to this radius inside [m]: a millimetre across is held to be safe, more is not.
  double most_sealed_radius = 0.0009;
  double least_filling =
      0.1;  ///< of a gallbladder whose bile cannot run out any more, as a share of what there was [-]

  friend bool operator==(const VesselSettings&, const VesselSettings&) = default;
};

/// How much a bed that is torn off bleeds. No source gives the rate: tunables.
struct BedOozeSettings {
  double bed_volume = 15e-6;   ///< of a whole bed, until it has clotted [m^3]
  double clot_seconds = 87.0;  ///< in which bleeding falls to 1/e: to a half in a minute [s]

  friend bool operator==(const BedOozeSettings&, const BedOozeSettings&) = default;
};

/// How heat and current pass through nodes and strands.
struct ElectrosurgerySettings {
  HeatConstants tissue;
  double layer_depth = 0.0015;  ///< of a wall through which heat passes along it [m]
  double fibre_width = 0.0005;  ///< of a strand's square section [m]
  double fibre_density = 1000;  ///< of fat and fibres [kg/m^3]
  /// The shortest strands, those of the bed, stand for a patch of areolar tissue of which so much is fibre [kg].
  double least_strand_mass = 0.5e-6;
  double least_node_mass = 2e-6;  ///< [kg]
  /// What lies as far from the metal as this gets a quarter of what touches it gets [m].
  double quarter_power = 0.0004;

  friend bool operator==(const ElectrosurgerySettings&, const ElectrosurgerySettings&) = default;
};

}  // namespace trocar::surgery
