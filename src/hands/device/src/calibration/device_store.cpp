// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/device_store.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/user_folder.h"

namespace trocar::device {

using math::Vec3;

namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr const char* kHandNames[kChannelCount] = {"left", "right", "laparoscope"};
constexpr double kDegree = 0.017453292519943295;
constexpr int kMostStations = 16;  // of a LIBERTY, the largest
/// Raw values of the converter.
constexpr host::NumberRange kRaw{0, kMaxJawRaw};

/// \param most  length [m]
Vec3 ReadVector(const host::JsonView& view, const char* key, double most) {
  const std::vector<double> v = view.Numbers(key, 3, {-most, most});
  const Vec3 vector{v[0], v[1], v[2]};
  if (!(math::Norm(vector) <= most)) {
    char text[120];
    std::snprintf(text, sizeof text, "%s is longer than the %g that can be; calibrate again", key, most);
    view.Complain(text);
  }
  return vector;
}

Vec3 ReadDirection(const host::JsonView& view, const char* key) {
  const Vec3 v = ReadVector(view, key, 2.0);
  if (!(math::Norm(v) > 0.5)) view.Complain(std::string(key) + " must be a direction of length 1");
  return math::Normalized(v);
}

HandCalibration ReadHand(const host::JsonView& view) {
  view.AllowOnly({"tip_m", "axis", "up", "trocar_m", "measured"});
  HandCalibration hand;
  hand.p_sensor_tip = ReadVector(view, "tip_m", kMostTipDistance);
  hand.axis_sensor = ReadDirection(view, "axis");
  hand.up_sensor = ReadDirection(view, "up");
  hand.p_source_trocar = ReadVector(view, "trocar_m", kMostTrocarDistance);
  hand.is_measured = view.BooleanOr("measured", false);
  return hand;
}

TrackerEntry ReadTracker(const host::JsonView& view) {
  view.AllowOnly({"baud", "stations", "right", "up", "hemisphere", "hands"});
  TrackerEntry entry = DefaultTracker();
  entry.baud = view.IntegerOr("baud", entry.baud, {1, 1e7});
  const std::vector<double> stations = view.Numbers("stations", kChannelCount, {0, kMostStations});
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (stations[i] != std::floor(stations[i])) view.Complain("stations are whole numbers; 0 for none");
    entry.stations[i] = static_cast<int>(stations[i]);
  }
  entry.source_right = ReadDirection(view, "right");
  entry.source_up = ReadDirection(view, "up");
  entry.hemisphere = ReadDirection(view, "hemisphere");
  const host::JsonView hands = view.Object("hands");
  hands.AllowOnly({kHandNames[0], kHandNames[1], kHandNames[2]});
  for (std::size_t i = 0; i < entry.hands.size(); ++i) {
    if (hands.Has(kHandNames[i])) entry.hands[i] = ReadHand(hands.Object(kHandNames[i]));
  }
  return entry;
}

constexpr const char* kHaptics = "haptics";

/// The loop leads the tool of a hand with force; nothing may hold it back from there.
ButtonMap WithoutClutch(ButtonMap map) {
  for (auto& hand : map) {
    for (HandAct& act : hand) {
      if (act == HandAct::kClutch || act == HandAct::kFreeze) act = HandAct::kNone;
    }
  }
  return map;
}

/// The act of that name, or kNone with a complaint.
HandAct ReadAct(const host::JsonView& view, const std::string& name) {
  if (const auto act = FindAct(name)) return *act;
  std::string known;
  for (std::size_t i = 0; i < kActCount; ++i)
    known.append(i > 0 ? ", " : "").append(ActName(static_cast<HandAct>(i)));
  view.Complain("\"" + name + "\" is no act of a button; there are " + known);
  return HandAct::kNone;
}

ButtonMap ReadButtons(const host::JsonView& view, const ButtonMap& defaults) {
  view.AllowOnly({kHandNames[0], kHandNames[1]});
  ButtonMap map = defaults;
  for (std::size_t hand = 0; hand < map.size(); ++hand) {
    if (!view.Has(kHandNames[hand])) continue;
    const std::vector<host::JsonView> names = view.Array(kHandNames[hand]);
    if (names.size() > kMostButtons)
      view.Complain("more than " + std::to_string(kMostButtons) + " buttons of a hand");
    map[hand].fill(HandAct::kNone);
    for (std::size_t i = 0; i < std::min(names.size(), kMostButtons); ++i)
      map[hand][i] = ReadAct(names[i], names[i].AsText());
  }
  return map;
}

void ReadAllButtons(const host::JsonView& root, DeviceStore& store) {
  if (root.Has("buttons")) {
    const host::JsonView buttons = root.Object("buttons");
    buttons.AllowOnly({"gamepad", "spacemouse", kHaptics, "play"});
    for (const std::string& kind : buttons.Keys()) {
      const ButtonMap map = ReadButtons(buttons.Object(kind), DeviceStore().Buttons(kind));
      if (kind == kHaptics && WithoutClutch(map) != map)
        buttons.Object(kind).Complain("a hand with force has no clutch and no freeze");
      store.buttons[kind] = map;
    }
  }
  if (root.Has("keys")) {
    const host::JsonView keys = root.Object("keys");
    for (const std::string& key : keys.Keys()) store.keys[key] = ReadAct(keys, keys.Text(key));
  }
}

