// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "environment_content.h"
#include "episode.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/find_scene.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"

namespace trocar::environment {
namespace {

/// Layouts whose places say between what bounds those of all seeds lie.
constexpr std::size_t kSamples = 32;

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

base::Result<scene::Scene> EnvironmentModel::Content::Parse(std::uint64_t seed,
                                                            const std::filesystem::path& patient,
                                                            bool is_varied) const {
  if (form) return form->MakeScene(seed, is_varied, patient);
  auto scene = files::ParseScene(source.text, source.path, {settings.level, seed, patient});
  if (scene.ok() && !scene->operation) {
    return base::Error{base::ErrorCode::kSceneInvalid,
                       source.path.string() +
                           ": in this scene nothing is to be done; an environment is a task or an operation"};
  }
  return scene;
}

/// A patient may have other organs, whose states a policy could not read.
base::Status EnvironmentModel::Content::CheckFits(const simulation::Simulation& made) const {
  const StateLayout other(made, std::span(&made.GetScene(), 1));
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
  // what states are measured with: the same whatever seed and layouts are asked for
  std::vector<scene::Scene> samples;
  do {
    auto sample = made.Parse(samples.size() + 1, made.PatientOf(0), true);
    if (!sample.ok()) return sample.error();
    samples.push_back(std::move(*sample));
  } while (samples.size() < kSamples && !samples.front().HasPatient());
  const scene::Scene& sample = samples.front();
  made.has_tissue = sample.operation || sample.model || sample.HasPatient();
  const std::size_t patients = std::max<std::size_t>(1, settings.patients.size());
  const int usual = sample.model ? 8 : static_cast<int>(patients);
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
  made.ticks = std::max(1, base::RoundTo<int>(1 / (settings.actions_per_second * scene.tick_seconds)));
  made.action = std::make_unique<const ActionLayout>(scene, made.settings);
  made.state = std::make_unique<const StateLayout>(*simulation, samples);
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
    if (const auto fits = c.CheckFits(*simulation); !fits) return fits.error();
  }
  model = std::move(*made);
  return Found{model, layout};
}

}  // namespace trocar::environment
