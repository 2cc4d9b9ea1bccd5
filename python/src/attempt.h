// SPDX-License-Identifier: Apache-2.0
/// \file attempt.h  An attempt, collected tick by tick, and its metrics.
#pragma once

#include <optional>

#include "binding.h"
#include "trocar/record/trace.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_metrics.h"

namespace trocar::python {

class Attempt {
 public:
  explicit Attempt(const simulation::Simulation& simulation) { Begin(simulation); }

  /// Begins another attempt.
  void Begin(const simulation::Simulation& simulation) {
    trace_.emplace(simulation);
    trace_->Add(simulation.GetSnapshot());
  }
  /// After each tick.
  void Add(const simulation::Simulation& simulation, const scene::Input& input) {
    trace_->Add(simulation.GetSnapshot(), input.controls);
  }
  /// \return a list of {"metric", "value", "unit"}, of a part also "hand", "phase", "tool"
  py::object Describe() const {
    std::string text;
    {
      const py::gil_scoped_release release;
      text = training::FormatMetricsJson(Take(training::CalcAttemptMetrics(trace_->Calc())));
    }
    return py::module_::import("json").attr("loads")(text);
  }

 private:
  std::optional<record::TraceBuilder> trace_;
};

}  // namespace trocar::python
