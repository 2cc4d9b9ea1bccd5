// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/find_scene.h"

#include <system_error>
#include <utility>

#include "scene_reader.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/procedures/find_procedure.h"

namespace trocar::files {

base::Result<scene::Scene> FindScene(const std::string& name_or_path, const TaskChoice& choice) {
  auto operation = FindOperation(name_or_path, choice.patient_folder, choice.seed, choice.level);
  if (!operation.ok()) return operation.error();
  if (*operation) return std::move(**operation);
  const auto path = FindTask(name_or_path);
  if (!path.ok()) {
    if (path.error().code != base::ErrorCode::kUnknownName) return path.error();
    return base::Error{path.error().code,
                       path.error().message + "; or the operation \"" + procedures::kUsualProcedure + "\""};
  }
  return ReadTask(*path, choice);
}

base::Result<std::filesystem::path> FindSceneFile(const std::string& name_or_path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name_or_path, ignored)) return std::filesystem::path(name_or_path);
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  const std::filesystem::path operation = *data / "scenes" / (name_or_path + ".json");
  if (std::filesystem::is_regular_file(operation, ignored)) {
    const auto document = host::JsonDocument::Read(operation);
    if (!document.ok()) return document.error();
    if (document->Root().Has("operation")) return operation;
  }
  auto path = FindTask(name_or_path);
  if (path.ok() || path.error().code != base::ErrorCode::kUnknownName) return path;
  return base::Error{path.error().code, path.error().message + "; or the operation \"cholecystectomy\""};
}

base::Result<scene::Scene> ParseScene(const std::string& text, const std::filesystem::path& source,
                                      const TaskChoice& choice) {
  const auto document = host::JsonDocument::Parse(text, source.string());
  if (!document.ok()) return document.error();
  if (document->Root().TextOr("format", "") == "trocar-task") return ParseTask(text, source, choice);
  scene::OperationLevel level;
  if (document->Root().Has("operation")) {
    auto chosen = FindOperationLevel(choice.level);
    if (!chosen.ok()) return chosen.error();
    level = std::move(*chosen);
  }
  auto scene = ParsePlainScene(text, source, choice.patient_folder, level);
  if (scene.ok()) scene->seed = choice.seed;
  return scene;
}

}  // namespace trocar::files
