// SPDX-License-Identifier: Apache-2.0
/// \file demonstration.h  Demonstrations to learn from: the course of a simulation in the states and actions of an environment.
#pragma once

#include <memory>
#include <span>

#include "trocar/environment/settings.h"
#include "trocar/scene/input.h"
#include "trocar/simulation/simulation.h"

namespace trocar::environment {

/// Looks on while a surgeon or a recording plays. Constant for one task.
class Demonstration {
 public:
  /// \param simulation  any of the task
  explicit Demonstration(const simulation::Simulation& simulation);
  Demonstration(Demonstration&&) noexcept;
  Demonstration& operator=(Demonstration&&) noexcept;
  ~Demonstration();

  std::span<const Field> StateFields() const;
  std::size_t StateSize() const;
  /// \param kind  kJoints or kTip (TROCAR_ASSERT): a choice among steps cannot say how somebody moves
  std::span<const Field> ActionFields(ActionKind kind) const;
  std::size_t ActionSize(ActionKind kind) const;

  /// Observation of an environment with the usual settings.
  /// \param[out] state  (StateSize())
  void Observe(const simulation::Simulation& simulation, std::span<float> state) const;
  /// The action that takes hands and camera from one input to another.
  /// \param kind         kJoints or kTip (TROCAR_ASSERT)
  /// \param seconds      between the two, > 0 (TROCAR_ASSERT) [s]
  /// \param[out] action  (ActionSize(kind)) from -1 to 1: who moves faster than an environment's hands can, is cut to that.
  ///                     Pedals, tools and the assistant's command are those of `after`
  void FindAction(ActionKind kind, const scene::Input& before, const scene::Input& after, double seconds,
                  std::span<double> action) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::environment
