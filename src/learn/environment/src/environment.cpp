// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/environment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <utility>

#include "action_layout.h"
#include "episode.h"
#include "episode_draw.h"
#include "reward.h"
#include "state_layout.h"
#include "trocar/base/assert.h"
#include "trocar/base/checksum.h"
#include "trocar/base/state_archive.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/task_file.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/random.h"
#include "trocar/math/state_fields.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::environment {
namespace {

base::Error Unusable(const std::string& what) {
  return base::Error{base::ErrorCode::kUsage, what};
}

base::Status CheckSettings(const EnvironmentSettings& settings) {
  if (settings.layouts < 0 || settings.layouts > 4096)
    return Unusable("an environment has 1 to 4096 layouts, or 0 for one of each seed, not " +
                    std::to_string(settings.layouts));
  if (settings.models < 0 || settings.models > 4096)
    return Unusable("an environment keeps 1 to 4096 models, or 0 for as many as is usual, not " +
                    std::to_string(settings.models));
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

/// Text of what is to be done, and where it stands.
struct Source {
  std::string text;
  std::filesystem::path path;
};

base::Result<Source> ReadSource(const EnvironmentSettings& settings) {
  if (!settings.document.empty()) return Source{settings.document, settings.task};
  const auto path = files::FindSceneFile(settings.task);
  if (!path.ok()) return path.error();
  auto text = host::ReadFile(*path);
  if (!text.ok()) return text.error();
  return Source{std::move(*text), *path};
}

/// Whether a text is a task's. Nothing where it is not readable: whoever parses it says why.
bool IsTask(const Source& source) {
  const auto document = host::JsonDocument::Parse(source.text, source.path.string());
  return document.ok() && document->Root().TextOr("format", "") == "trocar-task";
}

}  // namespace

// --- model

struct EnvironmentModel::Content {
  EnvironmentSettings settings;
  Source source;
  std::optional<files::TaskForm> form;  ///< of a task
  bool has_tissue = false;
  std::size_t kept = 1;  ///< models, of `layouts` or of tissue
  int ticks = 1;
  std::unique_ptr<const ActionLayout> action;
  std::unique_ptr<const StateLayout> state;
  std::mutex mutex;  // of the models
  std::vector<std::shared_ptr<const simulation::SimulationModel>> models;

