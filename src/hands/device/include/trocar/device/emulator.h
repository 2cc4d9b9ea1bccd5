// SPDX-License-Identifier: Apache-2.0
/// \file emulator.h  Devices in software that speak byte for byte as the real ones do, with faults on demand: for tests,
/// for trying Trocar without hardware, and for builders of hardware.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/device/hand_calibration.h"
#include "trocar/device/jaw_sensor.h"
#include "trocar/device/local_port.h"
#include "trocar/device/polhemus.h"
#include "trocar/device/rate_hands.h"
#include "trocar/device/serial_port.h"
#include "trocar/device/tcp_port.h"
#include "trocar/device/tracked_hands.h"
#include "trocar/math/random.h"

namespace trocar::device {

// --- what the emulated hands do

using HandSamples = std::array<HandSample, kChannelCount>;
/// Joints at a time [s].
using HandMotion = std::function<HandSamples(double time)>;

/// Both hands swing, turn, go in and out and open and close their jaws, smoothly and slower than 0.5 m/s; the shafts swing
/// through more than 30 degrees.
HandSamples CalcHandMotion(double time) noexcept;
/// Hands at rest.
HandSamples CalcRest(double time) noexcept;

/// One sensor's pose at a time: what a tracker measures.
using SensorMotion = std::function<math::Pose(int channel, double time)>;
/// Sensors on instruments that move so.
SensorMotion MoveHands(const TrackedHandsSettings& settings, HandMotion motion);
/// The tip stands in a dimple and the rest swings about it: for pivot calibration.
SensorMotion MoveAboutTip(const TrackedHandsSettings& settings);

// --- the devices

/// A device's side of a line. Time comes from outside, so that a test is the same each time.
class Emulator {
 public:
  virtual ~Emulator() = default;
  /// Bytes from the driver.
  virtual void Receive(std::string_view bytes) = 0;
  /// Bytes that the device sends up to `time` [s], not falling.
  virtual std::string Advance(double time) = 0;
  /// The line is new: whatever the last driver set is as after power-on, where the device forgets it.
  virtual void Connect() {}
};

struct PolhemusEmulation {
  PolhemusFormat format = PolhemusFormat::kFastrakAscii;
  int stations = 2;  ///< with a sensor plugged in; station n is channel n - 1
  SensorMotion motion;
};
std::unique_ptr<Emulator> MakePolhemusEmulator(PolhemusEmulation emulation);

struct JawEmulation {
  std::array<JawCalibration, kJawTools> calibrations;  ///< of the emulated potentiometers
  HandMotion motion;
  JawFormat format = JawFormat::kText;
};
/// 100 lines a second for each tool, or 100 reports of both.
std::unique_ptr<Emulator> MakeJawEmulator(JawEmulation emulation);

/// An OpenIGTLink server: 60 times a second the left hand as TRANSFORM, the right one as TDATA.
std::unique_ptr<Emulator> MakeIgtlEmulator(SensorMotion motion);

/// Motion of a SpaceMouse's cap by a person: its state at a time [s].
using CapMotion = std::function<SpaceMouseState(double time)>;
/// Pushed and turned to and fro in all axes; the left button goes down and up.
SpaceMouseState CalcCapMotion(double time) noexcept;
/// spacenavd with a SpaceMouse: 60 events a second, in the daemon's first protocol.
std::unique_ptr<Emulator> MakeSpaceMouseEmulator(CapMotion motion);

/// Where the cursors of a haptic device are at a time; device frame of force_driver.h [m].
using CursorMotion = std::function<math::Vec3(int device, double time)>;
struct HaplyEmulation {
  int devices = 1;  ///< 1 or 2
  CursorMotion position;
  /// Of the grip, held at a time [s], bit 0 is the first; may be empty.
  std::function<std::uint32_t(double time)> buttons = {};
};
/// Forces that a driver last sent to the emulated service.
struct HaplyForces {
  std::array<math::Vec3, 2> newtons;  ///< device frame [N]
  std::uint64_t messages = 0;
};
/// The service of Haply's Inverse3: WebSocket, a state for every message of forces.
/// \param forces  written as they come in
std::unique_ptr<Emulator> MakeHaplyEmulator(HaplyEmulation emulation, std::shared_ptr<HaplyForces> forces);

// --- faults

enum class FaultKind {
  kSilence,  ///< nothing is sent
  kGarbage,  ///< random bytes in place of half the records
  kFlips,    ///< bits turned at `rate`
  kUnplug,   ///< the line hangs up
  kFlood,    ///< every record very many times
  kJump,     ///< one record in ten is 50 mm off
};
/// "silence", "garbage", "flips", "unplug", "flood", "jump"
std::string_view FaultName(FaultKind kind) noexcept;

struct Fault {
  FaultKind kind = FaultKind::kSilence;
  double start = 0;       ///< [s]
  double duration = 1e9;  ///< [s]
  double rate = 1e-3;     ///< kFlips: turned bits per bit [-]

