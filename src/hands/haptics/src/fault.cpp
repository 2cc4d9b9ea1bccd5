// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/fault.h"

#include <array>

#include "trocar/base/assert.h"

namespace trocar::haptics {
namespace {

using base::ErrorCode;

constexpr std::array<FaultEntry, static_cast<std::size_t>(Fault::kCount)> kTable = {{
    {Fault::kNone, ErrorCode::kNone, "none", "", ""},
    {Fault::kNotRequested, ErrorCode::kHapticNotArmed, "not_requested", "force is off", "switch force on"},
    {Fault::kStopped, ErrorCode::kHapticNotArmed, "stopped", "force was switched off",
     "switch it on again when you are ready"},
    {Fault::kDeviceLost, ErrorCode::kDeviceLost, "device_lost", "the haptic device is gone",
     "check its cable and power, connect it again, confirm its check pose"},
    {Fault::kSilent, ErrorCode::kDeviceStale, "silent", "the haptic device sends nothing",
     "check its cable; if it stays silent, connect it again"},
    {Fault::kBadSamples, ErrorCode::kHapticSamplesBad, "bad_samples", "the haptic device sends nonsense",
     "check its cable and its settings, then calibrate it"},
    {Fault::kJump, ErrorCode::kHapticJump, "jump", "the haptic device's position jumped",
     "take it out of the tissue and switch force on again; calibrate it if this repeats"},
    {Fault::kForceNotFinite, ErrorCode::kForceRefused, "force_not_finite",
     "the computed force was not a number", "take the tools out of the tissue and switch force on again"},
    {Fault::kForceImplausible, ErrorCode::kForceRefused, "force_implausible",
     "the computed force was impossibly large", "take the tools out of the tissue and switch force on again"},
    {Fault::kOverrun, ErrorCode::kHapticOverrun, "overrun", "the haptic loop stood still",
     "close other programs; trocar doctor says how to allow real-time priority"},
    {Fault::kSupervisor, ErrorCode::kHapticSupervisor, "supervisor",
     "the supervisor process is gone or had to stop the force", "start the simulator again"},
    {Fault::kOverheated, ErrorCode::kHapticWarm, "overheated", "the haptic device's motors are too hot",
     "let it cool for some minutes"},
    {Fault::kDeadMan, ErrorCode::kHapticDeadMan, "dead_man", "nobody holds the safety switch",
     "hold the button or pedal and switch force on again"},
    {Fault::kPoseUnconfirmed, ErrorCode::kHapticCheckPose, "pose_unconfirmed",
     "it is not confirmed which device is which hand",
     "bring each device to its check pose and press its button"},
    {Fault::kNotCalibrated, ErrorCode::kHapticNotCalibrated, "not_calibrated",
     "the haptic device is not calibrated",
     "put the stylus into its inkwell, or follow the maker's calibration"},
    {Fault::kOverspeed, ErrorCode::kHapticOverspeed, "overspeed", "the haptic device ran away",
     "hold it firmly and switch force on again; lower the force scale if this repeats"},
    {Fault::kSimulation, ErrorCode::kHapticSimulation, "simulation",
     "the simulation has no good tissue state", "start or reset the simulation, then switch force on again"},
    {Fault::kGate, ErrorCode::kForceRefused, "gate",
     "the device's limits or the gate's own output were out of range",
     "check the device's model and driver, start the simulator again, and report this if it repeats"},
    {Fault::kForceAtArming, ErrorCode::kHapticNotArmed, "force_at_arming", "the tools press tissue",
     "take the tools out of the tissue and switch force on again"},
}};

}  // namespace

std::span<const FaultEntry> FaultTable() noexcept {
  return kTable;
}

const FaultEntry& FindFault(Fault fault) noexcept {
  TROCAR_ASSERT(fault < Fault::kCount);
  return kTable[static_cast<std::size_t>(fault)];
}

}  // namespace trocar::haptics