  std::filesystem::path PatientOf(std::size_t number) const {
    return settings.patients.empty() ? std::filesystem::path()
                                     : settings.patients[number % settings.patients.size()];
  }
  /// Seed of a kept model's layout.
  std::uint64_t SeedOf(std::size_t number) const {
    return settings.layouts > 0 ? settings.seed + number
                                : 1 + number / std::max<std::size_t>(1, settings.patients.size());
  }
  base::Result<scene::Scene> Parse(std::uint64_t seed, const std::filesystem::path& patient,
                                   bool is_varied) const;
  base::Status CheckFits(const simulation::Simulation& made, const scene::Scene& reference) const;
};

base::Result<scene::Scene> EnvironmentModel::Content::Parse(std::uint64_t seed,
                                                            const std::filesystem::path& patient,
                                                            bool is_varied) const {
  if (form) return form->MakeScene(seed, is_varied, patient);
  auto scene = files::ParseScene(source.text, source.path, {settings.level, seed, patient});
  if (scene.ok() && !scene->operation) {
    return base::Error{
        base::ErrorCode::kSceneInvalid,
        source.path.string() +
            ": in this scene nothing is to be done; an environment is a task or an operation"};
  }
  return scene;
}

/// A patient may have other organs, whose states a policy could not read.
base::Status EnvironmentModel::Content::CheckFits(const simulation::Simulation& made,
                                                  const scene::Scene& reference) const {
  const StateLayout other(made, reference);
  const auto same = [](const Field& a, const Field& b) { return a.name == b.name && a.count == b.count; };
  if (std::equal(other.Fields().begin(), other.Fields().end(), state->Fields().begin(), state->Fields().end(),
                 same))
    return {};
  return base::Error{
      base::ErrorCode::kSceneInvalid,
      source.path.string() + ": \"" + made.GetScene().patient_folder.string() +
          "\" has other organs, ducts or things than the first patient; an environment's states name "
          "the same ones"};
}

EnvironmentModel::EnvironmentModel(std::unique_ptr<Content> content) : content_(std::move(content)) {}
EnvironmentModel::~EnvironmentModel() = default;

base::Result<std::shared_ptr<EnvironmentModel>> EnvironmentModel::Make(const EnvironmentSettings& settings) {
  if (const auto checked = CheckSettings(settings); !checked) return checked.error();
  auto content = std::make_unique<Content>();
  Content& made = *content;
  made.settings = settings;
  if (!settings.ranges) made.settings.ranges = settings.layouts > 0 ? StandardRanges() : UsualRanges();
  if (const auto checked = CheckRanges(*made.settings.ranges); !checked) return checked.error();
  auto source = ReadSource(settings);
  if (!source.ok()) return source.error();
  made.source = std::move(*source);
  if (IsTask(made.source)) {
    auto form = files::TaskForm::Parse(made.source.text, made.source.path, settings.level);
    if (!form.ok()) return form.error();
    made.form = std::move(*form);
  }
  // what the meaning of states is measured with: the same whatever the seed
  auto standard = made.Parse(1, made.PatientOf(0), false);
  if (!standard.ok()) return standard.error();
  const auto reference = std::make_shared<const scene::Scene>(std::move(*standard));
  made.has_tissue = reference->operation || reference->model || reference->HasPatient();
  const std::size_t patients = std::max<std::size_t>(1, settings.patients.size());
  const int usual = reference->model ? 8 : static_cast<int>(patients);
  made.kept = static_cast<std::size_t>(settings.layouts > 0  ? settings.layouts
                                       : settings.models > 0 ? settings.models
                                                             : usual);
  made.models.resize(made.kept);
  std::shared_ptr<EnvironmentModel> model(new EnvironmentModel(std::move(content)));
  const auto first = model->FindModel(DrawEpisode(settings.seed, StandardRanges()));
  if (!first.ok()) return first.error();
  const auto simulation = simulation::Simulation::Make(first->model);
  if (!simulation) return simulation.error();
  const scene::Scene& scene = simulation->GetScene();
  if (made.settings.most_seconds == 0) made.settings.most_seconds = UsualSeconds(scene);
  made.settings.moves_camera = made.settings.moves_camera || IsAboutCamera(scene);
  made.ticks =
      std::max(1, static_cast<int>(std::lround(1 / (settings.actions_per_second * scene.tick_seconds))));
  made.action = std::make_unique<const ActionLayout>(scene, made.settings);
  made.state = std::make_unique<const StateLayout>(*simulation, *reference);
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

std::span<const float> EnvironmentModel::StateLow() const {
  return content_->state->Low();
}
std::span<const float> EnvironmentModel::StateHigh() const {
  return content_->state->High();
}

base::Result<EnvironmentModel::Found> EnvironmentModel::FindModel(const EpisodeDraw& draw) {
  Content& c = *content_;
  const bool is_varied = c.settings.layouts == 0;
  const bool is_kept = !is_varied || c.has_tissue;
  const std::size_t number = static_cast<std::size_t>(draw.choice % c.kept);
  const std::uint64_t seed = is_kept ? c.SeedOf(number) : draw.seed;
  const std::uint64_t layout = is_varied ? seed : number;
  const auto make = [&]() -> base::Result<std::shared_ptr<const simulation::SimulationModel>> {
    auto scene = c.Parse(seed, c.PatientOf(number), is_varied);
    if (!scene.ok()) return scene.error();
    ChangeThings(draw, *scene);
    return simulation::MakeSimulationModel(std::make_shared<const scene::Scene>(std::move(*scene)));
  };
  if (!is_kept || ChangesThings(draw)) {
    auto made = make();
    if (!made.ok()) return made.error();
    return Found{std::move(*made), layout};
  }
  const std::lock_guard lock(c.mutex);
  auto& model = c.models[number];
  if (model != nullptr) return Found{model, layout};
  auto made = make();
  if (!made.ok()) return made.error();
  if (c.state != nullptr && c.settings.patients.size() > 1) {
    const auto simulation = simulation::Simulation::Make(*made);
    if (!simulation.ok()) return simulation.error();
    if (const auto fits = c.CheckFits(*simulation, simulation->GetScene()); !fits) return fits.error();
  }
  model = std::move(*made);
  return Found{model, layout};
}

// --- environment

namespace {

void VisitInput(base::StateArchive& archive, scene::Input& input) {
  archive.Field("hands", input.hands);
  for (scene::HandControls& controls : input.controls) {
    archive.Field("tool", controls.tool);
    archive.Field("cut", controls.cut);
    archive.Field("coagulate", controls.coagulate);
    archive.Field("rinse", controls.rinse);
    archive.Field("aspirate", controls.aspirate);
  }
  archive.Field("assistant", input.assistant);
  archive.Field("laparoscope", input.laparoscope);
}

/// All that decides how an environment goes on, beside its simulation and what the episode has drawn.
struct Progress {
  math::Random episodes{1};  ///< seeds of the episodes that nobody names
  Ranges ranges{};           ///< of the next episodes
  scene::Input input;        ///< what is asked of the hands
  /// What they were asked in the last ticks, oldest first: as many as they are late.
  std::vector<scene::Input> late;
  std::uint64_t actions = 0;
  bool is_begun = false, is_over = false;

  void VisitState(base::StateArchive& archive) {
    auto row = std::bit_cast<std::uint64_t>(episodes);
    archive.Field("episodes", row);
    episodes = std::bit_cast<math::Random>(row);
    for (Range& range : ranges) {
      archive.Field("low", range.low);
      archive.Field("high", range.high);
    }
    archive.Field("actions", actions);
    archive.Field("is_begun", is_begun);
    archive.Field("is_over", is_over);
    VisitInput(archive, input);
    for (scene::Input& one : late) VisitInput(archive, one);
  }
};

}  // namespace

struct Environment::Content {
  Content(std::shared_ptr<EnvironmentModel> shared, std::shared_ptr<const simulation::SimulationModel> made,
          simulation::Simulation first)
      : model(std::move(shared)), of(std::move(made)), simulation(std::move(first)) {}

  std::shared_ptr<EnvironmentModel> model;
  std::shared_ptr<const simulation::SimulationModel> of;  ///< what `simulation` runs on
  simulation::Simulation simulation;
  EpisodeDraw draw;
  std::uint64_t layout = 0;
  Progress progress;
  RewardMeter meter;
  TickObserver observer;
  std::vector<std::byte> saved;  ///< memory that Save and Restore use again

  void Tick() {
    scene::Input now = progress.input;
    if (std::vector<scene::Input>& late = progress.late; !late.empty()) {
      now = late.front();
      std::move(late.begin() + 1, late.end(), late.begin());
      late.back() = progress.input;
    }
    simulation.Step(now);
    meter.AfterTick(simulation);
    if (observer) observer(simulation, &now);
  }
  scene::LiveSettings CalcSettings(const EpisodeDraw& of_episode) const;
  std::size_t LateTicks(const EpisodeDraw& of_episode) const {
    return static_cast<std::size_t>(
        std::lround(of_episode.Get(Varied::kLatency) / simulation.GetScene().tick_seconds));
  }
  /// Another simulation where the episode needs one.
  struct Place {
    std::shared_ptr<const simulation::SimulationModel> of;
    std::optional<simulation::Simulation> simulation;
    std::uint64_t layout = 0;
  };
  base::Result<Place> FindPlace(const EpisodeDraw& next) const;
  void Take(Place&& place, const EpisodeDraw& next);
  /// The first tick of the episode that was drawn.
  void Begin();
};

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
    return Unusable("what a surgeon does is no discrete action; choose joints or tip");
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

// --- save and restore

namespace {

struct SaveHeader {
  std::array<char, 8> magic{};
  std::uint64_t version = 0, size = 0, checksum = 0;  // of what follows
};
constexpr std::array<char, 8> kSaveMagic{'T', 'R', 'O', 'C', 'E', 'N', 'V', 'S'};
constexpr std::uint64_t kSaveVersion = 1;

base::Error RefuseState(const std::string& why) {
  return base::Error{base::ErrorCode::kStateInvalid, why};
}

/// What a program that is not ours may have written.
bool IsUsable(const scene::Input& input, const scene::Scene& scene) {
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const instrument::TrocarJoints& joints = input.hands[hand];
    for (const double joint : {joints.pan, joints.tilt, joints.spin, joints.depth, joints.jaw}) {
      if (!std::isfinite(joint)) return false;
    }
    if (input.controls[hand].tool >= scene.instruments[hand].tray.size()) return false;
  }
  for (const double joint :
       {input.laparoscope.pan, input.laparoscope.tilt, input.laparoscope.spin, input.laparoscope.depth}) {
    if (!std::isfinite(joint)) return false;
  }
  return input.assistant <= scene::AssistantCommand::kRelease;
}

bool IsUsable(const EpisodeDraw& draw) {
  Ranges ranges;
  for (std::size_t i = 0; i < kVariedCount; ++i) ranges[i] = {draw.values[i], draw.values[i]};
  if (!CheckRanges(ranges).ok()) return false;
  for (const math::Vec3& aside : draw.asides) {
    if (!(math::Norm(aside) <= 1.001)) return false;
  }
  return std::abs(draw.aside_pan) <= 1.001 && std::abs(draw.aside_tilt) <= 1.001;
}

void VisitDraw(base::StateArchive& archive, EpisodeDraw& draw) {
  archive.Field("seed", draw.seed);
  archive.Field("choice", draw.choice);
  archive.Field("values", draw.values);
  archive.Field("asides", draw.asides);
  archive.Field("aside_pan", draw.aside_pan);
  archive.Field("aside_tilt", draw.aside_tilt);
}

}  // namespace

void Environment::Save(std::vector<std::byte>& bytes) const {
  Content& now = *content_;
  bytes.resize(sizeof(SaveHeader));
  now.simulation.Save(now.saved);
  base::StateArchive archive = base::StateArchive::ForSave(bytes);
  VisitDraw(archive, now.draw);
  archive.Field("progress", now.progress);
  archive.Field("simulation", now.saved);
  const auto content = std::span<const std::byte>(bytes).subspan(sizeof(SaveHeader));
  const SaveHeader header{kSaveMagic, kSaveVersion, content.size(), base::CalcChecksum(content)};
  std::memcpy(bytes.data(), &header, sizeof(header));
}

base::Status Environment::Restore(std::span<const std::byte> bytes) {
  SaveHeader header;
  if (bytes.size() < sizeof(header))
    return RefuseState("a saved environment ends within its header; save it again");
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto content = bytes.subspan(sizeof(header));
  if (header.magic != kSaveMagic) return RefuseState("these bytes are no saved environment");
  if (header.version != kSaveVersion) {
    return RefuseState("the environment was saved in format " + std::to_string(header.version) +
                       ", this program reads " + std::to_string(kSaveVersion) + "; save it again");
  }
  if (header.size != content.size() || header.checksum != base::CalcChecksum(content))
    return RefuseState(
        "the saved environment is damaged: its checksum does not fit; take another copy of it");

  Content& now = *content_;
  EpisodeDraw draw;
  base::StateArchive archive = base::StateArchive::ForRestore(content);
  VisitDraw(archive, draw);
  if (!archive.ok() || !IsUsable(draw))
    return RefuseState("what a saved environment has drawn is out of range");
  Progress progress;
  progress.late.resize(now.LateTicks(draw));
  archive.Field("progress", progress);
  archive.Field("simulation", now.saved);
  if (!archive.ok() || !archive.IsAtEnd())
    return RefuseState("the saved environment is of other settings: " + archive.Failure());
  const scene::Scene& scene = now.simulation.GetScene();
  bool is_usable = CheckRanges(progress.ranges).ok() && IsUsable(progress.input, scene);
  for (const scene::Input& late : progress.late) is_usable = is_usable && IsUsable(late, scene);
  if (!is_usable) return RefuseState("a saved environment has numbers out of range");

  auto place = now.FindPlace(draw);
  if (!place.ok()) return place.error();
  if (place->simulation || !now.progress.is_begun || draw != now.draw) {
    // where the episode began is part of no saved state
    simulation::Simulation& entered = place->simulation ? *place->simulation : now.simulation;
    if (place->simulation) {
      entered.Reset(CalcStart(entered.GetScene(), draw));
      if (const auto restored = entered.Restore(now.saved); !restored) return restored;
    } else {
      std::vector<std::byte> before;
      now.simulation.Save(before);
      entered.Reset(CalcStart(entered.GetScene(), draw));
      if (const auto restored = entered.Restore(now.saved); !restored) {
        entered.Reset(CalcStart(entered.GetScene(), now.draw));
        TROCAR_ASSERT(entered.Restore(before).ok());
        return restored;
      }
    }
  } else if (const auto restored = now.simulation.Restore(now.saved); !restored) {
    return restored;
  }
  now.Take(std::move(*place), draw);
  now.progress = std::move(progress);
  const scene::LiveSettings settings = now.CalcSettings(draw);
  now.progress.input.settings = settings;
  for (scene::Input& late : now.progress.late) late.settings = settings;
  if (now.observer) now.observer(now.simulation, nullptr);
  return {};
}

base::Result<Environment> Environment::Clone() const {
  Content& now = *content_;
  auto simulation = simulation::Simulation::Make(now.of);
  if (!simulation.ok()) return simulation.error();
  auto content = std::make_unique<Content>(now.model, now.of, std::move(*simulation));
  content->draw = now.draw;
  content->layout = now.layout;
  content->progress = now.progress;
  if (now.progress.is_begun) content->simulation.Reset(CalcStart(now.simulation.GetScene(), now.draw));
  now.simulation.Save(now.saved);
  const auto restored = content->simulation.Restore(now.saved);
  TROCAR_ASSERT(restored.ok());  // saved by a simulation of the same model
  return Environment(std::move(content));
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
