// SPDX-License-Identifier: Apache-2.0
#include "haply_messages.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"

namespace trocar::device::haply {
namespace {

using math::Vec3;
using nlohmann::json;

/// The service: x right, y away from the person, z up. Ours: x right, y up, z towards the person.
Vec3 FromService(const Vec3& v) {
  return {v.x, v.z, -v.y};
}
Vec3 ToService(const Vec3& v) {
  return {v.x, -v.z, v.y};
}

/// \return null where the text is no JSON, or more than the service ever sends
json Parse(std::string_view text) {
  auto root = host::ParseJson<json>(text, "", host::kSmallJson);
  return root.ok() ? std::move(*root) : json();
}

/// A member of an object, or null.
const json* Find(const json* object, const char* key) {
  if (object == nullptr || !object->is_object()) return nullptr;
  const auto found = object->find(key);
  return found == object->end() ? nullptr : &*found;
}

/// Any number, finite or not: what is believed is for the guard to say.
bool ReadNumber(const json* object, const char* key, double& value) {
  const json* const number = Find(object, key);
  if (number == nullptr || !number->is_number()) return false;
  value = number->get<double>();
  return true;
}

bool ReadVector(const json* object, Vec3& v) {
  return ReadNumber(object, "x", v.x) && ReadNumber(object, "y", v.y) && ReadNumber(object, "z", v.z);
}

json WriteVector(const Vec3& v) {
  return {{"x", v.x}, {"y", v.y}, {"z", v.z}};
}

std::string ReadId(const json& device) {
  const json* const id = Find(&device, "device_id");
  return id != nullptr && id->is_string() ? id->get<std::string>() : std::string();
}

void ReadGrip(const json& grip, State& state) {
  const json* const orientation = Find(Find(&grip, "state"), "orientation");
  math::Quaternion q;
  // a grip without a readable orientation has none, which is not the identity
  state.grip = {0, 0, 0, 0};
  if (ReadNumber(orientation, "w", q.w) && ReadNumber(orientation, "x", q.x) &&
      ReadNumber(orientation, "y", q.y) && ReadNumber(orientation, "z", q.z)) {
    const Vec3 axis = FromService({q.x, q.y, q.z});
    state.grip = {q.w, axis.x, axis.y, axis.z};
  }
  const json* const buttons = Find(Find(&grip, "state"), "buttons");
  const char* const names[] = {"a", "b", "c"};
  for (std::uint32_t i = 0; i < 3; ++i) {
    const json* const button = Find(buttons, names[i]);
    if (button != nullptr && button->is_boolean() && button->get<bool>()) state.buttons |= 1u << i;
  }
}

}  // namespace

bool ParseState(std::string_view text, State& state) {
  const json root = Parse(text);
  const json* const devices = Find(&root, "inverse3");
  if (devices == nullptr || !devices->is_array()) return false;
  state = {};
  for (const json& device : *devices) {
    if (state.devices.size() == kMaxDevices) break;
    DeviceState one;
    one.id = ReadId(device);
    if (one.id.empty() || !ReadVector(Find(Find(&device, "state"), "cursor_position"), one.position))
      return false;
    one.position = FromService(one.position);
    state.devices.push_back(one);
  }
  const json* const grips = Find(&root, "wireless_verse_grip");
  if (grips != nullptr && grips->is_array() && !grips->empty()) ReadGrip(grips->front(), state);
  return true;
}

std::string FormatState(const State& state) {
  json root = {{"inverse3", json::array()}, {"wireless_verse_grip", json::array()}};
  for (const DeviceState& device : state.devices) {
    root["inverse3"].push_back({{"device_id", device.id},
                                {"state", {{"cursor_position", WriteVector(ToService(device.position))}}}});
  }
  const Vec3 axis = ToService({state.grip.x, state.grip.y, state.grip.z});
  root["wireless_verse_grip"].push_back(
      {{"device_id", "grip"},
       {"state",
        {{"orientation", {{"w", state.grip.w}, {"x", axis.x}, {"y", axis.y}, {"z", axis.z}}},
         {"buttons",
          {{"a", (state.buttons & 1u) != 0},
           {"b", (state.buttons & 2u) != 0},
           {"c", (state.buttons & 4u) != 0}}}}}});
  return host::FormatJson(root);
}

std::string FormatForces(const std::vector<std::string>& ids, const std::array<Vec3, kMaxDevices>& forces) {
  json root = {{"inverse3", json::array()}};
  for (std::size_t i = 0; i < ids.size() && i < forces.size(); ++i) {
    root["inverse3"].push_back(
        {{"device_id", ids[i]},
         {"commands", {{"set_cursor_force", {{"values", WriteVector(ToService(forces[i]))}}}}}});
  }
  // ids come from outside and may hold any bytes
  return host::FormatJson(root);
}

bool ParseForces(std::string_view text, std::vector<std::string>& ids,
                 std::array<Vec3, kMaxDevices>& forces) {
  const json root = Parse(text);
  const json* const devices = Find(&root, "inverse3");
  if (devices == nullptr || !devices->is_array() || devices->size() > kMaxDevices) return false;
  ids.clear();
  for (const json& device : *devices) {
    Vec3 force;
    if (!ReadVector(Find(Find(Find(&device, "commands"), "set_cursor_force"), "values"), force)) return false;
    forces[ids.size()] = FromService(force);
    ids.push_back(ReadId(device));
  }
  return true;
}

}  // namespace trocar::device::haply
