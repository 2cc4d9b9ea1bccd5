// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/window_settings.h"

#include <nlohmann/json.hpp>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/user_folder.h"
#include "trocar/presenter/tutorial.h"

namespace trocar::presenter {
namespace {

constexpr const char* kFormat = "trocar-window-settings";
constexpr int kVersion = 1;
constexpr double kMostSeed = 2147483647;

std::map<std::string, std::string> ReadTexts(const host::JsonView& root, const char* key) {
  std::map<std::string, std::string> texts;
  if (!root.Has(key)) return texts;
  const host::JsonView view = root.Object(key);
  for (const std::string& name : view.Keys()) texts[name] = view.Text(name);
  return texts;
}

WindowSettings ReadSettings(const host::JsonView& root) {
  root.AllowOnly({"format", "version", "left_handed", "real_trocar", "guides", "panel", "depth_snap",
                  "person", "patient", "keys", "buttons", "last", "tutorial_step"});
  if (root.Text("format") != kFormat) root.Complain("is no file of the window's settings");
  root.Integer("version", {kVersion, kVersion});
  WindowSettings settings;
  settings.is_left_handed = root.BooleanOr("left_handed", settings.is_left_handed);
  settings.is_fulcrum_mirrored = root.BooleanOr("real_trocar", settings.is_fulcrum_mirrored);
  settings.has_guides = root.BooleanOr("guides", settings.has_guides);
  settings.has_panel = root.BooleanOr("panel", settings.has_panel);
  settings.tutorial_step = root.IntegerOr("tutorial_step", 0, {0, kTutorialSteps});
  settings.has_depth_snap = root.BooleanOr("depth_snap", settings.has_depth_snap);
  settings.person = root.TextOr("person", "");
  settings.patient = root.TextOr("patient", "");
  settings.keys = ReadTexts(root, "keys");
  settings.buttons = ReadTexts(root, "buttons");
  if (!root.Has("last")) return settings;
  const host::JsonView last = root.Object("last");
  last.AllowOnly({"task", "part", "level", "seed"});
  settings.last_task = last.Text("task");
  settings.last_part = last.TextOr("part", "");
  settings.last_level = last.TextOr("level", settings.last_level);
  settings.last_seed = static_cast<std::uint64_t>(last.IntegerOr("seed", 1, {0, kMostSeed}));
  return settings;
}

}  // namespace

std::filesystem::path FindWindowSettings() {
  return host::FindConfigFolder() / "window.json";
}

LoadedWindowSettings LoadWindowSettings(const std::filesystem::path& path) {
  LoadedWindowSettings loaded;
  const auto document = host::JsonDocument::Read(path);
  if (!document) {
    if (document.error().code != base::ErrorCode::kFileMissing) loaded.complaint = document.error();
    return loaded;
  }
  const WindowSettings settings = ReadSettings(document->Root());
  if (const base::Status good = document->Check(); !good) {
    loaded.complaint = good.error();
  } else {
    loaded.settings = settings;
  }
  return loaded;
}

base::Status SaveWindowSettings(const std::filesystem::path& path, const WindowSettings& settings) {
  nlohmann::ordered_json json = {{"format", kFormat},
                                 {"version", kVersion},
                                 {"left_handed", settings.is_left_handed},
                                 {"real_trocar", settings.is_fulcrum_mirrored},
                                 {"guides", settings.has_guides},
                                 {"panel", settings.has_panel},
                                 {"depth_snap", settings.has_depth_snap},
                                 {"tutorial_step", settings.tutorial_step}};
  if (!settings.person.empty()) json["person"] = settings.person;
  if (!settings.patient.empty()) json["patient"] = settings.patient;
  if (!settings.keys.empty()) json["keys"] = settings.keys;
  if (!settings.buttons.empty()) json["buttons"] = settings.buttons;
  if (!settings.last_task.empty()) {
    json["last"] = {
        {"task", settings.last_task}, {"level", settings.last_level}, {"seed", settings.last_seed}};
    if (!settings.last_part.empty()) json["last"]["part"] = settings.last_part;
  }
  std::error_code ignored;
  ignored = host::MakeFolders(path.parent_path());
  return host::WriteFile(path, host::FormatJson(json, 2) + "\n");
}

}  // namespace trocar::presenter
