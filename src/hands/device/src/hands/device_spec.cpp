// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/device_spec.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "stylus_hands.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/hand_recording.h"
#include "trocar/device/hand_rig.h"
#include "trocar/device/igtl_tracker.h"
#include "trocar/device/polhemus_tracker.h"
#include "trocar/device/rate_hands.h"
#include "trocar/device/serial_port.h"
#include "trocar/device/tcp_port.h"

namespace trocar::device {
namespace {

using base::Error;
using base::ErrorCode;
using DriverResult = base::Result<std::unique_ptr<Driver>>;

constexpr std::string_view kSerial = "serial line";

constexpr std::string_view kOpenHaptics = "openhaptics", kHaply = "haply";

constexpr DeviceKind kKinds[] = {
    {"fastrak", kSerial, "Polhemus FASTRAK, ASCII records"},
    {"fastrak-binary", kSerial, "Polhemus FASTRAK, binary records"},
    {"liberty", kSerial, "Polhemus LIBERTY"},
    {"patriot", kSerial, "Polhemus PATRIOT"},
    {"jaw", kSerial, "jaw sensor, text lines; goes with another: liberty:...+jaw:..."},
    {"jaw-hid", "hidraw file, or none", "jaw sensor as a HID device"},
    {"igtl", "host:port", "any tracker over OpenIGTLink: PLUS, 3D Slicer"},
    {"gamepad", "", "gamepad: sticks move the hands, triggers close the jaws"},
    {"spacemouse", "", "3Dconnexion SpaceMouse, through spacenavd"},
    {kOpenHaptics, "names", "one or two haptic devices through OpenHaptics; with force: --haptics"},
    {kHaply, "count:port", "one or two Haply Inverse3 through their service; with force: --haptics"},
    {"play", "file", "a recording of trocar devices record"},
};

Error Usage(const std::string& text) {
  return {ErrorCode::kUsage, text};
}

base::Result<std::unique_ptr<PoseDriver>> MakePolhemus(PolhemusFormat format, const DeviceSpec& spec,
                                                       const DeviceStore& store, Clock& clock) {
  const TrackerEntry entry = store.Tracker(spec.kind);
  base::Result<TrackedHandsSettings> hands = MakeHandsSettings(entry);
  if (!hands) return hands.error();
  PolhemusSettings settings;
  settings.format = format;
  settings.stations = entry.stations;
  settings.hands = *hands;
  const int baud = spec.baud > 0 ? spec.baud : entry.baud;
  return std::unique_ptr<PoseDriver>(std::make_unique<PolhemusTracker>(
      settings, [path = spec.address, baud] { return OpenSerialPort(path, baud); }, clock));
}

/// "host:port", "host" or nothing for this machine.
base::Result<std::unique_ptr<PoseDriver>> MakeIgtl(const DeviceSpec& spec, const DeviceStore& store,
                                                   Clock& clock) {
  base::Result<TrackedHandsSettings> hands = MakeHandsSettings(store.Tracker(spec.kind));
  if (!hands) return hands.error();
  IgtlSettings settings;
  settings.hands = *hands;
  settings.hands.has_hemisphere_doubt = false;
  settings.hands.stale_after = 0.100;  // cameras may send 20 times a second
  std::string host = spec.address;
  int port = kIgtlPort;
  if (const std::size_t colon = host.rfind(':'); colon != std::string::npos) {
    const char* const end = host.data() + host.size();
    const auto [stop, failure] = std::from_chars(host.data() + colon + 1, end, port);
    if (failure != std::errc() || stop != end || port < 1 || port > 65535)
      return Usage("\"igtl:" + host + "\": the port is no number of 1 to 65535");
    host.resize(colon);
  }
  if (host.empty()) host = "localhost";
  return std::unique_ptr<PoseDriver>(std::make_unique<IgtlTracker>(
      settings, [host, port] { return ConnectTcp(host, port); }, clock));
}

std::unique_ptr<JawSensor> MakeJaw(const DeviceSpec& spec,
                                   const std::array<JawCalibration, kJawTools>& calibrations, Clock& clock) {
  constexpr int kBaud = 115200;  // without meaning for boards with native USB
  JawSettings settings;
  settings.calibrations = calibrations;
  if (spec.kind == "jaw-hid") {
    settings.format = JawFormat::kHid;
    return std::make_unique<JawSensor>(
        settings, [path = spec.address] { return OpenHidSensor(path); }, clock);
  }
  const int baud = spec.baud > 0 ? spec.baud : kBaud;
  return std::make_unique<JawSensor>(
      settings, [path = spec.address, baud] { return OpenSerialPort(path, baud); }, clock);
}

bool IsHaptic(std::string_view kind) {
  return kind == kOpenHaptics || kind == kHaply;
}

/// Hands of a haptic device, without force.
DriverResult MakeStylus(const DeviceSpec& spec) {
  auto device = MakeForceDriver(spec.address.empty() ? spec.kind : spec.kind + ":" + spec.address);
  if (!device) return device.error();
  return MakeStylusHands(std::move(*device));
}

/// A result of a kind of driver, as one of any driver.
template <typename Kind>
DriverResult AsDriver(base::Result<std::unique_ptr<Kind>> made) {
  if (!made) return made.error();
  return DriverResult(std::unique_ptr<Driver>(std::move(*made)));
}

DriverResult MakeOne(const DeviceSpec& spec, const DeviceStore& store, Clock& clock) {
  if (const auto format = FindFormat(spec.kind)) return AsDriver(MakePolhemus(*format, spec, store, clock));
  if (spec.kind == "igtl") return AsDriver(MakeIgtl(spec, store, clock));
  if (spec.kind == "gamepad") return DriverResult(std::make_unique<Gamepad>(MakeSdlGamepad(), clock));
  if (spec.kind == "spacemouse")
    return DriverResult(std::make_unique<SpaceMouse>(MakeSpacenavSource(spec.address), clock));
  if (IsHaptic(spec.kind)) return MakeStylus(spec);
  if (spec.kind == "play") return DriverResult(std::make_unique<HandPlayer>(spec.address, clock));
  return DriverResult(MakeJaw(spec, store.jaws, clock));
}

bool IsJaw(const DeviceSpec& spec) {
  return spec.kind == "jaw" || spec.kind == "jaw-hid";
}

}  // namespace

std::span<const DeviceKind> DeviceKinds() noexcept {
  return kKinds;
}

base::Result<DeviceSpec> ParseDeviceSpec(std::string_view text) {
  DeviceSpec spec;
  const std::string whole(text);
  const std::size_t colon = std::min(text.find(':'), text.size());
  spec.kind = text.substr(0, colon);
  const auto* const kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                        [&](const DeviceKind& one) { return one.name == spec.kind; });
  if (kind == std::end(kKinds)) {
    std::string known;
    for (const DeviceKind& one : kKinds) known.append(known.empty() ? "" : ", ").append(one.name);
    return Usage("\"" + spec.kind + "\" is no kind of device; there are " + known);
  }
  std::string_view address = text.substr(std::min(colon + 1, text.size()));
  constexpr std::string_view kBaudMark = ",baud=";
  if (const std::size_t at = address.rfind(kBaudMark); at != std::string_view::npos) {
    const std::string_view digits = address.substr(at + kBaudMark.size());
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), spec.baud);
    if (failure != std::errc() || end != digits.data() + digits.size() || spec.baud <= 0)
      return Usage("\"" + whole + "\": the speed is no number");
    address = address.substr(0, at);
  }
  spec.address = address;
  const bool needs_address = kind->address == kSerial || kind->address == "file";
  if (needs_address && spec.address.empty()) {
    return Usage("\"" + whole + "\" names no " + std::string(kind->address) + ": write " + spec.kind +
                 (kind->address == kSerial ? ":/dev/..., as trocar devices list shows it" : ":FILE"));
  }
  return spec;
}

