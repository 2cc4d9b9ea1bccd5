// SPDX-License-Identifier: Apache-2.0
/// \file state_layout.h  Observation of a simulation as a row of numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "trocar/environment/settings.h"
#include "trocar/simulation/simulation.h"

namespace trocar::environment {

/// Box that places lie in [m].
struct PlaceBounds {
  math::Vec3 low, high;
};

/// Constant for one task: all its layouts have the same things.
class StateLayout {
 public:
  /// \param samples  scenes of the same task with other seeds, at least one: between what bounds their places lie is that of states
  StateLayout(const simulation::Simulation& simulation, std::span<const scene::Scene> samples);

  std::span<const Field> Fields() const { return fields_; }
  std::span<const float> Low() const { return low_; }    ///< (Size())
  std::span<const float> High() const { return high_; }  ///< (Size())
  std::size_t Size() const { return size_; }
  /// \param time_share   of the episode's time that has passed [-]
  /// \param[out] state  (Size())
  void Write(const simulation::Simulation& simulation, double time_share, std::span<float> state) const;

 private:
  void Add(std::string name, std::size_t count, std::string unit, double low, double high);
  void AddPlace(std::string name, const PlaceBounds& bounds);
  void AddRow(std::string name, std::string unit, std::span<const Range> ranges);

  std::vector<Field> fields_;
  std::vector<float> low_, high_;
  std::size_t size_ = 0;
};

}  // namespace trocar::environment
