// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

#include "action_layout.h"
#include "episode.h"
#include "reward.h"
#include "state_layout.h"
#include "trocar/base/assert.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/task_file.h"
#include "trocar/math/random.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::environment {
namespace {

base::Error Unusable(const std::string& what) {
  return base::Error{base::ErrorCode::kUsage, what};
}

base::Status CheckSettings(const EnvironmentSettings& settings) {
  if (settings.layouts < 1 || settings.layouts > 4096)
    return Unusable("an environment has 1 to 4096 layouts, not " + std::to_string(settings.layouts));
  if (!(settings.actions_per_second >= 0.5 && settings.actions_per_second <= 120))
    return Unusable("actions_per_second goes from 0.5 to 120");
  if (!(settings.most_seconds >= 0 && settings.most_seconds <= 36000))
    return Unusable("most_seconds goes from 0 (the usual time) to 36000");
  for (std::size_t i = 0; i < kFeatureCount; ++i) {
    if (!std::isfinite(settings.weights[i]))
      return Unusable("the weight of \"" + std::string(NameOf(static_cast<Feature>(i))) +
                      "\" is NaN or infinite");
  }
  return {};
}

base::Result<scene::Scene> ReadLayout(const EnvironmentSettings& settings, std::uint64_t seed) {
  const files::TaskChoice choice{settings.level, seed, settings.patient};
  if (settings.document.empty()) return files::FindScene(settings.task, choice);
  auto scene = files::ParseScene(settings.document, settings.task, choice);
  if (scene.ok() && !scene->task && !scene->operation) {
    return base::Error{
        base::ErrorCode::kSceneInvalid,
        settings.task + ": in this scene nothing is to be done; an environment is a task or an operation"};
  }
  return scene;
}

}  // namespace

// --- model

struct EnvironmentModel::Content {
  EnvironmentSettings settings;
  int ticks = 1;
  std::unique_ptr<const ActionLayout> action;
  std::unique_ptr<const StateLayout> state;
  std::mutex mutex;  // of the models
  std::vector<std::shared_ptr<const simulation::SimulationModel>> models;
};

EnvironmentModel::EnvironmentModel(std::unique_ptr<Content> content) : content_(std::move(content)) {}
EnvironmentModel::~EnvironmentModel() = default;

base::Result<std::shared_ptr<EnvironmentModel>> EnvironmentModel::Make(const EnvironmentSettings& settings) {
  if (const auto checked = CheckSettings(settings); !checked) return checked.error();
  auto content = std::make_unique<Content>();
  content->settings = settings;
  content->models.resize(static_cast<std::size_t>(settings.layouts));
  std::shared_ptr<EnvironmentModel> model(new EnvironmentModel(std::move(content)));
  const auto first = model->FindLayout(0);
  if (!first) return first.error();
  const auto simulation = simulation::Simulation::Make(*first);
  if (!simulation) return simulation.error();
  const scene::Scene& scene = simulation->GetScene();
  Content& made = *model->content_;
  if (made.settings.most_seconds == 0) made.settings.most_seconds = UsualSeconds(scene);
  made.settings.moves_camera = made.settings.moves_camera || IsAboutCamera(scene);
  made.ticks =
      std::max(1, static_cast<int>(std::lround(1 / (settings.actions_per_second * scene.tick_seconds))));
  made.action = std::make_unique<const ActionLayout>(scene, made.settings);
  made.state = std::make_unique<const StateLayout>(*simulation);
  return model;
}

const EnvironmentSettings& EnvironmentModel::Settings() const {
  return content_->settings;
}
std::span<const Field> EnvironmentModel::ActionFields() const {
  return content_->action->Fields();
}
std::span<const Field> EnvironmentModel::StateFields() const {
  return content_->state->Fields();
}
std::size_t EnvironmentModel::ActionSize() const {
  return content_->action->Size();
}
std::size_t EnvironmentModel::StateSize() const {
  return content_->state->Size();
}
int EnvironmentModel::TicksPerAction() const {
  return content_->ticks;
}

base::Status EnvironmentModel::CheckAction(std::span<const double> action) const {
  return content_->action->Check(action);
}

base::Result<std::shared_ptr<const simulation::SimulationModel>> EnvironmentModel::FindLayout(int layout) {
  TROCAR_ASSERT(layout >= 0 && layout < content_->settings.layouts);
  const std::lock_guard lock(content_->mutex);
  auto& model = content_->models[static_cast<std::size_t>(layout)];
  if (model != nullptr) return model;
  auto scene = ReadLayout(content_->settings, content_->settings.seed + static_cast<std::uint64_t>(layout));
  if (!scene) return scene.error();
  auto made = simulation::MakeSimulationModel(std::make_shared<const scene::Scene>(std::move(*scene)));
  if (!made) return made.error();
  model = std::move(*made);
  return model;
}

// --- environment

struct Environment::Content {
  Content(std::shared_ptr<EnvironmentModel> shared, simulation::Simulation first)
      : model(std::move(shared)), simulation(std::move(first)) {}

  std::shared_ptr<EnvironmentModel> model;
  simulation::Simulation simulation;
  int layout = 0;
  math::Random episodes{1};  // chooses layouts
  scene::Input input;
  RewardMeter meter;
  std::uint64_t actions = 0;
  bool is_begun = false, is_over = false;
  TickObserver observer;

  void Tick() {
    simulation.Step(input);
    meter.AfterTick(simulation);
    if (observer) observer(simulation, &input);
  }
};

