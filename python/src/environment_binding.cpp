// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "binding.h"
#include "trocar/core/state_hash.h"
#include "trocar/environment/pool.h"

namespace trocar::python {
namespace {

using environment::Environment;
using environment::EnvironmentModel;
using environment::EnvironmentSettings;
using environment::Feature;
using environment::kFeatureCount;
using environment::Outcome;
using environment::Pool;

using Row = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ids = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

std::span<const double> View(const Row& row) {
  return {row.data(), static_cast<std::size_t>(row.size())};
}
std::span<const std::int32_t> View(const Ids& ids) {
  return {ids.data(), static_cast<std::size_t>(ids.size())};
}

/// Weights by name over the usual ones.
environment::Features ReadWeights(const std::map<std::string, double>& named) {
  environment::Features weights = environment::DefaultWeights();
  for (const auto& [name, weight] : named) {
    std::size_t i = 0;
    while (i < kFeatureCount && environment::NameOf(static_cast<Feature>(i)) != name) ++i;
    if (i == kFeatureCount) {
      std::string known;
      for (std::size_t k = 0; k < kFeatureCount; ++k)
        known += (k == 0 ? "" : ", ") + std::string(environment::NameOf(static_cast<Feature>(k)));
      throw Failure(
          {core::ErrorCode::kUnknownName, "a reward has no feature \"" + name + "\"; there are " + known});
    }
    weights[i] = weight;
  }
  return weights;
}

std::shared_ptr<EnvironmentModel> MakeModel(const std::string& task, const std::string& level,
                                            const std::string& patient, std::uint64_t seed, int layouts,
                                            const std::string& actions, double actions_per_second,
                                            double most_seconds, bool moves_camera,
                                            const std::map<std::string, double>& weights) {
  const auto kind = environment::FindActionKind(actions);
  if (!kind) {
    throw Failure({core::ErrorCode::kUnknownName,
                   "there is no kind of actions \"" + actions + "\"; choose joints, tip or discrete"});
  }
  const py::gil_scoped_release release;
  return Take(EnvironmentModel::Make({task, level, patient, seed, layouts, *kind, actions_per_second,
                                      most_seconds, moves_camera, ReadWeights(weights)}));
}

py::list DescribeFields(std::span<const environment::Field> fields) {
  py::list out;
  for (const environment::Field& field : fields) {
    py::dict entry;
    entry["name"] = field.name;
    entry["first"] = field.first;
    entry["count"] = field.count;
    entry["unit"] = field.unit;
    entry["choices"] = field.choices;
    out.append(entry);
  }
  return out;
}

py::dict DescribeFeatures(const environment::Features& features) {
  py::dict out;
  for (std::size_t i = 0; i < kFeatureCount; ++i)
    out[py::str(std::string(environment::NameOf(static_cast<Feature>(i))))] = features[i];
  return out;
}

/// A read-only view of memory that `owner` keeps alive.
template <typename T>
py::array ViewRows(const std::vector<T>& all, py::ssize_t rows, py::ssize_t columns,
                   const py::object& owner) {
  std::vector<py::ssize_t> shape = {rows};
  if (columns > 0) shape.push_back(columns);
  py::array_t<T> view(shape, all.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

void BindPool(py::module_& module) {
  py::class_<Pool>(module, "Pool", "Environments of one model that threads of the pool's own step.")
      .def(
          py::init([](std::shared_ptr<EnvironmentModel> model, int count, int threads,
                      const std::string& autoreset, std::uint64_t seed) {
            environment::Autoreset mode = environment::Autoreset::kNextStep;
            if (autoreset == "SameStep") {
              mode = environment::Autoreset::kSameStep;
            } else if (autoreset == "Disabled") {
              mode = environment::Autoreset::kDisabled;
            } else if (autoreset != "NextStep") {
              throw Failure({core::ErrorCode::kUnknownName, "there is no autoreset mode \"" + autoreset +
                                                                "\"; choose NextStep, SameStep or Disabled"});
            }
            const py::gil_scoped_release release;
            return Take(Pool::Make(std::move(model), {count, threads, mode, seed}));
          }),
          py::arg("model"), py::kw_only(), py::arg("count"), py::arg("threads") = 0,
          py::arg("autoreset") = "NextStep", py::arg("seed") = 1)
      .def_property_readonly("count", &Pool::Count)
      .def_property_readonly("threads", &Pool::ThreadCount)
      .def_property_readonly("at_work", &Pool::AtWork)
      .def(
          "reset",
          [](Pool& pool, const Ids& ids, std::optional<std::uint64_t> seed) {
            Check(pool.Reset(View(ids), seed));
          },
          py::arg("ids"), py::arg("seed"))
      .def(
          "send",
          [](Pool& pool, const Row& actions, const Ids& ids) { Check(pool.Send(View(actions), View(ids))); },
          py::arg("actions"), py::arg("ids"))
      .def(
          "receive",
          [](Pool& pool, std::size_t count) {
            std::vector<std::int32_t> ids;
            {
              py::gil_scoped_release release;
              Check(pool.Receive(count, ids));
            }
            return py::array_t<std::int32_t>(static_cast<py::ssize_t>(ids.size()), ids.data());
          },
          py::arg("count"))
      .def(
          "rows",
          [](const py::object& self) {
            const Pool& pool = self.cast<const Pool&>();
            const auto& rows = pool.Rows();
            const auto count = static_cast<py::ssize_t>(pool.Count());
            const auto size = static_cast<py::ssize_t>(pool.Model().StateSize());
            py::dict out;
            out["state"] = ViewRows(rows.state, count, size, self);
            out["final_state"] = ViewRows(rows.final_state, count, size, self);
            out["reward"] = ViewRows(rows.reward, count, 0, self);
            out["features"] = ViewRows(rows.features, count, static_cast<py::ssize_t>(kFeatureCount), self);
            out["terminated"] = ViewRows(rows.terminated, count, 0, self);
            out["truncated"] = ViewRows(rows.truncated, count, 0, self);
            out["success"] = ViewRows(rows.success, count, 0, self);
            out["was_reset"] = ViewRows(rows.was_reset, count, 0, self);
            return out;
          },
          "Views of the pool's own rows; row i is written while environment i is at work.");
}

}  // namespace

void BindEnvironment(py::module_& module) {
  py::list features;
  for (std::size_t i = 0; i < kFeatureCount; ++i)
    features.append(std::string(environment::NameOf(static_cast<Feature>(i))));
  module.attr("FEATURES") = py::tuple(features);
  module.def("default_weights", [] { return DescribeFeatures(environment::DefaultWeights()); });
  py::class_<EnvironmentModel, std::shared_ptr<EnvironmentModel>>(
      module, "EnvironmentModel", "What all environments of the same settings share.")
      .def(py::init(&MakeModel), py::arg("task"), py::kw_only(), py::arg("level") = "normal",
           py::arg("patient") = "", py::arg("seed") = 1, py::arg("layouts") = 1,
           py::arg("actions") = "joints", py::arg("actions_per_second") = 10.0, py::arg("most_seconds") = 0.0,
           py::arg("moves_camera") = false, py::arg("weights") = std::map<std::string, double>())
      .def_property_readonly("action_fields",
                             [](const EnvironmentModel& m) { return DescribeFields(m.ActionFields()); })
      .def_property_readonly("state_fields",
                             [](const EnvironmentModel& m) { return DescribeFields(m.StateFields()); })
      .def_property_readonly("action_size", &EnvironmentModel::ActionSize)
      .def_property_readonly("state_size", &EnvironmentModel::StateSize)
      .def_property_readonly("ticks_per_action", &EnvironmentModel::TicksPerAction)
      .def_property_readonly("most_seconds",
                             [](const EnvironmentModel& m) { return m.Settings().most_seconds; })
      .def_property_readonly("moves_camera",
                             [](const EnvironmentModel& m) { return m.Settings().moves_camera; });
  py::class_<Environment>(module, "Environment", "One running environment; trocar.make wraps it.")
      .def(py::init([](std::shared_ptr<EnvironmentModel> model) {
             const py::gil_scoped_release release;
             return std::make_unique<Environment>(Take(Environment::Make(std::move(model))));
           }),
           py::arg("model"))
      .def(
          "reset", [](Environment& e, std::optional<std::uint64_t> seed) { Check(e.Reset(seed)); },
          py::arg("seed"), py::call_guard<py::gil_scoped_release>())
      .def(
          "step",
          [](Environment& e, const Row& action) {
            Outcome outcome;
            {
              py::gil_scoped_release release;
              outcome = Take(e.Step(View(action)));
            }
            return py::make_tuple(outcome.reward, outcome.is_terminated, outcome.is_truncated,
                                  outcome.is_success, DescribeFeatures(outcome.features));
          },
          py::arg("action"))
      .def(
          "observe",
          [](const Environment& e, py::array_t<float, py::array::c_style> state) {
            if (static_cast<std::size_t>(state.size()) != e.StateSize())
              throw Failure(
                  {core::ErrorCode::kUsage, "a state has " + std::to_string(e.StateSize()) + " numbers"});
            e.Observe({state.mutable_data(), static_cast<std::size_t>(state.size())});
          },
          py::arg("state").noconvert())
      .def_property_readonly("layout", &Environment::Layout)
      .def_property_readonly("tick",
                             [](const Environment& e) { return e.GetSimulation().GetSnapshot().tick; })
      .def("hash", [](const Environment& e) { return core::HashText(e.GetSimulation().Hash()); });
  BindPool(module);
}

}  // namespace trocar::python
