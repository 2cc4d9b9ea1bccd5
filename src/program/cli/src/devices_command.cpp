// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "device_console.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/hand_recording.h"
#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"

namespace trocar::cli {

using host::PrintLines;
using host::Say;
using host::Translate;

namespace {

constexpr const char* kSpecHelp =
    "Device, such as liberty:/dev/ttyUSB0 or fastrak:/dev/ttyS0,baud=19200+jaw:/dev/ttyACM0";

constexpr const char* kButtonKinds[] = {"gamepad", "spacemouse", "haptics", "play"};
constexpr const char* kHands[] = {"left", "right"};
constexpr const char* kChannels[] = {"left", "right", "laparoscope"};

/// The acts of a hand's buttons up to the last that has one.
std::vector<std::string> ActNames(const std::array<device::HandAct, device::kMostButtons>& acts) {
  std::vector<std::string> names;
  for (const device::HandAct act : acts) names.emplace_back(device::ActName(act));
  while (!names.empty() && names.back() == device::ActName(device::HandAct::kNone)) names.pop_back();
  return names;
}

/// What buttons and pedals do, as it could be written into the settings.
nlohmann::ordered_json ButtonsJson(const device::DeviceStore& store) {
  nlohmann::ordered_json json;
  for (const char* kind : kButtonKinds) {
    const device::ButtonMap map = store.Buttons(kind);
    for (std::size_t hand = 0; hand < map.size(); ++hand) json[kind][kHands[hand]] = ActNames(map[hand]);
  }
  return json;
}

void PrintButtons(const device::DeviceStore& store) {
  Say("\nButtons of each hand, from the first (change them in the settings file: docs/devices.md):\n");
  std::vector<std::vector<std::string>> rows;
  for (const char* kind : kButtonKinds) {
    const device::ButtonMap map = store.Buttons(kind);
    for (std::size_t hand = 0; hand < map.size(); ++hand) {
      std::string acts;
      for (const std::string& name : ActNames(map[hand])) acts += (acts.empty() ? "" : ", ") + name;
      rows.push_back(
          {std::string("  ") + kind, Translate(kHands[hand]), acts.empty() ? Translate("nothing") : acts});
    }
  }
  for (const auto& [key, act] : store.keys)
    rows.push_back({"  " + host::TranslateWith("keyboard key {1}", {key}), Translate("chosen"),
                    std::string(device::ActName(act))});
  PrintLines(host::FormatTable(rows));
}

void ListDevices(bool is_json) {
  const device::DeviceStore store = LoadStoreOrWarn();
  const std::vector<device::FoundDevice> found = device::ListDevices();
  if (is_json) {
    nlohmann::ordered_json json = {{"devices", nlohmann::ordered_json::array()},
                                   {"kinds", nlohmann::ordered_json::array()}};
    for (const device::FoundDevice& one : found)
      json["devices"].push_back({{"device", one.spec}, {"description", one.description}});
    for (const device::DeviceKind& kind : device::DeviceKinds())
      json["kinds"].push_back({{"name", kind.name}, {"address", kind.address}, {"description", kind.text}});
    json["buttons"] = ButtonsJson(store);
    json["settings"] = device::FindDeviceStore().string();
    PrintJson(json);
    return;
  }
  Say("Found:\n");
  for (const device::FoundDevice& one : found)
    host::PrintLine("  " + one.spec + "   " + host::TranslateComposed(one.description));
  if (found.empty()) Say("  nothing but mouse and keyboard\n");
  Say("\nKinds of device (write KIND:ADDRESS):\n");
  std::vector<std::vector<std::string>> rows;
  for (const device::DeviceKind& kind : device::DeviceKinds())
    rows.push_back({"  " + std::string(kind.name), Translate(kind.address), Translate(kind.text)});
  PrintLines(host::FormatTable(rows));
  PrintButtons(store);
  Say("\nHaptic devices (--haptics): {1}\n", device::ListForceDrivers());
  Say("Settings and calibrations: {1}\n", device::FindDeviceStore());
}

base::Result<std::unique_ptr<device::Driver>> OpenDevice(const std::string& spec) {
  return device::MakeDriver(spec, LoadStoreOrWarn(), device::SystemClock());
}

void PrintReport(const WatchReport& report) {
  std::vector<std::vector<std::string>> rows = {{"hand", "samples", "a second", "out of sight"}};
  for (std::size_t i = 0; i < report.fresh.size(); ++i) {
    rows.push_back({Translate(kChannels[i]), std::to_string(report.fresh[i]),
                    host::ShownNumber(report.seconds > 0 ? report.fresh[i] / report.seconds : 0, 3),
                    std::to_string(report.unseen[i])});
  }
  PrintLines("\n" + host::FormatShownTable(rows));
  if (!report.received.empty()) Say("Received: {1}\n", report.received);
  PrintHeldBack(report);
}

/// The same for programs.
void PrintReportJson(const std::string& spec, const WatchReport& report) {
  nlohmann::ordered_json json = {{"device", spec}, {"seconds", report.seconds}, {"is_lost", report.is_lost}};
  for (std::size_t i = 0; i < report.fresh.size(); ++i)
    json["hands"][kChannels[i]] = {{"samples", report.fresh[i]}, {"times_out_of_sight", report.unseen[i]}};
  json["received"] = report.received;
  json["not_used"] = report.held_back;
  PrintJson(json);
}

base::Status LostError(const device::Driver& driver) {
  return base::Error{base::ErrorCode::kDeviceLost, driver.GetName() + " was lost; check plug and power"};
}

base::Status Test(const std::string& spec, double seconds, bool is_json = false) {
  const auto driver = OpenDevice(spec);
  if (!driver) return driver.error();
  HandPlot plot;
  const auto report = WatchDevice(
      **driver, seconds, [](const HandSamples&, double) {},
      [&](const HandSamples& samples, double time) {
        if (!is_json) plot.Show(samples, time);
      });
  if (!report) return report.error();
  is_json ? PrintReportJson(spec, *report) : PrintReport(*report);
  return report->is_lost ? LostError(**driver) : base::Status{};
}

/// What came in before a loss or Ctrl+C is kept.
base::Status Record(const std::string& spec, const std::string& path, double seconds) {
  const auto driver = OpenDevice(spec);
  if (!driver) return driver.error();
  std::vector<device::HandFrame> frames;
  HandPlot plot;
  const auto report = WatchDevice(
      **driver, seconds,
      [&](const HandSamples& samples, double time) {
        frames.push_back({time, samples});
      },
      [&](const HandSamples& samples, double time) { plot.Show(samples, time); });
  if (!report) return report.error();
  if (frames.empty()) {
    PrintHeldBack(*report);
    return base::Error{base::ErrorCode::kDeviceStale, (*driver)->GetName() +
                                                          " sent nothing to record; try trocar devices "
                                                          "test first"};
  }
  if (base::Status written = host::WriteFile(path, device::FormatHandFrames(frames)); !written)
    return written;
  PrintReport(*report);
  Say("\nWrote {1}: {2} frames. Play it with: trocar devices play {1}, or --device play:{1}\n", path,
      frames.size());
  return report->is_lost ? LostError(**driver) : base::Status{};
}

base::Status PlayDevice(const std::string& path, double seconds) {
  device::HandPlayer player(path, device::SystemClock());
  // once for its length; a file that is no recording is refused here
  if (base::Status good = player.Configure(); !good) return good;
  const double length = player.Duration();
  player.Finalize();
  return Test("play:" + path, seconds > 0 ? seconds : length + 0.1);
}

struct DeviceOptions {
  std::string spec, file;
  double seconds = 0;
  bool is_json = false;
};

CLI::App* AddWatching(CLI::App& devices, const char* name, const char* text, DeviceOptions& options) {
  CLI::App* command = devices.add_subcommand(name, text);
  command->add_option("--seconds", options.seconds, "How long; until Ctrl+C (play: to its end) if not given")
      ->check(CLI::Range(0.05, 86400.0))
      ->type_name("S");
  return command;
}

}  // namespace

device::DeviceStore LoadStoreOrWarn() {
  device::LoadedStore loaded = device::LoadDeviceStore(device::FindDeviceStore());
  if (loaded.complaint) {
    host::Log(host::LogLevel::kWarning,
              loaded.complaint->Text() + "; going on with the defaults, uncalibrated");
  }
  return std::move(loaded.store);
}

void AddDevicesCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* devices = AddListed(app, "devices");
  devices->require_subcommand(1);
  devices->footer(
      "Examples:\n"
      "  trocar devices list\n"
      "  trocar devices test liberty:/dev/ttyUSB0+jaw:/dev/ttyACM0\n"
      "  trocar devices emulate liberty          a tracker in software; prints the line it is on\n"
      "  trocar window --device liberty:/dev/ttyUSB0\n"
      "Setting up each device: docs/devices.md");