Environment::Environment(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Environment::Environment(Environment&&) noexcept = default;
Environment& Environment::operator=(Environment&&) noexcept = default;
Environment::~Environment() = default;

base::Result<Environment> Environment::Make(std::shared_ptr<EnvironmentModel> model) {
  const auto first = model->FindLayout(0);
  if (!first) return first.error();
  auto simulation = simulation::Simulation::Make(*first);
  if (!simulation) return simulation.error();
  return Environment(std::make_unique<Content>(std::move(model), std::move(*simulation)));
}

base::Status Environment::Reset(std::optional<std::uint64_t> seed) {
  Content& now = *content_;
  if (seed) now.episodes = math::Random(*seed);
  const EnvironmentSettings& settings = now.model->Settings();
  const int layout = static_cast<int>(now.episodes.NextWord() % static_cast<std::uint64_t>(settings.layouts));
  if (layout != now.layout) {
    const auto model = now.model->FindLayout(layout);
    if (!model) return model.error();
    auto made = simulation::Simulation::Make(*model);
    if (!made) return made.error();
    now.simulation = std::move(*made);
    now.layout = layout;
  } else {
    now.simulation.Reset();
  }
  const scene::Scene& scene = now.simulation.GetScene();
  now.input = {};
  for (int hand = 0; hand < instrument::kHandCount; ++hand)
    now.input.hands[hand] = scene.instruments[hand].home;
  now.input.laparoscope = scene.laparoscope.home;
  now.input.settings = scene.settings;
  if (scene.operation && !settings.moves_camera) now.input.settings.holds_camera = true;
  now.actions = 0;
  now.is_begun = true;
  now.is_over = false;
  if (now.observer) now.observer(now.simulation, nullptr);
  return {};
}

base::Status Environment::CheckIsRunning() const {
  if (content_->is_begun && !content_->is_over) return {};
  return base::Error{base::ErrorCode::kEnvironmentState,
                     content_->is_begun ? "the episode is over; call reset before the next step"
                                        : "no episode has begun; call reset before the first step"};
}

base::Result<Outcome> Environment::Step(std::span<const double> action) {
  Content& now = *content_;
  if (const auto checked = CheckIsRunning(); !checked) return checked.error();
  const ActionLayout& layout = *now.model->content_->action;
  if (const auto checked = layout.Check(action); !checked) return checked.error();
  const scene::Scene& scene = now.simulation.GetScene();
  const Motion motion = layout.Read(action, now.input);
  now.meter.Begin(now.simulation);
  for (int tick = 0; tick < now.model->TicksPerAction(); ++tick) {
    layout.Move(scene, motion, scene.tick_seconds, now.input);
    now.Tick();
    if (now.simulation.GetSnapshot().task.IsOver()) break;
  }
  return EndStep();
}

base::Result<Outcome> Environment::StepBy(
    const std::function<scene::Input(const simulation::Snapshot&)>& command, std::span<double> action) {
  Content& now = *content_;
  if (const auto checked = CheckIsRunning(); !checked) return checked.error();
  const EnvironmentSettings& settings = now.model->Settings();
  if (settings.actions == ActionKind::kDiscrete)
    return Unusable("what a surgeon does is no discrete action; choose joints or tip");
  const ActionLayout& layout = *now.model->content_->action;
  TROCAR_ASSERT(action.size() == now.model->ActionSize());
  const scene::Scene& scene = now.simulation.GetScene();
  const scene::Input before = now.input;
  now.meter.Begin(now.simulation);
  for (int tick = 0; tick < now.model->TicksPerAction(); ++tick) {
    now.input = command(now.simulation.GetSnapshot());
    now.input.settings = before.settings;
    if (!settings.moves_camera) now.input.laparoscope = before.laparoscope;
    now.Tick();
    if (now.simulation.GetSnapshot().task.IsOver()) break;
  }
  const std::array<math::Vec3, instrument::kHandCount> ports = {scene.instruments[0].p_world_port,
                                                                scene.instruments[1].p_world_port};
  layout.Write(ports, before, now.input, now.model->TicksPerAction() * scene.tick_seconds, action);
  return EndStep();
}

Outcome Environment::EndStep() {
  Content& now = *content_;
  ++now.actions;
  Outcome outcome;
  outcome.features = now.meter.End(now.simulation);
  const EnvironmentSettings& settings = now.model->Settings();
  for (std::size_t i = 0; i < kFeatureCount; ++i) outcome.reward += settings.weights[i] * outcome.features[i];
  const simulation::Snapshot& seen = now.simulation.GetSnapshot();
  outcome.is_success = simulation::HasCompleted(seen);
  outcome.is_terminated = outcome.is_success || seen.task.IsOver();
  // half a tick: the last action may end a rounding error before the time
  outcome.is_truncated = !outcome.is_terminated &&
                         seen.time + 0.5 * now.simulation.GetScene().tick_seconds >= settings.most_seconds;
  now.is_over = outcome.is_terminated || outcome.is_truncated;
  return outcome;
}

void Environment::SetTickObserver(TickObserver observer) {
  content_->observer = std::move(observer);
}

void Environment::Observe(std::span<float> state) const {
  const Content& now = *content_;
  now.model->content_->state->Write(
      now.simulation, now.simulation.GetSnapshot().time / now.model->Settings().most_seconds, state);
}

std::size_t Environment::StateSize() const {
  return content_->model->StateSize();
}
std::size_t Environment::ActionSize() const {
  return content_->model->ActionSize();
}
const simulation::Simulation& Environment::GetSimulation() const {
  return content_->simulation;
}
const scene::Input& Environment::LastInput() const {
  return content_->input;
}
int Environment::Layout() const {
  return content_->layout;
}
std::uint64_t Environment::ActionCount() const {
  return content_->actions;
}
bool Environment::IsOver() const {
  return content_->is_over;
}

}  // namespace trocar::environment
