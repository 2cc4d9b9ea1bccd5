// SPDX-License-Identifier: Apache-2.0
/// \file environment_content.h  What a model of environments and an environment consist of.
#pragma once

#include <bit>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "action_layout.h"
#include "episode_draw.h"
#include "reward.h"
#include "state_layout.h"
#include "trocar/base/state_archive.h"
#include "trocar/base/to_integer.h"
#include "trocar/environment/environment.h"
#include "trocar/files/task_file.h"
#include "trocar/math/random.h"

namespace trocar::environment {

/// Text of what is to be done, and where it stands.
struct Source {
  std::string text;
  std::filesystem::path path;
};

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
  base::Status CheckFits(const simulation::Simulation& made) const;
};

/// All that decides how an environment goes on, beside its simulation and what the episode has drawn.
struct Progress {
  math::Random episodes{1};  ///< seeds of the episodes that nobody names
  Ranges ranges{};           ///< of the next episodes
  scene::Input input;        ///< what is asked of the hands
  /// What they were asked in the last ticks, oldest first: as many as they are late.
  std::vector<scene::Input> late;
  std::uint64_t actions = 0;
  bool is_begun = false, is_over = false;

  void VisitState(base::StateArchive& archive);
};

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
    return base::RoundTo<std::size_t>(of_episode.Get(Varied::kLatency) / simulation.GetScene().tick_seconds);
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

}  // namespace trocar::environment