DeviceStore ReadStore(const host::JsonView& root) {
  DeviceStore store;
  root.AllowOnly({"version", "trackers", "jaw", "buttons", "keys"});
  ReadAllButtons(root, store);
  if (const int version = root.Integer("version"); version != kVersion)
    root.Complain("version " + std::to_string(version) + " is not known to this program");
  if (root.Has("trackers")) {
    const host::JsonView trackers = root.Object("trackers");
    for (const std::string& kind : trackers.Keys()) store.trackers[kind] = ReadTracker(trackers.Object(kind));
  }
  if (!root.Has("jaw")) return store;
  const host::JsonView jaws = root.Object("jaw");
  jaws.AllowOnly({kHandNames[0], kHandNames[1]});
  for (std::size_t i = 0; i < store.jaws.size(); ++i) {
    if (!jaws.Has(kHandNames[i])) continue;
    const host::JsonView jaw = jaws.Object(kHandNames[i]);
    jaw.AllowOnly({"closed", "open", "max_jaw_deg"});
    store.jaws[i].closed = jaw.Integer("closed", kRaw);
    store.jaws[i].open = jaw.Integer("open", kRaw);
    store.jaws[i].max_jaw = kDegree * jaw.Number("max_jaw_deg", {1, 170});
  }
  return store;
}

nlohmann::ordered_json Numbers(const Vec3& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json WriteTracker(const TrackerEntry& entry) {
  nlohmann::ordered_json json = {{"baud", entry.baud},
                                 {"stations", entry.stations},
                                 {"right", Numbers(entry.source_right)},
                                 {"up", Numbers(entry.source_up)},
                                 {"hemisphere", Numbers(entry.hemisphere)}};
  for (std::size_t i = 0; i < entry.hands.size(); ++i) {
    const HandCalibration& hand = entry.hands[i];
    json["hands"][kHandNames[i]] = {{"tip_m", Numbers(hand.p_sensor_tip)},
                                    {"axis", Numbers(hand.axis_sensor)},
                                    {"up", Numbers(hand.up_sensor)},
                                    {"trocar_m", Numbers(hand.p_source_trocar)},
                                    {"measured", hand.is_measured}};
  }
  return json;
}

/// The acts up to the last that is none.
nlohmann::ordered_json WriteActs(std::span<const HandAct> acts) {
  while (!acts.empty() && acts.back() == HandAct::kNone) acts = acts.first(acts.size() - 1);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HandAct act : acts) json.push_back(ActName(act));
  return json;
}

std::string FormatStore(const DeviceStore& store) {
  nlohmann::ordered_json json = {{"version", kVersion}};
  for (const auto& [kind, map] : store.buttons) {
    for (std::size_t hand = 0; hand < map.size(); ++hand)
      json["buttons"][kind][kHandNames[hand]] = WriteActs(map[hand]);
  }
  for (const auto& [key, act] : store.keys) json["keys"][key] = ActName(act);
  for (const auto& [kind, entry] : store.trackers) json["trackers"][kind] = WriteTracker(entry);
  for (std::size_t i = 0; i < store.jaws.size(); ++i) {
    const JawCalibration& jaw = store.jaws[i];
    json["jaw"][kHandNames[i]] = {
        {"closed", jaw.closed}, {"open", jaw.open}, {"max_jaw_deg", jaw.max_jaw / kDegree}};
  }
  return host::FormatJson(json, 2) + "\n";
}

}  // namespace

TrackerEntry DefaultTracker() {
  TrackerEntry entry;
  entry.hands[kLeftHand].p_source_trocar = {0.40, -0.06, 0};
  entry.hands[kRightHand].p_source_trocar = {0.40, 0.06, 0};
  entry.hands[kLaparoscope].p_source_trocar = {0.36, 0, 0};
  return entry;
}

base::Result<TrackedHandsSettings> MakeHandsSettings(const TrackerEntry& entry) {
  const base::Result<math::Quaternion> rotation = FindSourceRotation(entry.source_right, entry.source_up);
  if (!rotation) return rotation.error();
  TrackedHandsSettings settings;
  settings.calibrations = entry.hands;
  settings.R_world_source = *rotation;
  settings.hemisphere = entry.hemisphere;
  return settings;
}

TrackerEntry DeviceStore::Tracker(const std::string& kind) const {
  const auto found = trackers.find(kind);
  return found == trackers.end() ? DefaultTracker() : found->second;
}

ButtonMap DeviceStore::Buttons(const std::string& kind) const {
  const auto found = buttons.find(kind);
  if (found != buttons.end()) return found->second;
  return kind == kHaptics ? WithoutClutch(DefaultButtons()) : DefaultButtons();
}

fs::path FindDeviceStore() {
  return host::FindConfigFolder() / "devices.json";
}

LoadedStore LoadDeviceStore(const fs::path& path) {
  LoadedStore loaded;
  const base::Result<host::JsonDocument> document = host::JsonDocument::Read(path);
  if (!document) {
    if (document.error().code != base::ErrorCode::kFileMissing) loaded.complaint = document.error();
    return loaded;
  }
  DeviceStore store = ReadStore(document->Root());
  const base::Status good = document->Check();
  if (good) {
    loaded.store = std::move(store);
  } else {
    loaded.complaint = good.error();
  }
  return loaded;
}

base::Status SaveDeviceStore(const fs::path& path, const DeviceStore& store) {
  if (LoadDeviceStore(path).complaint) {
    std::error_code failure;
    fs::rename(path, path.string() + ".bad", failure);
    if (failure) {
      return base::Error{base::ErrorCode::kFileUnwritable,
                         path.string() + " is damaged and cannot be set aside: " + failure.message()};
    }
  }
  return host::WriteFile(path, FormatStore(store));
}

}  // namespace trocar::device
