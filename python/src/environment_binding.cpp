// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "binding.h"
#include "camera.h"
#include "contact_rows.h"
#include "drawn_pool.h"
#include "running.h"
#include "scene_source.h"
#include "snapshot_description.h"
#include "trocar/agent/taking_over.h"
#include "trocar/base/state_hash.h"
#include "trocar/environment/pool.h"

namespace trocar::python {
namespace {

using environment::Environment;
using environment::EnvironmentModel;
using environment::EnvironmentSettings;
using environment::Feature;
using environment::kFeatureCount;
using environment::kVariedCount;
using environment::Outcome;
using environment::Pool;
using environment::Varied;

using Row = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ids = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

std::span<const double> View(const Row& row) {
  return {row.data(), static_cast<std::size_t>(row.size())};
}
std::span<const std::int32_t> View(const Ids& ids) {
  return {ids.data(), static_cast<std::size_t>(ids.size())};
}

/// Weights by name over the usual ones.
environment::Features ReadWeights(const py::dict& named) {
  environment::Features weights = environment::DefaultWeights();
  for (const auto& [key, weight] : ToPlain(named, "weights")) {
    const std::string name = py::str(key);
    std::size_t i = 0;
    while (i < kFeatureCount && environment::NameOf(static_cast<Feature>(i)) != name) ++i;
    if (i == kFeatureCount) {
      std::string known;
      for (std::size_t k = 0; k < kFeatureCount; ++k)
        known += (k == 0 ? "" : ", ") + std::string(environment::NameOf(static_cast<Feature>(k)));
      throw Failure(
          {base::ErrorCode::kUnknownName, "a reward has no feature \"" + name + "\"; there are " + known});
    }
    if (!py::isinstance<py::float_>(weight) && !py::isinstance<py::int_>(weight)) {
      throw Failure({base::ErrorCode::kUsage,
                     "weights." + name + " is " + std::string(py::repr(weight)) + "; a weight is a number"});
    }
    weights[i] = weight.cast<double>();
  }
  return weights;
}

/// By name over what is there: a number, or (low, high); None takes back what `usual` says.
environment::Ranges ReadRanges(const py::dict& named, environment::Ranges ranges,
                               const environment::Ranges& usual) {
  for (const auto& [key, given] : ToPlain(named, "ranges")) {
    const std::string name = py::str(key);
    std::size_t i = 0;
    while (i < kVariedCount && environment::NameOf(static_cast<Varied>(i)) != name) ++i;
    if (i == kVariedCount) {
      std::string known;
      for (std::size_t k = 0; k < kVariedCount; ++k)
        known += (k == 0 ? "" : ", ") + std::string(environment::NameOf(static_cast<Varied>(k)));
      throw Failure({base::ErrorCode::kUnknownName,
                     "nothing that varies is called \"" + name + "\"; there are " + known});
    }
    const auto is_number = [](const py::handle& value) {
      return py::isinstance<py::float_>(value) ||
             (py::isinstance<py::int_>(value) && !py::isinstance<py::bool_>(value));
    };
    if (given.is_none()) {
      ranges[i] = usual[i];
    } else if (is_number(given)) {
      ranges[i] = {given.cast<double>(), given.cast<double>()};
    } else if (py::isinstance<py::list>(given) && py::len(given) == 2 && is_number(given[py::int_(0)]) &&
               is_number(given[py::int_(1)])) {
      ranges[i] = {given[py::int_(0)].cast<double>(), given[py::int_(1)].cast<double>()};
    } else {
      throw Failure({base::ErrorCode::kUsage, "the range of " + name + " is " + std::string(py::repr(given)) +
                                                  "; give a number, or the lower and the higher one"});
    }
  }
  return ranges;
}

py::dict DescribeDrawn(const std::array<double, kVariedCount>& values) {
  py::dict out;
  for (std::size_t i = 0; i < kVariedCount; ++i)
    out[py::str(std::string(environment::NameOf(static_cast<Varied>(i))))] = values[i];
  return out;
}

/// With the ranges that an environment is made with.
const environment::Ranges& UsualOf(const EnvironmentModel& model) {
  return *model.Settings().ranges;
}

bool FindActionErrors(const std::string& name) {
  if (name != "raise" && name != "clip") {
    throw Failure({base::ErrorCode::kUnknownName,
                   "there is no way \"" + name + "\" with actions out of range; choose raise or clip"});
  }
  return name == "clip";
}

std::shared_ptr<EnvironmentModel> MakeModel(const py::object& task, const std::string& level,
                                            const py::object& patient, std::uint64_t seed, int layouts,
                                            const std::string& actions, double actions_per_second,
                                            double most_seconds, bool moves_camera, const py::dict& weights,
                                            const std::filesystem::path& folder, int models,
                                            const py::dict& ranges, const std::string& action_errors) {
  const auto kind = environment::FindActionKind(actions);
  if (!kind) {
    throw Failure({base::ErrorCode::kUnknownName,
                   "there is no kind of actions \"" + actions + "\"; choose joints, tip or discrete"});
  }
  const SceneSource source = ReadSceneSource(task, folder);
  std::vector<PatientSource> given;
  if (py::isinstance<py::list>(patient)) {
    for (const py::handle& one : patient) given.emplace_back(py::reinterpret_borrow<py::object>(one));
  } else {
    given.emplace_back(patient);
  }
  EnvironmentSettings settings;
  settings.task = source.name;
  settings.level = level;
  for (const PatientSource& one : given) {
    if (!one.Folder().empty() || given.size() > 1) settings.patients.push_back(one.Folder());
  }
  settings.seed = seed;
  settings.layouts = layouts;
  settings.models = models;
  const environment::Ranges usual = layouts > 0 ? environment::StandardRanges() : environment::UsualRanges();
  settings.ranges = ReadRanges(ranges, usual, usual);
  settings.actions = *kind;
  settings.actions_per_second = actions_per_second;
  settings.most_seconds = most_seconds;
  settings.moves_camera = moves_camera;
  settings.clips_actions = FindActionErrors(action_errors);
  settings.weights = ReadWeights(weights);
  settings.document = source.document;
  const py::gil_scoped_release release;
  auto model = Take(EnvironmentModel::Make(settings));
  // layouts are read when they are asked for, from the patient's folder
  EnvironmentModel* made = model.get();
  return {made, [held = std::move(model), given = std::move(given)](EnvironmentModel*) {}};
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

py::tuple DescribeOutcome(const Outcome& outcome) {
  return py::make_tuple(outcome.reward, outcome.is_terminated, outcome.is_truncated, outcome.is_success,
                        DescribeFeatures(outcome.features));
}

/// Goes on from where hands and picture are: at first where an episode begins.
std::unique_ptr<agent::Surgeon> MakeSurgeon(const RunningEnvironment& running, const std::string& name,
                                            std::uint64_t seed) {
  const simulation::Simulation& simulation = running.Simulation();
  return Take(agent::MakeSurgeonTakingOver(name, simulation.GetScene(), simulation.GetSnapshot(), seed));
}

environment::Autoreset FindAutoreset(const std::string& name) {
  if (name == "NextStep") return environment::Autoreset::kNextStep;
  if (name == "SameStep") return environment::Autoreset::kSameStep;
  if (name == "Disabled") return environment::Autoreset::kDisabled;
  throw Failure({base::ErrorCode::kUnknownName,
                 "there is no autoreset mode \"" + name + "\"; choose NextStep, SameStep or Disabled"});
}

PoolPictures::Parts FindParts(const std::vector<std::string>& names) {
  PoolPictures::Parts parts;
  for (const std::string& name : names) {
    if (name == "picture") {
      parts.has_picture = true;
    } else if (name == "depth") {
      parts.has_depth = true;
    } else if (name == "masks") {
      parts.has_masks = true;
    } else if (name == "normals") {
      parts.has_normals = true;
    } else if (name == "contacts") {
      parts.has_contacts = true;
    } else {
      throw Failure({base::ErrorCode::kUnknownName,
                     "a pool draws no \"" + name + "\"; choose picture, depth, masks, normals or contacts"});
    }
  }
  return parts;
}

std::unique_ptr<DrawnPool> MakePool(std::shared_ptr<EnvironmentModel> model, int count, int threads,
                                    const std::string& autoreset, std::uint64_t seed,
                                    const std::vector<std::string>& drawn, int width, int height) {
  const environment::Autoreset mode = FindAutoreset(autoreset);
  const PoolPictures::Parts parts = FindParts(drawn);
  const py::gil_scoped_release release;
  auto made = std::make_unique<DrawnPool>();
  environment::PoolSettings settings{count, threads, mode, seed, {}};
  if (!drawn.empty()) {
    // before all memory is taken: the size may be wrong, and there may be no graphics
    if (parts.IsDrawn()) (void)Take(Camera::Make(width, height));
    if (count < 1 || count > environment::kMostEnvironments)
      throw Failure({base::ErrorCode::kUsage, "a pool has 1 to 4096 environments"});
    made->pictures = std::make_shared<PoolPictures>(count, width, height, parts);
    settings.observe = [pictures = made->pictures](std::int32_t id, const Environment& environment,
                                                   bool is_final) {
      return pictures->Observe(id, environment, is_final);
    };
  }
  made->pool = Take(Pool::Make(std::move(model), settings));
  return made;
}

/// A read-only view of memory that `owner` keeps alive.
template <typename T>
py::array ViewRows(const std::vector<T>& all, const std::vector<py::ssize_t>& shape,
                   const py::object& owner) {
  py::array_t<T> view(shape, all.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

void ViewPictures(const PoolPictures& pictures, py::ssize_t count, const py::object& owner, py::dict& out) {
  const py::ssize_t h = pictures.Height(), w = pictures.Width();
  const auto view = [&](const std::string& prefix, const PoolPictures::Rows& rows) {
    const auto key = [&](const char* name) { return py::str(prefix + name); };
    const PoolPictures::Parts& parts = pictures.GetParts();
    if (parts.has_picture) out[key("picture")] = ViewRows(rows.picture, {count, h, w, 3}, owner);
    if (parts.has_depth) out[key("depth")] = ViewRows(rows.depth, {count, h, w}, owner);
    if (parts.has_masks) out[key("masks")] = ViewRows(rows.masks, {count, h, w}, owner);
    if (parts.has_normals) out[key("normals")] = ViewRows(rows.normals, {count, h, w, 3}, owner);
    if (parts.has_contacts) {
      out[key("contacts")] =
          ViewRows(rows.contacts, {count, py::ssize_t{kContactRows}, py::ssize_t{kContactNumbers}}, owner);
    }
  };
  view("", pictures.Now());
  view("final_", pictures.Final());
}

py::dict ViewPool(const DrawnPool& drawn) {
  const py::object self = py::cast(&drawn);  // the object there is, which the views keep alive
  const auto& rows = drawn.pool->Rows();
  const auto count = static_cast<py::ssize_t>(drawn.pool->Count());
  const auto size = static_cast<py::ssize_t>(drawn.pool->Model().StateSize());
  py::dict out;
  out["state"] = ViewRows(rows.state, {count, size}, self);
  out["final_state"] = ViewRows(rows.final_state, {count, size}, self);
  out["reward"] = ViewRows(rows.reward, {count}, self);
  out["features"] = ViewRows(rows.features, {count, static_cast<py::ssize_t>(kFeatureCount)}, self);
  out["terminated"] = ViewRows(rows.terminated, {count}, self);
  out["truncated"] = ViewRows(rows.truncated, {count}, self);
  out["success"] = ViewRows(rows.success, {count}, self);
  out["was_reset"] = ViewRows(rows.was_reset, {count}, self);
  out["layout"] = ViewRows(rows.layout, {count}, self);
  out["episode_seed"] = ViewRows(rows.episode_seed, {count}, self);
  if (drawn.pictures) ViewPictures(*drawn.pictures, count, self, out);
  return out;
}

void BindPool(py::module_& module) {
  py::class_<DrawnPool>(module, "Pool", "Environments of one model that threads of the pool's own step.")
      .def(py::init(&MakePool), py::arg("model"), py::kw_only(), py::arg("count"), py::arg("threads") = 0,
           py::arg("autoreset") = "NextStep", py::arg("seed") = 1,
           py::arg("drawn") = std::vector<std::string>(), py::arg("width") = 84, py::arg("height") = 84)
      .def_property_readonly("count", [](const DrawnPool& p) { return p.pool->Count(); })
      .def_property_readonly("threads", [](const DrawnPool& p) { return p.pool->ThreadCount(); })
      .def_property_readonly("at_work", [](const DrawnPool& p) { return p.pool->AtWork(); })
      .def(
          "reset",
          [](DrawnPool& p, const Ids& ids, const std::vector<std::optional<std::uint64_t>>& seeds) {
            Check(p.pool->ResetEach(View(ids), seeds));
          },
          py::arg("ids"), py::arg("seeds"))
      .def(
          "send",
          [](DrawnPool& p, const Row& actions, const Ids& ids) {
            Check(p.pool->Send(View(actions), View(ids)));
          },
          py::arg("actions"), py::arg("ids"))
      .def(
          "receive",
          [](DrawnPool& p, std::size_t count) {
            std::vector<std::int32_t> ids;
            {
              py::gil_scoped_release release;
              Check(p.pool->Receive(count, ids));
            }
            return py::array_t<std::int32_t>(static_cast<py::ssize_t>(ids.size()), ids.data());
          },
          py::arg("count"))
      .def(
          "set_ranges",
          [](DrawnPool& p, const Ids& ids, const py::dict& ranges) {
            const EnvironmentModel& model = p.pool->Model();
            for (const std::int32_t id : View(ids)) {
              const environment::Ranges now = Take(p.pool->Look(id))->GetRanges();
              Check(p.pool->SetRanges(std::span(&id, 1), ReadRanges(ranges, now, UsualOf(model))));
            }
          },
          py::arg("ids"), py::arg("ranges"))
      .def(
          "drawn",
          [](const DrawnPool& p, std::int32_t id) { return DescribeDrawn(Take(p.pool->Look(id))->Drawn()); },
          py::arg("id"))
      .def("rows", &ViewPool,
           "Views of the pool's own rows; row i is written while environment i is at work.");
}

void BindRunningEnvironment(py::module_& module) {
  py::class_<RunningEnvironment>(module, "Environment", "One running environment; trocar.make wraps it.")
      .def(py::init([](std::shared_ptr<EnvironmentModel> model, bool metrics) {
             const py::gil_scoped_release release;
             return std::make_unique<RunningEnvironment>(Take(Environment::Make(std::move(model))), metrics);
           }),
           py::arg("model"), py::arg("metrics") = false)
      .def(
          "reset",
          [](RunningEnvironment& r, std::optional<std::uint64_t> seed) {
            const py::gil_scoped_release release;
            Check(r.environment.Reset(seed));
          },
          py::arg("seed"))
      .def(
          "step",
          [](RunningEnvironment& r, const Row& action) {
            // a copy, because the array may be another thread's as well
            const std::vector<double> numbers(action.data(), action.data() + action.size());
            Outcome outcome;
            {
              const py::gil_scoped_release release;
              outcome = Take(r.environment.Step(numbers));
            }
            return DescribeOutcome(outcome);
          },
          py::arg("action"))
      .def("surgeon", &MakeSurgeon, py::arg("name"), py::arg("seed") = 1)
      .def(
          "step_by",
          [](RunningEnvironment& r, agent::Surgeon& surgeon, py::array_t<double, py::array::c_style> action) {
            Environment& e = r.environment;
            if (static_cast<std::size_t>(action.size()) != e.ActionSize())
              throw Failure(
                  {base::ErrorCode::kUsage, "an action has " + std::to_string(e.ActionSize()) + " numbers"});
            std::vector<double> written(e.ActionSize());
            Outcome outcome;
            {
              const py::gil_scoped_release release;
              outcome = Take(
                  e.StepBy([&](const simulation::Snapshot& seen) { return surgeon.Act(seen); }, written));
            }
            std::copy(written.begin(), written.end(), action.mutable_data());
            return DescribeOutcome(outcome);
          },
          py::arg("surgeon"), py::arg("action").noconvert())
      .def(
          "observe",
          [](const RunningEnvironment& r, py::array_t<float, py::array::c_style> state) {
            const Environment& e = r.environment;
            if (static_cast<std::size_t>(state.size()) != e.StateSize())
              throw Failure(
                  {base::ErrorCode::kUsage, "a state has " + std::to_string(e.StateSize()) + " numbers"});
            e.Observe({state.mutable_data(), static_cast<std::size_t>(state.size())});
          },
          py::arg("state").noconvert())
      .def("metrics",
           [](const RunningEnvironment& r) {
             if (r.attempt == nullptr) {
               throw Failure({base::ErrorCode::kEnvironmentState,
                              "the metrics are not collected; make the environment with metrics=True"});
             }
             return r.attempt->Describe();
           })
      .def(
          "set_ranges",
          [](RunningEnvironment& r, const EnvironmentModel& model, const py::dict& ranges) {
            Check(r.environment.SetRanges(ReadRanges(ranges, r.environment.GetRanges(), UsualOf(model))));
          },
          py::arg("model"), py::arg("ranges"))
      .def("drawn", [](const RunningEnvironment& r) { return DescribeDrawn(r.environment.Drawn()); })
      .def("save",
           [](RunningEnvironment& r) {
             std::vector<std::byte> bytes;
             {
               const py::gil_scoped_release release;
               r.environment.Save(bytes);
             }
             return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
           })
      .def(
          "restore",
          [](RunningEnvironment& r, const py::bytes& state) {
            const std::string_view view = state;
            const py::gil_scoped_release release;
            Check(r.environment.Restore(std::as_bytes(std::span(view.data(), view.size()))));
          },
          py::arg("state"))
      .def("clone",
           [](RunningEnvironment& r) {
             const py::gil_scoped_release release;
             return std::make_unique<RunningEnvironment>(Take(r.environment.Clone()), r.attempt != nullptr);
           })
      .def("snapshot", [](const RunningEnvironment& r) { return DescribeSnapshot(r.Simulation()); })
      .def("contacts",
           [](const RunningEnvironment& r) {
             py::array_t<float> rows({py::ssize_t{kContactRows}, py::ssize_t{kContactNumbers}});
             WriteContacts(r.Simulation(), {rows.mutable_data(), static_cast<std::size_t>(rows.size())});
             return rows;
           })
      .def_property_readonly("episode_seed",
                             [](const RunningEnvironment& r) { return r.environment.EpisodeSeed(); })
      .def_property_readonly("layout", [](const RunningEnvironment& r) { return r.environment.Layout(); })
      .def_property_readonly("tick",
                             [](const RunningEnvironment& r) { return r.Simulation().GetSnapshot().tick; })
      .def("hash", [](const RunningEnvironment& r) { return base::HashText(r.Simulation().Hash()); });
}

}  // namespace

void BindEnvironment(py::module_& module) {
  py::list features;
  for (std::size_t i = 0; i < kFeatureCount; ++i)
    features.append(std::string(environment::NameOf(static_cast<Feature>(i))));
  module.attr("FEATURES") = py::tuple(features);
  module.attr("CONTACT_ROWS") = kContactRows;
  py::dict ranges;
  for (std::size_t i = 0; i < kVariedCount; ++i) {
    const environment::Range limits = environment::LimitsOf(static_cast<Varied>(i));
    ranges[py::str(std::string(environment::NameOf(static_cast<Varied>(i))))] =
        py::make_tuple(limits.low, limits.high);
  }
  module.attr("RANGES") = ranges;
  module.def("default_weights", [] { return DescribeFeatures(environment::DefaultWeights()); });
  py::class_<EnvironmentModel, std::shared_ptr<EnvironmentModel>>(
      module, "EnvironmentModel", "What all environments of the same settings share.")
      .def(py::init(&MakeModel), py::arg("task"), py::kw_only(), py::arg("level") = "normal",
           py::arg("patient") = "", py::arg("seed") = 1, py::arg("layouts") = 0,
           py::arg("actions") = "joints", py::arg("actions_per_second") = 10.0, py::arg("most_seconds") = 0.0,
           py::arg("moves_camera") = false, py::arg("weights") = py::dict(), py::arg("folder") = "",
           py::arg("models") = 0, py::arg("ranges") = py::dict(), py::arg("action_errors") = "raise")
      .def_property_readonly("state_bounds",
                             [](const EnvironmentModel& m) {
                               const auto size = static_cast<py::ssize_t>(m.StateSize());
                               py::array_t<float> bounds({py::ssize_t{2}, size});
                               std::copy(m.StateLow().begin(), m.StateLow().end(), bounds.mutable_data());
                               std::copy(m.StateHigh().begin(), m.StateHigh().end(),
                                         bounds.mutable_data() + size);
                               return bounds;
                             })
      .def_property_readonly("layouts", [](const EnvironmentModel& m) { return m.Settings().layouts; })
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
  BindRunningEnvironment(module);
  BindPool(module);
}

}  // namespace trocar::python
