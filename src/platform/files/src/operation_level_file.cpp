// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/operation_level_file.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "patched_json.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/scene/scene.h"

namespace trocar::files {
namespace {

constexpr host::NumberRange kTimeLimit{10, 36000};  // [s]

scene::OperationLevel ReadLevel(const host::JsonView& view) {
  view.AllowOnly({"key", "about", "guidance", "time_limit_s", "part_time_limit_s", "scene", "parameters"});
  scene::OperationLevel level;
  level.key = view.Text("key");
  level.about = view.Text("about");
  level.has_guidance = view.BooleanOr("guidance", true);
  level.time_limit = view.NumberOr("time_limit_s", level.time_limit, kTimeLimit);
  level.part_time_limit = view.NumberOr("part_time_limit_s", level.part_time_limit, kTimeLimit);
  // what they change is read, and complained about, where they are applied
  if (view.Has("scene")) (void)view.Object("scene");
  if (view.Has("parameters")) (void)view.Object("parameters");
  return level;
}

}  // namespace

base::Result<host::JsonDocument> ParsePatched(const std::string& text, const std::string& source,
                                              const std::string& patch) {
  if (patch.empty()) return host::JsonDocument::Parse(text, source);
  auto json = host::ParseJson<nlohmann::json>(text, source);
  if (!json.ok()) return json.error();
  const auto changes = host::ParseJson<nlohmann::json>(patch, source + ", what a level changes");
  if (!changes.ok()) return changes.error();
  json->merge_patch(*changes);
  return host::JsonDocument::Parse(json->dump(), source);
}

base::Result<host::JsonDocument> ReadPatched(const std::filesystem::path& path, const std::string& patch) {
  const auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  return ParsePatched(*text, path.string(), patch);
}

base::Result<std::vector<scene::OperationLevel>> ReadOperationLevels(const std::filesystem::path& path) {
  const auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  auto document = host::JsonDocument::Parse(*text, path.string());
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "levels"});
  if (root.Text("format") != "trocar-operation-levels")
    root.Complain("format must be \"trocar-operation-levels\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  const auto json = host::ParseJson<nlohmann::json>(*text, path.string());
  if (!json.ok()) return json.error();
  std::vector<scene::OperationLevel> levels;
  bool has_normal = false;
  for (const host::JsonView& view : root.Array("levels")) {
    scene::OperationLevel level = ReadLevel(view);
    for (const scene::OperationLevel& other : levels) {
      if (other.key == level.key) view.Complain("there are two levels \"" + level.key + "\"");
    }
    const nlohmann::json& node = (*json)["levels"][levels.size()];
    if (node.is_object() && node.contains("scene")) level.scene_patch = host::FormatJson(node["scene"]);
    if (node.is_object() && node.contains("parameters"))
      level.parameters_patch = host::FormatJson(node["parameters"]);
    if (level.key == scene::kNormalLevel) {
      has_normal = true;
      if (!level.scene_patch.empty() || !level.parameters_patch.empty())
        view.Complain("at \"normal\" an operation is as its scene says; leave scene and parameters out");
    }
    levels.push_back(std::move(level));
  }
  if (!has_normal) root.Complain("there must be a level \"normal\"");
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return levels;
}

base::Result<std::vector<scene::OperationLevel>> ListOperationLevels() {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  return ReadOperationLevels(*data / kOperationLevelsFile);
}

base::Result<scene::OperationLevel> FindOperationLevel(const std::string& key) {
  auto levels = ListOperationLevels();
  if (!levels.ok()) return levels.error();
  std::string known;
  for (scene::OperationLevel& level : *levels) {
    if (level.key == (key.empty() ? scene::kNormalLevel : key)) return std::move(level);
    known += (known.empty() ? "" : ", ") + level.key;
  }
  return base::Error{base::ErrorCode::kUnknownName,
                     "an operation has no level \"" + key + "\"; it has " + known};
}

}  // namespace trocar::files
