// SPDX-License-Identifier: Apache-2.0
/// \file vital_signs.h  Vital signs that a monitor would sound: heart rate and saturation after a loss of blood.
/// Source of the heart rates: American College of Surgeons, Advanced Trauma Life Support, classes of haemorrhage of an adult
/// of 70 kg: 100, 120 and 140 beats a minute at losses of 15, 30 and 40 % of 5 l.
#pragma once

namespace trocar::sound {

struct VitalSigns {
  double heart_rate = 72;    ///< [1/min]
  double saturation = 0.98;  ///< of haemoglobin with oxygen, 0 to 1 [-]

  friend bool operator==(const VitalSigns&, const VitalSigns&) = default;
};

/// A cue for training, not physiology: nothing else than lost blood counts, and the saturation falls as a trainee has to hear
/// it, from 750 ml on.
/// \param lost  blood that has left vessels and organs since the start [m^3], >= 0
VitalSigns CalcVitalSigns(double lost) noexcept;

/// Frequency of the pulse tone [Hz]: 880 at full saturation, half a semitone lower for each percent less.
/// \param saturation  clamped to 0.5 to 1
double CalcPulsePitch(double saturation) noexcept;

}  // namespace trocar::sound
