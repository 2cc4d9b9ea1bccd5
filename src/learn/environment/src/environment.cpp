// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "environment_content.h"
#include "trocar/base/assert.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::environment {
scene::LiveSettings Environment::Content::CalcSettings(const EpisodeDraw& of_episode) const {
  const scene::Scene& scene = simulation.GetScene();
  scene::LiveSettings settings = scene.settings;
  if (scene.operation && !model->Settings().moves_camera) settings.holds_camera = true;
  settings.stiffness_scale *= of_episode.Get(Varied::kStiffness);
  return settings;
}

base::Result<Environment::Content::Place> Environment::Content::FindPlace(const EpisodeDraw& next) const {
  if (progress.is_begun && next == draw) return Place{of, std::nullopt, layout};
  auto found = model->FindModel(next);
  if (!found.ok()) return found.error();
  if (found->model == of) return Place{of, std::nullopt, found->layout};
  auto made = simulation::Simulation::Make(found->model);
  if (!made.ok()) return made.error();
  return Place{std::move(found->model), std::move(*made), found->layout};
}

void Environment::Content::Take(Place&& place, const EpisodeDraw& next) {
  of = std::move(place.of);
  if (place.simulation) simulation = std::move(*place.simulation);
  layout = place.layout;
  draw = next;
}

void Environment::Content::Begin() {
  const scene::Input start = CalcStart(simulation.GetScene(), draw);
  // a standardised start has the bits that it has elsewhere
  if (draw.Get(Varied::kStart) == 0 && draw.Get(Varied::kCamera) == 0) {
    simulation.Reset();
  } else {
    simulation.Reset(start);
  }
  progress.input = {};
  progress.input.hands = start.hands;
  progress.input.laparoscope = start.laparoscope;
  progress.input.settings = CalcSettings(draw);
  progress.late.assign(LateTicks(draw), progress.input);
  progress.actions = 0;
  progress.is_begun = true;
  progress.is_over = false;
}

Environment::Environment(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Environment::Environment(Environment&&) noexcept = default;
Environment& Environment::operator=(Environment&&) noexcept = default;
Environment::~Environment() = default;

base::Result<Environment> Environment::Make(std::shared_ptr<EnvironmentModel> model) {
  auto first = model->FindModel(DrawEpisode(model->Settings().seed, StandardRanges()));
  if (!first.ok()) return first.error();
  auto simulation = simulation::Simulation::Make(first->model);
  if (!simulation) return simulation.error();
  auto content = std::make_unique<Content>(std::move(model), std::move(first->model), std::move(*simulation));
  content->draw = DrawEpisode(content->model->Settings().seed, StandardRanges());
  content->progress.ranges = *content->model->Settings().ranges;
  return Environment(std::move(content));
}

base::Status Environment::Reset(std::optional<std::uint64_t> seed) {
  Content& now = *content_;
  const EnvironmentSettings& settings = now.model->Settings();
  if (!seed && !now.progress.is_begun) seed = settings.seed;
  math::Random episodes = seed ? math::Random(*seed) : now.progress.episodes;
  EpisodeDraw draw;
  if (settings.layouts > 0) {
    // the row of layouts is as it was when seeds decided nothing else
    const std::uint64_t word = episodes.NextWord();
    draw = DrawEpisode(word, now.progress.ranges);
    draw.choice = word;
  } else {
    // a seed of an episode that nobody named is short enough to be written down
    draw = DrawEpisode(seed ? *seed : episodes.NextWord() >> 32, now.progress.ranges);
  }
  auto place = now.FindPlace(draw);
  if (!place.ok()) return place.error();
  now.Take(std::move(*place), draw);
  now.progress.episodes = episodes;
  now.Begin();
  if (now.observer) now.observer(now.simulation, nullptr);
  return {};
}

base::Status Environment::SetRanges(const Ranges& ranges) {
  if (const auto checked = CheckRanges(ranges); !checked) return checked;
  content_->progress.ranges = ranges;
  return {};
}
const Ranges& Environment::GetRanges() const {
  return content_->progress.ranges;
}
std::array<double, kVariedCount> Environment::Drawn() const {
  return content_->draw.values;
}

base::Status Environment::CheckIsRunning() const {
  if (content_->progress.is_begun && !content_->progress.is_over) return {};
  return base::Error{base::ErrorCode::kEnvironmentState,
                     content_->progress.is_begun ? "the episode is over; call reset before the next step"
                                                 : "no episode has begun; call reset before the first step"};
}

base::Result<Outcome> Environment::Step(std::span<const double> action) {
  Content& now = *content_;
  if (const auto checked = CheckIsRunning(); !checked) return checked.error();
  const ActionLayout& layout = *now.model->content_->action;
  if (const auto checked = layout.Check(action); !checked) return checked.error();
  const scene::Scene& scene = now.simulation.GetScene();
  const Motion motion = layout.Read(action, now.progress.input);
  now.meter.Begin(now.simulation);
  for (int tick = 0; tick < now.model->TicksPerAction(); ++tick) {
    layout.Move(scene, motion, scene.tick_seconds, now.progress.input);
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
    return base::Error{base::ErrorCode::kUsage,
                       "what a surgeon does is no discrete action; choose joints or tip"};
  const ActionLayout& layout = *now.model->content_->action;
  TROCAR_ASSERT(action.size() == now.model->ActionSize());
  const scene::Scene& scene = now.simulation.GetScene();
  const scene::Input before = now.progress.input;
  now.meter.Begin(now.simulation);
  for (int tick = 0; tick < now.model->TicksPerAction(); ++tick) {
    now.progress.input = command(now.simulation.GetSnapshot());
    now.progress.input.settings = before.settings;
    if (!settings.moves_camera) now.progress.input.laparoscope = before.laparoscope;
    now.Tick();
    if (now.simulation.GetSnapshot().task.IsOver()) break;
  }
  const std::array<math::Vec3, instrument::kHandCount> ports = {scene.instruments[0].p_world_port,
                                                                scene.instruments[1].p_world_port};
  layout.Write(ports, before, now.progress.input, now.model->TicksPerAction() * scene.tick_seconds, action);
  return EndStep();
}

Outcome Environment::EndStep() {
  Content& now = *content_;
  ++now.progress.actions;
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
  now.progress.is_over = outcome.is_terminated || outcome.is_truncated;
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
  return content_->progress.input;
}
std::uint64_t Environment::Layout() const {
  return content_->layout;
}
std::uint64_t Environment::EpisodeSeed() const {
  return content_->draw.seed;
}
std::uint64_t Environment::ActionCount() const {
  return content_->progress.actions;
}
bool Environment::IsOver() const {
  return content_->progress.is_over;
}

}  // namespace trocar::environment
