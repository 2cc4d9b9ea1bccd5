// SPDX-License-Identifier: Apache-2.0
#include "script.h"

#include <array>
#include <cmath>
#include <string>

#include "field_ranges.h"
#include "scene_objects.h"
#include "trocar/host/json.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::files {
namespace {

constexpr const char* kHandNames[instrument::kHandCount] = {"left", "right"};

}  // namespace

base::Result<scene::Script> ReadScript(const std::filesystem::path& path, const patient::Patient& patient) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "tremor_mm", "keys"});
  if (root.Text("format") != "trocar-script") root.Complain("format must be \"trocar-script\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");

  scene::Script script;
  script.tremor = 0.001 * root.NumberOr("tremor_mm", 0.0, range::kTremorMm);
  for (const host::JsonView& view : root.Array("keys")) {
    view.AllowOnly({"time_s", "about", "left", "right"});
    const bool is_first = script.keys.empty();
    scene::ScriptKey key = is_first ? scene::ScriptKey{} : script.keys.back();
    key.time = view.Number("time_s", range::kTimeS);
    if (!is_first && key.time <= script.keys.back().time) {
      view.Complain("time_s must rise from key to key", base::ErrorCode::kScriptInvalid);
    }
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      if (!view.Has(kHandNames[hand])) {
        if (is_first) view.Complain("the first key must place both hands", base::ErrorCode::kScriptInvalid);
        continue;
      }
      const host::JsonView pose = view.Object(kHandNames[hand]);
      pose.AllowOnly({"at", "offset_mm", "spin_deg", "jaw_deg"});
      const std::string name = pose.Text("at");
      const patient::Landmark* landmark = patient.FindLandmark(name);
      if (landmark == nullptr) {
        std::string known;
        for (const auto& one : patient.landmarks) known += (known.empty() ? "" : ", ") + one.name;
        pose.Complain("there is no landmark \"" + name + "\"; the patient has " + known,
                      base::ErrorCode::kUnknownName);
        continue;
      }
      const math::Vec3 offset =
          pose.Has("offset_mm") ? ReadPointMm(pose, "offset_mm", range::kOffsetMm) : math::Vec3{};
      key.p_world_tip[hand] = landmark->position + offset;
      key.spin[hand] =
          pose.NumberOr("spin_deg", key.spin[hand] / math::kDegree, range::kTurnDeg) * math::kDegree;
      key.jaw[hand] = pose.NumberOr("jaw_deg", key.jaw[hand] / math::kDegree, range::kJawDeg) * math::kDegree;
    }
    script.keys.push_back(key);
  }
  if (script.keys.empty()) root.Complain("a script needs at least one key", base::ErrorCode::kScriptInvalid);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return script;
}

}  // namespace trocar::files
