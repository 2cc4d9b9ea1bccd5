// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/scene_choice.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "trocar/core/json.h"

namespace trocar::app {
namespace {

constexpr const char* kDefaultScene = "demonstration.json";

/// The scene file of that name, or nothing where there is none with an operation.
core::Result<std::optional<std::filesystem::path>> FindOperationFile(const std::string& name) {
  const auto data = scene::FindDataFolder();
  if (!data) return data.error();
  for (const std::filesystem::path& path :
       {std::filesystem::path(name), *data / "scenes" / (name + ".json")}) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) continue;
    const auto document = core::JsonDocument::Read(path);
    if (!document) return document.error();
    if (document->Root().Has("operation")) return std::optional(path);
  }
  return std::optional<std::filesystem::path>();
}

}  // namespace

core::Result<scene::Scene> ReadChosenScene(const Options& options) {
  if (options.task.empty()) {
    if (!options.scene.empty()) return scene::ReadScene(options.scene);
    const auto data = scene::FindDataFolder();
    if (!data) return data.error();
    return scene::ReadScene(*data / "scenes" / kDefaultScene);
  }
  const auto operation = FindOperationFile(options.task);
  if (!operation) return operation.error();
  if (operation->has_value()) {
    auto scene = scene::ReadScene(**operation);
    if (scene.ok()) scene->seed = options.seed;
    return scene;
  }
  const auto task = scene::FindTask(options.task);
  if (!task) {
    if (task.error().code != core::ErrorCode::kUnknownName) return task.error();
    return core::Error{task.error().code, task.error().message + "; or the operation \"cholecystectomy\""};
  }
  return scene::ReadTask(*task, {options.level, options.seed, {}});
}

core::Result<simulation::Simulation> MakeChosenSimulation(const Options& options) {
  auto scene = ReadChosenScene(options);
  if (!scene) return scene.error();
  const int threads =
      options.threads > 0 ? options.threads : ChooseThreads(std::thread::hardware_concurrency());
  return simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(scene).value()),
                                      threads);
}

}  // namespace trocar::app
