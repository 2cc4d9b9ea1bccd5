// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/scene_choice.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/assessment/play_state.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/threads.h"

namespace trocar::presenter {
namespace {

constexpr const char* kDefaultScene = "demonstration.json";

int ThreadsOf(const Options& options) {
  return options.threads > 0 ? options.threads : ChooseThreads(std::thread::hardware_concurrency());
}

}  // namespace

base::Result<scene::Scene> ReadChosenScene(const Options& options) {
  if (options.task.empty()) {
    if (!options.scene.empty()) return files::ReadScene(options.scene);
    const auto data = host::FindDataFolder();
    if (!data) return data.error();
    return files::ReadScene(*data / "scenes" / kDefaultScene);
  }
  auto operation = files::FindOperation(options.task, options.operation.patient, options.seed, options.level);
  if (!operation) return operation.error();
  if (operation->has_value()) return std::move(**operation);
  // the chosen patient is an operation's, and no task's
  return files::FindScene(options.task, {options.level, options.seed, {}});
}

base::Result<simulation::Simulation> MakeChosenSimulation(const Options& options) {
  auto scene = ReadChosenScene(options);
  if (!scene) return scene.error();
  return simulation::Simulation::Make(
      std::make_shared<const scene::Scene>(std::move(scene).value()),
      {.threads = host::UseThreads(ThreadsOf(options)), .now = host::NowNanoseconds});
}

base::Result<LoadedScene> MakeChosenScene(const Options& options, const PartProgress& progress) {
  if (options.operation.part.empty()) {
    auto made = MakeChosenSimulation(options);
    if (!made) return made.error();
    return LoadedScene{std::move(*made), std::nullopt};
  }
  if (options.task != kOperationTask) {
    return base::Error{base::ErrorCode::kUnknownName,
                       "\"" + options.task + "\" has no parts; " + kOperationTask + " has"};
  }
  auto start = PreparePart(options, progress);
  if (!start) return start.error();
  auto made = MakeStartedSimulation(options, *start);
  if (!made) return made.error();
  return LoadedScene{std::move(*made), std::move(*start)};
}

base::Result<simulation::Simulation> MakeStartedSimulation(const Options& options,
                                                           const centre::Start& start) {
  auto made = record::MakeScene(start.description);
  if (!made) return made.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(made).value());
  auto simulation = simulation::Simulation::Make(
      scene, {.threads = host::UseThreads(ThreadsOf(options)), .now = host::NowNanoseconds});
  if (!simulation || start.state.empty()) return simulation;
  // the state's file also holds what the surgeon remembers who came so far: it is read and left
  const std::string name = start.state_surgeon.substr(0, start.state_surgeon.find(','));
  auto surgeon = agent::MakeSurgeon(name, scene, 1);
  if (!surgeon) return surgeon.error();
  if (const auto restored = assessment::RestorePlay(start.state, start.state_surgeon, *simulation, **surgeon);
      !restored)
    return restored.error();
  return simulation;
}

record::Description DescribeChosenScene(const Options& options, const scene::Scene& scene) {
  using Kind = record::Description::Kind;
  record::Description description;
  description.kind = options.task.empty() ? Kind::kScene : scene.task ? Kind::kTask : Kind::kOperation;
  description.name = options.task;
  if (description.kind == Kind::kOperation) {
    description.level = KeepLevel(options.level);
    if (!options.operation.patient.empty())
      description.patient = std::filesystem::absolute(options.operation.patient).string();
  }
  if (description.kind == Kind::kTask) description.level = options.level;
  if (description.kind == Kind::kScene) {
    const auto data = host::FindDataFolder();
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

}  // namespace trocar::presenter
