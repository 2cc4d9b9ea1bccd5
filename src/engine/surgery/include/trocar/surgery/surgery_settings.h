// SPDX-License-Identifier: Apache-2.0
/// \file surgery_settings.h  The tables of vessels, clips, stones, of the bed's oozing, of electrosurgery and of what counts as an error.
#pragma once

#include "trocar/surgery/clip_hold.h"
#include "trocar/surgery/tissue_heat.h"

namespace trocar::surgery {

/// A clip, and what counts as between the legs of its applier. No source but the size of common clips: tunables.
struct ClipShape {
  double width = 0.0012;   ///< along the vessel: two whose middles are nearer lie over each other [m]
  double height = 0.0012;  ///< of its middle over what it lies on, when it is lost [m]
  double gap = 0.0006;     ///< between the closed legs [m]
  double catch_beside =
      0.0015;  ///< beside a vessel's radius: how near to the closed jaws its axis has to be [m]
  double drawn_away = 0.004;      ///< from the closed jaws: what is farther is out of them [m]
  double pulled_before = 0.0025;  ///< before a clip: what is held there holds the clip [m]

  friend bool operator==(const ClipShape&, const ClipShape&) = default;
};

/// How jaws and suction take gallstones. Tunables; the shares of the jaws' opening are those of GraspSettings.
struct StoneSettings {
  double out_speed = 0.03;                        ///< at which a stone leaves with the bile [m/s]
  double out_gap = 0.0003;                        ///< beyond the hole [m]
  double suction_reach = 0.003;                   ///< of the bore beyond a stone's surface [m]
  double closed_share = 0.20, open_share = 0.35;  ///< of the jaws' opening
  double let_go = 0.05;                           ///< more than the stone is wide [rad]
  double near_hinge = 0.25;  ///< of the jaws' length: what lies nearer to the hinge is not taken [-]
  double jaw_reach = 0.5;    ///< of a stone's radius, beside and beyond the jaws [-]

  friend bool operator==(const StoneSettings&, const StoneSettings&) = default;
};

struct VesselSettings {
  ClipHoldSettings clips;
  ClipShape clip_shape;
  /// Heat seals vessels up to this radius inside [m]: a millimetre across is held to be safe, more is not.
  double most_sealed_radius = 0.0009;
  double least_filling =
      0.1;  ///< of a hollow organ whose bile cannot run out any more, as a share of what there was [-]

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
  /// Distance from the metal at which a part gets a quarter of the power that it would get by touching it [m].
  double quarter_power = 0.0004;

  friend bool operator==(const ElectrosurgerySettings&, const ElectrosurgerySettings&) = default;
};

/// From where on something counts as an error of an operation. Source: domain facts, section 1.4, for the blood and the duct; the others are tunables.
struct JudgementSettings {
  double much_blood = 50e-6;   ///< [m^3]
  double near_duct = 0.005;    ///< of current to a duct that must stay [m]
  double kept_fat = 0.005;     ///< beside the middle line of such a duct, which need not be exposed [m]
  double kept_sheath = 0.003;  ///< about the middle line of an artery that must stay; it may stay covered [m]
  double idle_seconds = 0.25;  ///< of current into nothing that no eye would note [s]
  double tip_in = 0.08;        ///< a tool this deep has been pushed in [m]
  double blind_seconds = 1.5;  ///< for which it may be outside the picture then [s]

  friend bool operator==(const JudgementSettings&, const JudgementSettings&) = default;
};

}  // namespace trocar::surgery