DriverResult MakeDriver(std::string_view text, const DeviceStore& store, Clock& clock) {
  const std::size_t plus = std::min(text.find('+'), text.size());
  const base::Result<DeviceSpec> hands = ParseDeviceSpec(text.substr(0, plus));
  if (!hands) return hands.error();
  DriverResult first = MakeOne(*hands, store, clock);
  if (!first || plus == text.size()) return first;
  const base::Result<DeviceSpec> jaws = ParseDeviceSpec(text.substr(plus + 1));
  if (!jaws) return jaws.error();
  if (IsJaw(*hands) || !IsJaw(*jaws))
    return Usage(std::string("\"").append(text) +
                 "\": a jaw sensor goes behind the +, something with hands before it");
  DriverResult second = MakeOne(*jaws, store, clock);
  if (!second) return second;
  return DriverResult(std::make_unique<HandRig>(std::move(*first), std::move(*second)));
}

ButtonMap FindButtons(std::string_view text, const DeviceStore& store) {
  const std::string kind(text.substr(0, text.find_first_of(":+")));
  return store.Buttons(IsHaptic(kind) ? "haptics" : kind);
}

base::Result<std::unique_ptr<PoseDriver>> MakeTracker(std::string_view text, const DeviceStore& store,
                                                      Clock& clock) {
  const base::Result<DeviceSpec> spec = ParseDeviceSpec(text);
  if (!spec) return spec.error();
  if (const auto format = FindFormat(spec->kind)) return MakePolhemus(*format, *spec, store, clock);
  if (spec->kind == "igtl") return MakeIgtl(*spec, store, clock);
  return Usage("\"" + spec->kind + "\" is no tracker with sensors to calibrate");
}

base::Result<std::unique_ptr<JawSensor>> MakeJawSensor(std::string_view text, Clock& clock) {
  const base::Result<DeviceSpec> spec = ParseDeviceSpec(text);
  if (!spec) return spec.error();
  if (!IsJaw(*spec)) return Usage("\"" + spec->kind + "\" is no jaw sensor; write jaw:/dev/... or jaw-hid");
  return MakeJaw(*spec, {}, clock);
}

std::vector<FoundDevice> ListDevices() {
  std::vector<FoundDevice> found;
  for (const SerialPortInfo& port : ListSerialPorts()) {
    std::string kind;
    if (port.description.find("LIBERTY") != std::string::npos) kind = "liberty";
    if (port.description.find("PATRIOT") != std::string::npos) kind = "patriot";
    if (port.description.find("Leonardo") != std::string::npos) kind = "jaw";
    found.push_back({(kind.empty() ? "KIND" : kind) + ":" + port.path, port.description});
  }
  for (const std::string& name : ListGamepads()) found.push_back({"gamepad", name});
  for (const HidInfo& sensor : ListHidSensors())
    found.push_back({"jaw-hid:" + sensor.path, sensor.description});
  if (IsSpacenavThere()) found.push_back({"spacemouse", "spacenavd answers"});
  if (const std::string library = FindOpenHaptics(); !library.empty())
    found.push_back({std::string(kOpenHaptics), "OpenHaptics is installed: " + library});
  if (ConnectTcp("localhost", kHaplyPort, 0.1).ok())
    found.push_back({std::string(kHaply), "a service answers on Haply's port"});
  return found;
}

}  // namespace trocar::device
