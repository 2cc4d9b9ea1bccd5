// SPDX-License-Identifier: Apache-2.0
/// \file operation_parameters.h  How bile and blood flow, clips hold, stones are taken, current heats and suction works, and from
/// where on something is an error: the tables of an operation.
#pragma once

#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/surgery_settings.h"

namespace trocar::scene {

/// Supply and drainage at the ends of ducts and arteries. Pressures are above that of the abdomen, 12 mmHg of gas.
/// Source: decision 0026 for the aorta; the others are general knowledge, tunables.
struct VesselSupplies {
  surgery::FlowJunction aorta{12e3, 1.25e-10}, artery_bed{1e3, 5e-12};
  surgery::FlowJunction liver{2.5e3, 8e-12};         ///< secretes against 2.5 kPa, 0.6 mL/min
  surgery::FlowJunction bowel{1.3e3, 5e-11};         ///< the sphincter opens at 1.3 kPa
  surgery::FlowJunction hollow_organ{1.3e3, 1e-10};  ///< of bile that comes back from one
  double lumen_share = 0.7;                          ///< of a tube's outer radius that is open inside [-]

  friend bool operator==(const VesselSupplies&, const VesselSupplies&) = default;
};

/// Current of one pedal.
struct CurrentParameters {
  double power = 0;  ///< [W]
  double reach = 0;  ///< of the current beside the metal [m]

  friend bool operator==(const CurrentParameters&, const CurrentParameters&) = default;
};

/// Source: domain facts, section 1.3: 20 to 40 W.
struct ElectrodeParameters {
  CurrentParameters cut{35.0, 0.0008}, coagulate{25.0, 0.0012};
  double seal_reach = 0.003;  ///< [m]
  double seal_heat = 15.0;    ///< that shuts the end of a small vessel [J]
  double burnt_hole = 1e-6;   ///< left by a node that was burnt through [m^2]
  /// Rim of that hole [m]: a slit as long as the hook's toe (domain facts, section 1.3). Its lips lie on each other, so that bile
  /// finds the smaller area and a stone the whole rim.
  double burnt_rim = 0.009;
  double smoke_by_heat = 0.0012;  ///< [1/J]

  friend bool operator==(const ElectrodeParameters&, const ElectrodeParameters&) = default;
};

/// General knowledge, tunables.
struct SuctionParameters {
  double rinse_rate = 20e-6, aspirate_rate = 40e-6;  ///< [m^3/s]
  double pool_reach = 0.012;                         ///< of the tip beyond the pool's edge [m]
  double smoke_rate = 1.5;                           ///< share of the smoke that is sucked away [1/s]
  double smoke_fade = 0.08;                          ///< share of the smoke that leaves with the gas [1/s]

  friend bool operator==(const SuctionParameters&, const SuctionParameters&) = default;
};

struct OperationParameters {
  surgery::FluidTable fluids = surgery::kBileAndBlood;
  VesselSupplies supplies;
  surgery::VesselSettings vessels;
  surgery::StoneSettings stones;
  surgery::BedOozeSettings bed;
  surgery::ElectrosurgerySettings heat;
  ElectrodeParameters electrode;
  SuctionParameters suction;
  surgery::JudgementSettings judgement;

  friend bool operator==(const OperationParameters&, const OperationParameters&) = default;
};

}  // namespace trocar::scene
