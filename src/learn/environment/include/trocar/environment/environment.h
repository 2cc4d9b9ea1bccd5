// SPDX-License-Identifier: Apache-2.0
/// \file environment.h  A training task or the operation as an environment for reinforcement learning: reset, act, observe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/environment/settings.h"
#include "trocar/simulation/simulation.h"

namespace trocar::environment {

struct EpisodeDraw;

/// Data shared by all environments of the same settings: models of the layouts, and the meaning of actions and states.
class EnvironmentModel {
 public:
  /// \return kUsage for a setting out of range, kUnknownName for a task that is not known, or the file's error
  static base::Result<std::shared_ptr<EnvironmentModel>> Make(const EnvironmentSettings& settings);
  ~EnvironmentModel();

  const EnvironmentSettings& Settings() const;  ///< with what was left open filled in
  std::span<const Field> ActionFields() const;
  std::span<const Field> StateFields() const;
  std::size_t ActionSize() const;  ///< numbers in an action
  std::size_t StateSize() const;   ///< numbers in a state
  int TicksPerAction() const;
  /// Range of each number of a state: (StateSize()) what StateFields() name lies between, nearly always. The same for every
  /// seed. Of places it is a box round all that the task has.
  std::span<const float> StateLow() const;
  std::span<const float> StateHigh() const;
  /// Whether an action can be used: each number finite, and in -1 to 1 (what lies beyond by single precision's rounding, a
  /// millionth, is cut by Step) or one of the choices. Where the settings clip, numbers out of range can be used, too.
  /// \param action  (ActionSize())
  /// \return kActionInvalid with the field that is wrong
  base::Status CheckAction(std::span<const double> action) const;

 private:
  friend class Environment;
  /// Model of an episode, and the number of its layout.
  struct Found {
    std::shared_ptr<const simulation::SimulationModel> model;
    std::uint64_t layout = 0;
  };
  base::Result<Found> FindModel(const EpisodeDraw& draw);
  struct Content;
  explicit EnvironmentModel(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// Result of one action.
struct Outcome {
  double reward = 0;
  bool is_terminated = false;  ///< by the task's own rules: completed, its time over, or ended by an error
  bool is_truncated = false;   ///< `most_seconds` are over
  bool is_success = false;     ///< completed
  Features features{};
};

/// Looks at what an environment's ticks have come to, on the thread that steps it: to collect an attempt, for example.
/// \param input  what the tick was given; empty where an episode begins
using TickObserver = std::function<void(const simulation::Simulation& simulation, const scene::Input* input)>;

/// One running environment. Not for two threads at a time. The same model, seeds and actions give the same states and rewards.
class Environment {
 public:
  /// \return as EnvironmentModel::Make
  static base::Result<Environment> Make(std::shared_ptr<EnvironmentModel> model);
  Environment(Environment&&) noexcept;
  Environment& operator=(Environment&&) noexcept;
  ~Environment();

  /// Begins an episode.
  /// \param seed  decides the layout and all else that varies, and the row of the episodes after it; without one the row goes on
  base::Status Reset(std::optional<std::uint64_t> seed = {});
  /// What the seeds of episodes from the next one on draw from.
  /// \return kUsage for a range out of its limits
  base::Status SetRanges(const Ranges& ranges);
  const Ranges& GetRanges() const;
  /// What this episode has drawn, indexed by Varied.
  std::array<double, kVariedCount> Drawn() const;

  /// All that decides how the episode goes on, and the episodes after it, as bytes.
  /// \param[out] bytes  replaced; its memory is used again
  void Save(std::vector<std::byte>& bytes) const;
  /// Takes up what an environment of the same settings has saved: from then on the same actions give the same states and rewards.
  /// An observer of ticks is told as of a Reset: what an attempt was before is not saved.
  /// \return kStateInvalid where it is damaged or of other settings; then all is as it was
  base::Status Restore(std::span<const std::byte> bytes);
  /// One more that goes on from here.
  /// \return as Make
  base::Result<Environment> Clone() const;

  /// \param action  (ActionSize()), that CheckAction accepts
  /// \return kActionInvalid; kEnvironmentState before a Reset or after the episode's end
  base::Result<Outcome> Step(std::span<const double> action);
  /// As Step, for a caller who commands every tick, as scripted surgeons do: plays the ticks of one action.
  /// \param command  what the next tick is given, from what the last one published. Settings, and a laparoscope that is no part
  ///     of the action, stay as the environment has them
  /// \param[out] action  (ActionSize()) what that amounts to, from -1 to 1; pedals and tools as they are at its end
  /// \return kUsage for discrete actions; kEnvironmentState as Step
  base::Result<Outcome> StepBy(const std::function<scene::Input(const simulation::Snapshot&)>& command,
                               std::span<double> action);
  /// Sets the observer of ticks, in place of the one before; may be empty.
  void SetTickObserver(TickObserver observer);
  /// \param[out] state  (StateSize()) as StateFields() says
  void Observe(std::span<float> state) const;
  std::size_t StateSize() const;   ///< of the model
  std::size_t ActionSize() const;  ///< of the model

  const simulation::Simulation& GetSimulation() const;
  /// Input of the last tick of the last action.
  const scene::Input& LastInput() const;
  std::uint64_t Layout()
      const;  ///< of this episode: its number among `layouts`, else the seed of the task's layout
  /// With which a Reset brings this episode about again, where every seed has its own layout.
  std::uint64_t EpisodeSeed() const;
  std::uint64_t ActionCount() const;  ///< of this episode
  bool IsOver() const;

 private:
  base::Status CheckIsRunning() const;
  Outcome EndStep();
  struct Content;
  explicit Environment(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::environment