  auto options = std::make_shared<DeviceOptions>();
  CLI::App* list = devices->add_subcommand("list", "What is plugged in, and which kinds of device there are");
  AddJsonFlag(*list, options->is_json);
  list->callback([options] { ListDevices(options->is_json); });

  CLI::App* test = AddWatching(*devices, "test", "Show what a device says, live", *options);
  test->add_option("device", options->spec, kSpecHelp)->required()->type_name("DEVICE");
  AddJsonFlag(*test, options->is_json, "Machine-readable, at the end, without what it shows live");
  test->callback(
      [options, &outcome] { outcome.status = Test(options->spec, options->seconds, options->is_json); });

  CLI::App* record = AddWatching(*devices, "record", "Keep what a device says in a file (CSV)", *options);
  record->add_option("device", options->spec, kSpecHelp)->required()->type_name("DEVICE");
  record->add_option("file", options->file, "File to write")->required()->type_name("FILE");
  record->callback(
      [options, &outcome] { outcome.status = Record(options->spec, options->file, options->seconds); });

  CLI::App* play = AddWatching(*devices, "play", "Show a recording", *options);
  play->add_option("file", options->file, "File of trocar devices record")->required()->type_name("FILE");
  play->callback([options, &outcome] { outcome.status = PlayDevice(options->file, options->seconds); });

  AddDevicesCalibrateCommand(*devices, outcome);
  AddDevicesEmulateCommand(*devices, outcome);
}

}  // namespace trocar::cli
