// SPDX-License-Identifier: Apache-2.0
/// \file clip_hold.h  Load that a closed clip withstands before it slips along its vessel.
///
/// Sources: Deans, Wilson and Brough, Arch Surg 1995;130:439 (no clip of 90 was displaced by 300 mmHg); Nelson et al., Arch
/// Surg 1992;127:718 (4.1 to 4.8 N along the vessel dislodge a clip on a tube). How much a partial, a crossed or a strained
/// clip loses has no source: tunables.
#pragma once

namespace trocar::surgery {

/// How a clip was put on.
struct ClipGrip {
  double closure = 1;        ///< share of the vessel between its legs, 0 to 1 [-]
  bool is_crossed = false;   ///< it lies over another, or another over it
  double vessel_radius = 0;  ///< outside [m], > 0
};

/// Load that clips withstand, and how fast they slip beyond it.
struct ClipHoldSettings {
  double pressure = 40e3;        ///< 300 mmHg: Deans 1995 [Pa]
  double pull = 4.4;             ///< between 4.08 and 4.78 N: Nelson 1992 [N]
  double crossed_share = 0.1;    ///< of both: legs that do not lie flat hold by a corner [-]
  double thick_radius = 0.0025;  ///< of a vessel that the clip is meant for, outside [m]
  double partial_power = 6.0;    ///< of the closure: what lies beyond the tips keeps them apart [-]
  double slip_speed = 0.001;     ///< under twice what it withstands [m/s]
  double fastest_slip = 0.005;   ///< [m/s]

  friend bool operator==(const ClipHoldSettings&, const ClipHoldSettings&) = default;
};

/// Largest pressure and pull that a clip withstands, each alone.
struct ClipHold {
  double pressure = 0;  ///< on its closed side above the other [Pa]
  double pull = 0;      ///< along the vessel, at its free end [N]
};
ClipHold CalcClipHold(const ClipGrip& grip, const ClipHoldSettings& settings = {}) noexcept;

/// Pressure and pull together, as a share of what the clip withstands: above 1 it slips.
double CalcClipLoad(const ClipHold& hold, double pressure, double pull) noexcept;

/// How fast a clip slips under a load [m/s]; 0 up to a load of 1.
double CalcSlipSpeed(double load, const ClipHoldSettings& settings = {}) noexcept;

}  // namespace trocar::surgery