  bool IsOn(double time) const noexcept { return time >= start && time < start + duration; }
};

/// "silence", "flips=0.01", "unplug@5", "silence@2+0.5": kind, rate, start [s], duration [s].
/// \return kUsage
base::Result<Fault> ParseFault(std::string_view text);

/// Spoils what a device sends. `jump` is left to SpoilMotion().
std::string SpoilBytes(const std::vector<Fault>& faults, double time, std::string bytes,
                       math::Random& random);
/// Adds the jumps to what a tracker, or a haptic device, measures.
SensorMotion SpoilMotion(std::vector<Fault> faults, SensorMotion motion);
CursorMotion SpoilCursor(std::vector<Fault> faults, CursorMotion motion);

// --- a line for it

/// Serves one emulator on a pseudo-terminal, or on a loopback port or a socket's path to one caller at a time.
class EmulatorHost {
 public:
  /// \param seed  of the faults
  static base::Result<std::unique_ptr<EmulatorHost>> MakeSerial(std::unique_ptr<Emulator> emulator,
                                                                std::vector<Fault> faults = {},
                                                                std::uint64_t seed = 1);
  /// \param port  0 lets the system choose
  static base::Result<std::unique_ptr<EmulatorHost>> MakeTcp(std::unique_ptr<Emulator> emulator, int port,
                                                             std::vector<Fault> faults = {},
                                                             std::uint64_t seed = 1);

  /// \param path         of the socket; gone with the host
  /// \param packet_size  bytes of a report, each of which is read alone; 0 for a stream
  static base::Result<std::unique_ptr<EmulatorHost>> MakeLocal(std::unique_ptr<Emulator> emulator,
                                                               const std::string& path,
                                                               std::size_t packet_size,
                                                               std::vector<Fault> faults = {},
                                                               std::uint64_t seed = 1);

  /// Takes in what came and sends what is due. Call it every few milliseconds.
  /// \param time  since the start [s], not falling
  void Step(double time);
  /// Pulls the plug of a serial line, closes the connection of a TCP one.
  void Unplug() noexcept;
  /// "/dev/pts/7", "localhost:40123" or a socket's path: what a driver opens.
  const std::string& Address() const noexcept { return address_; }

 private:
  EmulatorHost(std::unique_ptr<Emulator> emulator, std::vector<Fault> faults, std::uint64_t seed)
      : emulator_(std::move(emulator)), faults_(std::move(faults)), random_(seed) {}
  Transport* FindLine();
  void Send(Transport& line);

  std::unique_ptr<Emulator> emulator_;
  std::vector<Fault> faults_;
  math::Random random_;
  std::unique_ptr<PseudoTerminal> terminal_;
  std::unique_ptr<TcpListener> listener_;
  std::unique_ptr<LocalListener> local_listener_;
  std::size_t packet_size_ = 0;  // [bytes]; 0: a stream
  std::unique_ptr<Transport> caller_;
  std::string address_;
  std::string unsent_;  // what the line had no room for
};

}  // namespace trocar::device
