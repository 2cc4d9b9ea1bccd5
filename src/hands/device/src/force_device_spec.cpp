// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/force_device_spec.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "trocar/device/companion.h"
#include "trocar/device/haply.h"
#include "trocar/device/open_haptics.h"
#include "trocar/device/simulated_force_device.h"
#include "trocar/device/tcp_port.h"

namespace trocar::device {
namespace {

/// The part before the first `mark`; takes it and the mark away from the front of `text`.
std::string_view TakePart(std::string_view& text, char mark) {
  const std::string_view part = text.substr(0, text.find(mark));
  text.remove_prefix(std::min(part.size() + 1, text.size()));
  return part;
}

/// \param is_held  somebody answers the check pose, one hand after the other, and then holds the safety switches
std::unique_ptr<ForceDriver> MakeSimulated(bool is_held) {
  constexpr double kAnswered = 3.0;  // from then on the hands move [s]
  SimulatedForceSettings settings;
  settings.channel_count = 2;
  settings.path = [is_held](int channel, double time) {
    const double moved = is_held ? std::max(0.0, time - kAnswered) : time;
    const double side = channel == 0 ? -1.0 : 1.0;
    return math::Vec3{0.010 * side * std::sin(0.9 * moved), 0.006 * std::sin(0.7 * moved),
                      -0.015 * (1.0 - std::cos(0.5 * moved))};
  };
  if (is_held) {
    settings.buttons = [](int channel, double time) -> std::uint32_t {
      const double begin = channel == 0 ? 0.8 : 1.8;
      return time > kAnswered || (time > begin && time < begin + 0.8) ? 1u : 0u;
    };
  }
  return std::make_unique<SimulatedForceDevice>(settings);
}

/// "Left,Right": the names that the maker's program gave to the devices.
std::unique_ptr<ForceDriver> MakeOpenHaptics(std::string_view names) {
  OpenHapticsSettings settings;
  settings.host = Companion::Find("trocar-supervisor");
  if (!names.empty()) settings.names.clear();
  while (!names.empty()) settings.names.emplace_back(TakePart(names, ','));
  return std::make_unique<OpenHaptics>(settings);
}

/// "2:10001": how many devices, and the port of the service.
base::Result<std::unique_ptr<ForceDriver>> MakeHaply(std::string_view text) {
  HaplySettings settings;
  int port = kHaplyPort;
  for (int* const number : {&settings.devices, &port}) {
    if (text.empty()) break;
    const std::string_view part = TakePart(text, ':');
    const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), *number);
    if (failure != std::errc() || end != part.data() + part.size() || *number < 1 || *number > 65535)
      return base::Error{base::ErrorCode::kDeviceSettings, "haply takes two numbers: haply:2:10001"};
  }
  return std::unique_ptr<ForceDriver>(
      std::make_unique<Haply>(settings, [port] { return ConnectTcp("localhost", port); }));
}

}  // namespace

std::string FindOpenHaptics() {
  const std::string name = OpenHapticsSettings{}.hd_file;
  const char* const named = std::getenv("LD_LIBRARY_PATH");
  std::string folders = named != nullptr ? std::string(named) + ":" : std::string();
  folders += "/usr/local/lib:/usr/lib/x86_64-linux-gnu:/lib/x86_64-linux-gnu:/usr/lib64:/usr/lib:/lib";
  for (std::string_view rest = folders; !rest.empty();) {
    const std::filesystem::path file = std::filesystem::path(TakePart(rest, ':')) / name;
    std::error_code ignored;
    if (file.has_parent_path() && std::filesystem::exists(file, ignored)) return file.string();
  }
  return {};
}

std::string ListForceDrivers() {
  return "simulated[:held], openhaptics[:NAME[,NAME]], haply[:COUNT[:PORT]]";
}

base::Result<std::unique_ptr<ForceDriver>> MakeForceDriver(std::string_view text) {
  if (text == "simulated" || text == "simulated:held") return MakeSimulated(text != "simulated");
  std::string_view rest = text;
  const std::string_view kind = TakePart(rest, ':');
  if (kind == "openhaptics") return MakeOpenHaptics(rest);
  if (kind == "haply") return MakeHaply(rest);
  return base::Error{
      base::ErrorCode::kDeviceSettings,
      "there is no haptic device of the kind \"" + std::string(text) + "\"; there are " + ListForceDrivers()};
}

}  // namespace trocar::device
