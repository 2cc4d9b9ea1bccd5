// SPDX-License-Identifier: Apache-2.0
/// \file guards.h  Names of the guards that the negative controls leave out, one at a time, at build time.
#pragma once

namespace trocar::haptics {

/// A build for a negative control defines TROCAR_LEFT_OUT_GUARD as one of these; the product defines nothing.
enum class Guard {
  kNone,
  kSettings,
  kOutput,
  kFinite,
  kPlausible,
  kClamp,
  kRise,
  kSpeed,
  kHeat,
  kRamp,
  kArmed,
  kLatch,
  kLost,
  kSilence,
  kBadSamples,
  kJump,
  kOverrun,
  kSupervisor,
  kDeadMan,
  kCheckPose,
  kCount
};

#ifdef TROCAR_LEFT_OUT_GUARD
inline constexpr Guard kLeftOut = Guard::TROCAR_LEFT_OUT_GUARD;
#else
inline constexpr Guard kLeftOut = Guard::kNone;
#endif

constexpr bool IsOn(Guard guard) {
  // without wrong settings the gate's last check has nothing to find
  if (kLeftOut == Guard::kOutput && guard == Guard::kSettings) return false;
  return guard != kLeftOut;
}

}  // namespace trocar::haptics
