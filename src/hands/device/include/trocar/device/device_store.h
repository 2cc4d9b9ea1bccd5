// SPDX-License-Identifier: Apache-2.0
/// \file device_store.h  Settings and calibrations of devices in the person's own folder.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/device/hand_buttons.h"
#include "trocar/device/jaw_sensor.h"
#include "trocar/device/tracked_hands.h"

namespace trocar::device {

/// One kind of tracker.
struct TrackerEntry {
  int baud = 115200;                                 ///< of its serial line [bit/s]
  std::array<int, kChannelCount> stations{1, 2, 0};  ///< of left, right, laparoscope; 0 for none
  math::Vec3 source_right{0, 1, 0};  ///< the person's right, source frame; see FindSourceRotation()
  math::Vec3 source_up{0, 0, -1};    ///< up, source frame
  math::Vec3 hemisphere{1, 0, 0};    ///< from the source to the hands, source frame
  std::array<HandCalibration, kChannelCount> hands;

  friend bool operator==(const TrackerEntry&, const TrackerEntry&) = default;
};
/// Polhemus axes (x away from the person, y right, z down), trocars 120 mm apart.
TrackerEntry DefaultTracker();
/// \return kDeviceSettings where the source's directions make no frame
base::Result<TrackedHandsSettings> MakeHandsSettings(const TrackerEntry& entry);

struct DeviceStore {
  std::map<std::string, TrackerEntry> trackers;  ///< by kind: "liberty"
  std::array<JawCalibration, kJawTools> jaws;
  std::map<std::string, ButtonMap> buttons;  ///< by kind: "gamepad", "spacemouse", "haptics", "play"
  /// Keys of a keyboard, or of a foot pedal that is one, by the name that the window system gives them: "F13", "b".
  std::map<std::string, HandAct> keys;

  /// The entry of that kind, or the defaults.
  TrackerEntry Tracker(const std::string& kind) const;
  /// Acts of the buttons of that kind, or the defaults; "haptics" without clutch and freeze.
  ButtonMap Buttons(const std::string& kind) const;
  friend bool operator==(const DeviceStore&, const DeviceStore&) = default;
};

/// TROCAR_CONFIG_DIR, else XDG_CONFIG_HOME/trocar, else HOME/.config/trocar; there "devices.json".
std::filesystem::path FindDeviceStore();

struct LoadedStore {
  DeviceStore store;                     ///< the defaults where the file is missing or bad
  std::optional<base::Error> complaint;  ///< what is wrong with the file; none where there is no file
};
LoadedStore LoadDeviceStore(const std::filesystem::path& path);
/// Keeps a file that cannot be read as "devices.json.bad" before a new one takes its place.
/// \return kFileUnwritable
base::Status SaveDeviceStore(const std::filesystem::path& path, const DeviceStore& store);

}  // namespace trocar::device
