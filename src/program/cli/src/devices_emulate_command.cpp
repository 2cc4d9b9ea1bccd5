// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "device_console.h"
#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/host/console.h"
#include "trocar/host/translate.h"

namespace trocar::cli {
namespace {

using device::Emulator;

constexpr const char *kJawHid = "jaw-hid", *kSpaceMouse = "spacemouse";

struct EmulateOptions {
  std::string kind;
  std::string motion = "hands";
  std::vector<std::string> faults;
  double seconds = 0;
  int port = 0;
  int stations = 2;
};

base::Result<std::unique_ptr<Emulator>> MakeEmulator(const EmulateOptions& options,
                                                     const std::vector<device::Fault>& faults) {
  const device::HandMotion motion = options.motion == "rest" ? device::CalcRest : device::CalcHandMotion;
  if (options.kind == "haply") {
    const auto position = [motion](int device, double time) {
      const device::HandSample hand = motion(time)[static_cast<std::size_t>(device)];
      return math::Vec3{-0.1 * hand.pan, 0.12 - hand.depth, 0.1 * hand.tilt};
    };
    return device::MakeHaplyEmulator({2, device::SpoilCursor(faults, position)},
                                     std::make_shared<device::HaplyForces>());
  }
  if (options.kind == "jaw") return device::MakeJawEmulator({{}, motion});
  if (options.kind == kJawHid) return device::MakeJawEmulator({{}, motion, device::JawFormat::kHid});
  if (options.kind == kSpaceMouse) {
    if (options.motion == "rest")
      return device::MakeSpaceMouseEmulator([](double) { return device::SpaceMouseState{}; });
    return device::MakeSpaceMouseEmulator(device::CalcCapMotion);
  }
  const auto hands = device::MakeHandsSettings(device::DefaultTracker());
  if (!hands) return hands.error();
  const device::SensorMotion sensors = device::SpoilMotion(
      faults, options.motion == "tip" ? device::MoveAboutTip(*hands) : device::MoveHands(*hands, motion));
  if (options.kind == "igtl") return device::MakeIgtlEmulator(sensors);
  const auto format = device::FindFormat(options.kind);
  if (!format) return base::Error{base::ErrorCode::kUsage, "\"" + options.kind + "\" is not emulated"};
  device::PolhemusEmulation emulation;
  emulation.format = *format;
  emulation.stations = options.stations;
  emulation.motion = sensors;
  return device::MakePolhemusEmulator(std::move(emulation));
}

/// Where the device's driver looks for it: a port, a socket or a serial line.
base::Result<std::unique_ptr<device::EmulatorHost>> Serve(const EmulateOptions& options,
                                                          std::unique_ptr<Emulator> emulator,
                                                          const std::vector<device::Fault>& faults) {
  using device::EmulatorHost;
  if (options.kind == "igtl" || options.kind == "haply")
    return EmulatorHost::MakeTcp(std::move(emulator), options.port, faults);
  if (options.kind != kJawHid && options.kind != kSpaceMouse)
    return EmulatorHost::MakeSerial(std::move(emulator), faults);
  const auto path =
      std::filesystem::temp_directory_path() / ("trocar-" + options.kind + "-" + std::to_string(::getpid()));
  return EmulatorHost::MakeLocal(std::move(emulator), path.string(),
                                 options.kind == kJawHid ? device::kHidReportSize : 0, faults);
}

/// What a driver calls the device, on its own or, for the service of Haply, by the port alone.
std::string FormatName(const std::string& kind, const std::string& address) {
  if (kind != "haply") return kind + ":" + address;
  return kind + ":2:" + address.substr(address.rfind(':') + 1);
}

base::Status Emulate(const EmulateOptions& options) {
  std::vector<device::Fault> faults;
  for (const std::string& text : options.faults) {
    const auto fault = device::ParseFault(text);
    if (!fault) return fault.error();
    faults.push_back(*fault);
  }
  auto emulator = MakeEmulator(options, faults);
  if (!emulator) return emulator.error();
  const auto host = Serve(options, std::move(*emulator), faults);
  if (!host) return host.error();
  const std::string name = FormatName(options.kind, (*host)->Address());
  host::PrintLine(name);
  std::fflush(stdout);
  host::PrintErrorLine(
      host::TranslateWith("Emulating; try: trocar devices test {1}   (Ctrl+C ends)", {name}));
  const InterruptWatch interrupt;
  device::Clock& clock = device::SystemClock();
  const double start = clock.Now();
  for (double time = 0; !interrupt.IsInterrupted() && (options.seconds <= 0.0 || time < options.seconds);
       time = clock.Now() - start) {
    (*host)->Step(time);
    clock.Sleep(0.001);
  }
  return {};
}

}  // namespace

void AddDevicesEmulateCommand(CLI::App& devices, Outcome& outcome) {
  CLI::App* command =
      devices.add_subcommand("emulate", "A device in software, byte for byte, with faults on demand");
  auto options = std::make_shared<EmulateOptions>();
  command->add_option("kind", options->kind, "Which device")
      ->required()
      ->check(CLI::IsMember(
          {"fastrak", "fastrak-binary", "liberty", "patriot", "jaw", kJawHid, kSpaceMouse, "igtl", "haply"}))
      ->type_name("KIND");
  command
      ->add_option("--fault", options->faults,
                   "KIND[=RATE][@START][+DURATION], in seconds; kinds: silence, garbage, flips (RATE of "
                   "bits), unplug, "
                   "flood, jump. May be given several times")
      ->type_name("FAULT");
  command
      ->add_option("--motion", options->motion,
                   "What the instruments do; tip: they swing about their tips, for calibration")
      ->check(CLI::IsMember({"hands", "tip", "rest"}))
      ->capture_default_str();
  command->add_option("--stations", options->stations, "Sensors plugged in")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  command
      ->add_option("--port", options->port,
                   "igtl, haply: port on this machine; chosen by the system if not given")
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  command->add_option("--seconds", options->seconds, "How long; until Ctrl+C if not given")
      ->check(CLI::Range(0.05, 86400.0))
      ->type_name("S");
  command->footer(
      "Prints the device's name for --device and trocar devices test, then serves it.\n"
      "Example: trocar devices emulate liberty --fault silence@5+2 --fault flips=0.001@10");
  command->callback([options, &outcome] { outcome.status = Emulate(*options); });
}

}  // namespace trocar::cli
