// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/scene_choice.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace trocar::app {
namespace {

constexpr const char* kDefaultScene = "demonstration.json";

}  // namespace

core::Result<scene::Scene> ReadChosenScene(const Options& options) {
  if (options.task.empty()) {
    if (!options.scene.empty()) return scene::ReadScene(options.scene);
    const auto data = scene::FindDataFolder();
    if (!data) return data.error();
    return scene::ReadScene(*data / "scenes" / kDefaultScene);
  }
  auto operation = scene::FindOperation(options.task, {}, options.seed);
  if (!operation) return operation.error();
  if (operation->has_value()) return std::move(**operation);
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

record::Description DescribeChosenScene(const Options& options, const scene::Scene& scene) {
  using Kind = record::Description::Kind;
  record::Description description;
  description.kind = options.task.empty() ? Kind::kScene : scene.task ? Kind::kTask : Kind::kOperation;
  description.name = options.task;
  if (description.kind == Kind::kTask) description.level = options.level;
  if (description.kind == Kind::kScene) {
    const auto data = scene::FindDataFolder();
    const auto built_in = data.ok() ? *data / "scenes" / kDefaultScene : std::filesystem::path(kDefaultScene);
    description.name = std::filesystem::absolute(options.scene.empty() ? built_in : options.scene).string();
  }
  description.seed = scene.seed;
  description.player = DescribeHands(options);
  return description;
}

std::string DescribeHands(const Options& options) {
  std::string hands = options.device.empty() ? "mouse and keyboard" : options.device;
  if (!options.haptics.empty()) hands += ", " + options.haptics;
  return hands;
}

}  // namespace trocar::app
