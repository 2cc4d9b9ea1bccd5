// SPDX-License-Identifier: Apache-2.0
#include "script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "field_ranges.h"
#include "scene_objects.h"
#include "trocar/core/json.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::scene {
namespace {

/// Sines that make up the tremor of one axis.
constexpr int kTremorSines = 3;
constexpr const char* kHandNames[kHandCount] = {"left", "right"};

/// Smooth tremor of both tips at a time [m].
std::array<Vec3, kHandCount> CalcTremor(double amplitude, std::uint64_t seed, double time) {
  math::Random random(seed);
  std::array<Vec3, kHandCount> offsets;
  for (Vec3& offset : offsets) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int sine = 0; sine < kTremorSines; ++sine) {
        const double frequency = random.Uniform(8.0, 12.0), phase = random.Uniform(0.0, 2.0 * M_PI);
        offset[axis] += amplitude / kTremorSines * math::Sin(2.0 * M_PI * frequency * time + phase);
      }
    }
  }
  return offsets;
}

}  // namespace

core::Result<Script> ReadScript(const std::filesystem::path& path, const anatomy::Patient& patient) {
  auto document = core::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const core::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "tremor_mm", "keys"});
  if (root.Text("format") != "trocar-script") root.Complain("format must be \"trocar-script\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");

  Script script;
  script.tremor = 0.001 * root.NumberOr("tremor_mm", 0.0, range::kTremorMm);
  for (const core::JsonView& view : root.Array("keys")) {
    view.AllowOnly({"time_s", "about", "left", "right"});
    const bool is_first = script.keys.empty();
    ScriptKey key = is_first ? ScriptKey{} : script.keys.back();
    key.time = view.Number("time_s", range::kTimeS);
    if (!is_first && key.time <= script.keys.back().time) {
      view.Complain("time_s must rise from key to key", core::ErrorCode::kScriptInvalid);
    }
    for (int hand = 0; hand < kHandCount; ++hand) {
      if (!view.Has(kHandNames[hand])) {
        if (is_first) view.Complain("the first key must place both hands", core::ErrorCode::kScriptInvalid);
        continue;
      }
      const core::JsonView pose = view.Object(kHandNames[hand]);
      pose.AllowOnly({"at", "offset_mm", "spin_deg", "jaw_deg"});
      const std::string name = pose.Text("at");
      const anatomy::Landmark* landmark = patient.FindLandmark(name);
      if (landmark == nullptr) {
        std::string known;
        for (const auto& one : patient.landmarks) known += (known.empty() ? "" : ", ") + one.name;
        pose.Complain("there is no landmark \"" + name + "\"; the patient has " + known,
                      core::ErrorCode::kUnknownName);
        continue;
      }
      const Vec3 offset = pose.Has("offset_mm") ? ReadPointMm(pose, "offset_mm", range::kOffsetMm) : Vec3{};
      key.p_world_tip[hand] = landmark->position + offset;
      key.spin[hand] =
          pose.NumberOr("spin_deg", key.spin[hand] / math::kDegree, range::kTurnDeg) * math::kDegree;
      key.jaw[hand] = pose.NumberOr("jaw_deg", key.jaw[hand] / math::kDegree, range::kJawDeg) * math::kDegree;
    }
    script.keys.push_back(key);
  }
  if (script.keys.empty()) root.Complain("a script needs at least one key", core::ErrorCode::kScriptInvalid);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return script;
}

Input CalcScriptInput(const Scene& scene, double time) {
  Input input;
  for (int hand = 0; hand < kHandCount; ++hand) input.hands[hand] = scene.instruments[hand].home;
  input.laparoscope = scene.laparoscope.home;
  input.settings = scene.settings;
  const auto& keys = scene.script.keys;
  if (keys.empty()) return input;

  const auto next = std::upper_bound(keys.begin(), keys.end(), time,
                                     [](double t, const ScriptKey& key) { return t < key.time; });
  const ScriptKey& to = next == keys.end() ? keys.back() : *next;
  const ScriptKey& from = next == keys.begin() ? keys.front() : *(next - 1);
  const double span = to.time - from.time;
  const double t = span > 0.0 ? std::clamp((time - from.time) / span, 0.0, 1.0) : 1.0;
  // minimum jerk (Flash and Hogan 1985): starts and ends at rest
  const double s = t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
  const auto tremor = CalcTremor(scene.script.tremor, scene.seed, time);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto blend = [&](double a, double b) { return a + s * (b - a); };
    input.hands[hand] =
        instrument::FindJoints(scene.instruments[hand].p_world_port,
                               math::Lerp(from.p_world_tip[hand], to.p_world_tip[hand], s) + tremor[hand],
                               blend(from.spin[hand], to.spin[hand]), blend(from.jaw[hand], to.jaw[hand]));
  }
  return input;
}

}  // namespace trocar::scene
