// SPDX-License-Identifier: Apache-2.0
/// \file emulated_line.h  Time that moves an emulator along, so that driver and device run in one thread.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/device/polhemus_tracker.h"
#include "trocar/device/ports.h"

namespace trocar::device {

/// While the driver sleeps, the emulators work.
class EmulatorClock : public Clock {
 public:
  double Now() const noexcept override { return time_; }
  void Sleep(double seconds) noexcept override {
    constexpr double kStep = 0.002;
    const double end = time_ + seconds;
    while (time_ < end) {
      time_ = std::min(end, time_ + kStep);
      for (EmulatorHost* host : hosts_) host->Step(time_);
    }
  }
  void Add(EmulatorHost& host) { hosts_.push_back(&host); }

 private:
  double time_ = 0;
  std::vector<EmulatorHost*> hosts_;
};

/// A tracker in software with known instruments on a pseudo-terminal, and the driver for it.
struct EmulatedTracker {
  explicit EmulatedTracker(PolhemusFormat format, std::vector<Fault> faults = {}, int stations = 2) {
    hands = *MakeHandsSettings(DefaultTracker());
    PolhemusEmulation emulation;
    emulation.format = format;
    emulation.stations = stations;
    emulation.motion = SpoilMotion(faults, MoveHands(hands, CalcHandMotion));
    host = *EmulatorHost::MakeSerial(MakePolhemusEmulator(emulation), std::move(faults));
    clock.Add(*host);
    settings.format = format;
    settings.hands = hands;
    driver = std::make_unique<PolhemusTracker>(
        settings, [this] { return OpenSerialPort(host->Address(), 115200); }, clock);
  }
  ReadStatus Read() { return driver->Read(samples); }
  testing::AssertionResult Start() {
    for (const base::Status& step : {driver->Configure(), driver->Activate()}) {
      if (!step) return testing::AssertionFailure() << step.error().Text();
    }
    return testing::AssertionSuccess();
  }

  TrackedHandsSettings hands;
  PolhemusSettings settings;
  std::unique_ptr<EmulatorHost> host;
  EmulatorClock clock;
  std::unique_ptr<PolhemusTracker> driver;
  HandSamples samples;
};

}  // namespace trocar::device
