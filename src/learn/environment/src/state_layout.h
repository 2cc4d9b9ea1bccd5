// SPDX-License-Identifier: Apache-2.0
/// \file state_layout.h  Observation of a simulation as a row of numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "trocar/environment/settings.h"
#include "trocar/simulation/simulation.h"

namespace trocar::environment {

/// Constant for one task: all its layouts have the same things.
class StateLayout {
 public:
  explicit StateLayout(const simulation::Simulation& simulation);

  std::span<const Field> Fields() const { return fields_; }
  std::size_t Size() const { return size_; }
  /// \param time_share   of the episode's time that has passed [-]
  /// \param[out] state  (Size())
  void Write(const simulation::Simulation& simulation, double time_share, std::span<float> state) const;

 private:
  void Add(std::string name, std::size_t count, std::string unit);

  std::vector<Field> fields_;
  std::size_t size_ = 0;
};

}  // namespace trocar::environment
