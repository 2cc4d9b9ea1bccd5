// SPDX-License-Identifier: Apache-2.0
/// \file pool.h  Many environments of one model in one process, stepped by threads of its own.
/// After the idea of EnvPool: Weng et al., "EnvPool: a highly parallel reinforcement learning environment execution engine", NeurIPS 2022.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "trocar/environment/environment.h"

namespace trocar::environment {

inline constexpr int kMostEnvironments = 4096;  ///< of a pool

/// Reset after the last action of an episode, in Gymnasium's terms.
enum class Autoreset : std::uint8_t {
  kNextStep,  ///< the next action is not used: it begins the next episode, with reward 0
  kSameStep,  ///< the next episode begins at once; the last state of the old one is in `final_state`
  kDisabled   ///< an action to an environment whose episode is over is refused
};

/// Looks at an environment that was reset or stepped, on the pool's thread that did it, before Receive names it: to draw it,
/// for example. Different environments may be looked at at a time.
/// \param is_final  of an episode that is over, while kSameStep begins the next one
/// \return an error, which Receive tells
using PoolObserver =
    std::function<base::Status(std::int32_t id, const Environment& environment, bool is_final)>;

struct PoolSettings {
  int count = 1;    ///< environments, 1 to kMostEnvironments
  int threads = 0;  ///< 0: one for each environment, at most as many as the machine has
  Autoreset autoreset = Autoreset::kNextStep;
  std::uint64_t seed = 1;  ///< environment i begins with seed + i
  PoolObserver observe;    ///< may be empty
};

/// Results of all environments of a pool; row i is environment i's. A row is written while its environment is at work, from
/// Send or Reset until Receive names it.
struct PoolRows {
  std::vector<float> state, final_state;                     ///< (count, StateSize())
  std::vector<double> reward;                                ///< (count)
  std::vector<double> features;                              ///< (count, kFeatureCount)
  std::vector<std::uint8_t> terminated, truncated, success;  ///< (count)
  std::vector<std::uint8_t> was_reset;                       ///< (count) this row begins an episode
  std::vector<std::uint64_t> layout;        ///< (count) Environment::Layout() of the episode of `state`
  std::vector<std::uint64_t> episode_seed;  ///< (count) of it
};

/// Send and Receive may be called from one thread at a time. The results do not depend on the number of threads.
class Pool {
 public:
  /// \return kUsage for a setting out of range, or the model's error
  static base::Result<std::unique_ptr<Pool>> Make(std::shared_ptr<EnvironmentModel> model,
                                                  const PoolSettings& settings);
  ~Pool();  ///< ends when the actions that were sent are done

  int Count() const;
  int ThreadCount() const;
  const EnvironmentModel& Model() const;
  const PoolRows& Rows() const;

  /// Begins new episodes.
  /// \param ids   environments, each once and none of them at work; empty: all
  /// \param seed  environment i gets seed + i; without one their rows of episodes go on
  /// \return kEnvironmentState, kUsage
  base::Status Reset(std::span<const std::int32_t> ids, std::optional<std::uint64_t> seed);
  /// As Reset, with a seed for each environment; one without a seed goes on with its row of episodes.
  /// \param seeds  (ids, or Count())
  /// \return also kUsage for another number of seeds
  base::Status ResetEach(std::span<const std::int32_t> ids,
                         std::span<const std::optional<std::uint64_t>> seeds);
  /// Hands actions to the threads and returns.
  /// \param actions  (ids, ActionSize()) row after row
  /// \param ids      as in Reset
  /// \return kActionInvalid: then none was handed over; kEnvironmentState for an environment that is at work or has not been
  /// reset
  base::Status Send(std::span<const double> actions, std::span<const std::int32_t> ids);
  /// Waits for environments that were sent to work.
  /// \param count  at least 1, at most as many as are at work
  /// \param[out] ids  replaced: the first `count` that are done, in ascending order
  /// \return kEnvironmentState where fewer are at work; an environment's own error
  base::Status Receive(std::size_t count, std::vector<std::int32_t>& ids);
  std::size_t AtWork() const;
  /// One of the pool's environments, to look at until it is sent to work again.
  /// \return kUsage where there is none of that number, kEnvironmentState while it is at work
  base::Result<const Environment*> Look(std::int32_t id) const;
  /// What the seeds of episodes that begin from now on draw from.
  /// \param ids  as in Reset
  /// \return kUsage for a range out of its limits, kEnvironmentState while one is at work
  base::Status SetRanges(std::span<const std::int32_t> ids, const Ranges& ranges);

 private:
  struct Content;
  explicit Pool(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::environment
