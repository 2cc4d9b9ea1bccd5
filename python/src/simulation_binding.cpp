// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "binding.h"
#include "forks.h"
#include "running.h"
#include "snapshot_description.h"
#include "trocar/agent/surgeon.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/state_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/threads.h"
#include "trocar/record/input_codec.h"
#include "trocar/scene/procedure.h"
#include "trocar/scene/task.h"

namespace trocar::python {
namespace {

using instrument::kHandCount;
using scene::Input;
using simulation::Simulation;
using simulation::Snapshot;

constexpr std::array<const char*, 4> kCommandNames = {"wait", "retract", "relax", "release"};

std::unique_ptr<Running> MakeRunning(const py::object& task, const std::string& level, std::uint64_t seed,
                                     const py::object& patient, int threads, bool has_metrics,
                                     const std::filesystem::path& folder, bool is_varied) {
  if (threads < 1 || threads > 256)
    throw Failure({base::ErrorCode::kUsage, "a simulation has 1 to 256 threads"});
  if (threads > 1) ExpectThreadsOfLibraries();
  const SceneSource source = ReadSceneSource(task, folder);
  PatientSource given(patient);
  const py::gil_scoped_release release;
  auto scene =
      std::make_shared<const scene::Scene>(Take(FindScene(source, {level, seed, given.Folder(), is_varied})));
  auto simulation = Take(Simulation::Make(scene, {.threads = host::UseThreads(threads)}));
  auto running = std::make_unique<Running>(
      Running{std::move(scene), std::move(simulation), std::move(given), std::nullopt});
  if (has_metrics) running->attempt.emplace(running->simulation);
  return running;
}

// --- input

using Row = py::array_t<double, py::array::c_style | py::array::forcecast>;

instrument::TrocarJoints ToJoints(const double* at) {
  return {at[0], at[1], at[2], at[3], at[4]};
}

void CheckNumbers(const Row& row, py::ssize_t count, const char* what) {
  if (row.size() != count) {
    throw Failure({base::ErrorCode::kActionInvalid, std::string(what) + " are " + std::to_string(count) +
                                                        " numbers, not " + std::to_string(row.size())});
  }
  for (py::ssize_t i = 0; i < count; ++i) {
    if (!std::isfinite(row.data()[i]))
      throw Failure(
          {base::ErrorCode::kActionInvalid, std::string(what) + " hold a number that is NaN or infinite"});
  }
}

template <bool scene::HandControls::*kMember>
void BindPedal(py::class_<Input>& type, const char* name, const char* about) {
  type.def_property(
      name,
      [](const Input& input) {
        return py::make_tuple(input.controls[0].*kMember, input.controls[1].*kMember);
      },
      [](Input& input, const std::array<bool, kHandCount>& on) {
        for (int hand = 0; hand < kHandCount; ++hand) input.controls[hand].*kMember = on[hand];
      },
      about);
}

void BindInput(py::module_& module) {
  py::class_<Input> type(module, "Input",
                         "What reaches one tick from outside: hands, pedals, camera, assistant.");
  type.def_property(
          "hands",
          [](const Input& input) {
            py::array_t<double> array({kHandCount, 5});
            for (int hand = 0; hand < kHandCount; ++hand)
              FromJoints(input.hands[hand], array.mutable_data(hand));
            return array;
          },
          [](Input& input, const Row& rows) {
            CheckNumbers(rows, 5 * kHandCount, "the joints of both hands");
            for (int hand = 0; hand < kHandCount; ++hand)
              input.hands[hand] = ToJoints(rows.data() + 5 * hand);
          },
          "(2, 5) pan, tilt, spin [rad], depth [m], jaw [rad] of the left and the right hand. Assign the "
          "whole array.")
      .def_property(
          "laparoscope",
          [](const Input& input) {
            py::array_t<double> array(5);
            FromJoints(input.laparoscope, array.mutable_data());
            return array;
          },
          [](Input& input, const Row& row) {
            CheckNumbers(row, 5, "the joints of the laparoscope");
            input.laparoscope = ToJoints(row.data());
          },
          "(5) pan, tilt, spin of the light post [rad], depth [m]; the last is not used. Assign the whole "
          "array.")
      .def_property(
          "tools",
          [](const Input& input) { return py::make_tuple(input.controls[0].tool, input.controls[1].tool); },
          [](Input& input, const std::array<std::uint8_t, kHandCount>& tools) {
            for (int hand = 0; hand < kHandCount; ++hand) input.controls[hand].tool = tools[hand];
          },
          "(2) wanted tool of each hand, by its place in Simulation.trays.")
      .def_property(
          "assistant",
          [](const Input& input) { return kCommandNames[static_cast<std::size_t>(input.assistant)]; },
          [](Input& input, const std::string& command) {
            for (std::size_t i = 0; i < kCommandNames.size(); ++i) {
              if (command != kCommandNames[i]) continue;
              input.assistant = static_cast<scene::AssistantCommand>(i);
              return;
            }
            throw Failure({base::ErrorCode::kUnknownName, "the assistant knows no \"" + command +
                                                              "\"; say wait, retract, relax or release"});
          },
          "\"wait\", \"retract\", \"relax\" or \"release\".")
      .def_property(
          "holds_camera", [](const Input& input) { return input.settings.holds_camera; },
          [](Input& input, bool holds) { input.settings.holds_camera = holds; },
          "The automatic holder moves the laparoscope.")
      .def(
          "copy", [](const Input& input) { return input; }, "Another one with the same values.")
      .def("__eq__", [](const Input& a, const Input& b) { return a == b; })
      .def(py::pickle(
          [](const Input& input) {
            std::vector<std::byte> bytes;
            record::InputEncoder().Encode(input, bytes);
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          [](const py::bytes& encoded) {
            const std::string_view view = encoded;
            std::span bytes = std::as_bytes(std::span(view.data(), view.size()));
            Input input;
            if (!record::InputDecoder().Decode(bytes, input) || !bytes.empty())
              throw Failure(
                  {base::ErrorCode::kRecordingInvalid, "these bytes are no Input; pickle it again"});
            return input;
          }));
  BindPedal<&scene::HandControls::cut>(type, "cut", "(2) yellow pedal of each hand.");
  BindPedal<&scene::HandControls::coagulate>(type, "coagulate", "(2) blue pedal of each hand.");
  BindPedal<&scene::HandControls::rinse>(type, "rinse", "(2) irrigation of each hand.");
  BindPedal<&scene::HandControls::aspirate>(type, "aspirate", "(2) suction of each hand.");
}

// --- what happened

py::list DescribeEvents(const Running& running, std::uint64_t since) {
  const Snapshot& now = running.simulation.GetSnapshot();
  py::list out;
  const std::uint64_t oldest =
      now.event_count > simulation::kEventRing ? now.event_count - simulation::kEventRing : 0;
  for (std::uint64_t n = std::max(since, oldest); n < now.event_count; ++n) {
    const scene::Event& event = now.events[n % simulation::kEventRing];
    py::dict entry;
    entry["event"] = std::string(surgery::FactName(event.kind));
    entry["tick"] = event.tick;
    entry["hand"] =
        event.hand < 0 ? py::object(py::none()) : py::str(kHandNames[static_cast<std::size_t>(event.hand)]);
    entry["surface"] = SurfaceName(running.simulation, event.organ);
    entry["object"] = ObjectName(running.simulation, event.object);
    entry["force"] = event.force;
    const surgery::ErrorRow* error =
        scene::FindError(scene::ProcedureOf(running.simulation.GetScene()), event.error);
    entry["error"] = error == nullptr ? py::object(py::none()) : py::str(std::string(error->name));
    out.append(entry);
  }
  return out;
}

py::object DescribeCriticalView(const Running& running) {
  const auto result = running.simulation.GetOperationResult();
  if (!result) return py::none();
  py::dict out;
  const scene::ProcedureResult& judged = result->procedure;
  out["criteria"] = std::vector<int>(judged.now.view.criteria.begin(), judged.now.view.criteria.end());
  out["score"] = judged.now.view.Sum();
  out["is_achieved"] = judged.now.view.IsAchieved();
  out["was_achieved"] = judged.was_view_achieved;
  out["is_seen_from_front"] = judged.now.view.IsSeen(0);
  out["is_seen_from_behind"] = judged.now.view.IsSeen(1);
  out["missing"] = judged.missing;
  return out;
}

py::list DescribeErrors(const Running& running) {
  py::list out;
  if (const auto result = running.simulation.GetOperationResult()) {
    const surgery::ErrorLog& log = result->procedure.errors;
    for (const surgery::ErrorEntry& error : log.Entries()) {
      const surgery::ErrorRow& row = log.RowOf(error);
      py::dict entry;
      entry["error"] = std::string(row.name);
      entry["about"] = std::string(row.explanation);
      entry["severity"] = std::string(surgery::NameOf(row.severity));
      entry["time"] = error.time;
      entry["place"] = ToArray(error.place);
      entry["hand"] = error.hand < 0
                          ? py::object(py::none())
                          : py::str(error.hand < kHandCount ? kHandNames[static_cast<std::size_t>(error.hand)]
                                                            : "assistant");
      out.append(entry);
    }
  }
  return out;
}

py::object DescribeMetrics(const Running& running) {
  if (!running.attempt) {
    throw Failure({base::ErrorCode::kEnvironmentState,
                   "the metrics are not collected; make the simulation with metrics=True"});
  }
  return running.attempt->Describe();
}

py::list DescribeSurfaces(const Running& running) {
  py::list out;
  for (const scene::SurfaceInfo& surface : running.simulation.Surfaces()) {
    py::dict entry;
    entry["name"] = surface.name;
    entry["first_node"] = surface.first_node;
    entry["node_count"] = surface.node_count;
    py::array_t<std::uint32_t> triangles(
        {static_cast<py::ssize_t>(surface.triangles.size()), py::ssize_t{3}});
    auto at = triangles.mutable_unchecked<2>();
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        at(static_cast<py::ssize_t>(i), k) = surface.triangles[i][static_cast<std::size_t>(k)];
    }
    entry["triangles"] = triangles;
    out.append(entry);
  }
  return out;
}

/// So many ticks, without the GIL; Ctrl-C ends them between two.
/// \param step  false ends them, too \return how many there were
template <typename Step>
int RunTicks(int ticks, const Step& step) {
  constexpr int kTicksBetweenLooks = 60;
  const py::gil_scoped_release release;
  for (int done = 0; done < ticks; ++done) {
    if (!step()) return done;
    if (done % kTicksBetweenLooks != kTicksBetweenLooks - 1) continue;
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return std::max(ticks, 0);
}

void BindRunning(py::module_& module) {
  py::class_<Running>(
      module, "Simulation",
      "One running surgery. A call that finds another one in the middle of its work fails with E-ENV-002.")
      .def(py::init(&MakeRunning), py::arg("task"), py::kw_only(), py::arg("level") = "normal",
           py::arg("seed") = 1, py::arg("patient") = "", py::arg("threads") = 1, py::arg("metrics") = false,
           py::arg("folder") = "", py::arg("varied") = false,
           "`task` is a task's key, \"cholecystectomy\", a file, or a dictionary as such a file holds, whose "
           "relative paths start from `folder`; `patient` a folder, or {\"seed\": 5, \"set\": {...}}. With "
           "`metrics` each tick is collected for metrics(). With `varied` the seed also decides what a task "
           "lets "
           "vary, as in environments.")
      .def_property_readonly("name", [](const Running& r) { return r.scene->name; })
      .def_property_readonly(
          "tick_seconds", [](const Running& r) { return r.scene->tick_seconds; }, "[s]")
      .def_property_readonly("tick", [](const Running& r) { return r.simulation.GetSnapshot().tick; })
      .def_property_readonly(
          "time", [](const Running& r) { return r.simulation.GetSnapshot().time; }, "[s]")
      .def_property_readonly(
          "trays",
          [](const Running& r) {
            std::array<std::vector<std::string>, kHandCount> trays;
            for (int hand = 0; hand < kHandCount; ++hand) {
              for (const instrument::Tool& tool : r.scene->instruments[hand].tray)
                trays[hand].push_back(tool.name);
            }
            return py::make_tuple(trays[0], trays[1]);
          },
          "Names of the tools of each hand.")
      .def(
          "home", [](const Running& r) { return scene::CalcScriptInput(*r.scene, 0); },
          "Hands and camera where the scene begins.")
      .def(
          "script_input",
          [](const Running& r) { return scene::CalcScriptInput(*r.scene, r.simulation.GetSnapshot().time); },
          "What the scene's own script does in the next tick.")
      .def(
          "step",
          [](Running& r, const Input& input, int ticks) {
            if (ticks < 0) throw Failure({base::ErrorCode::kUsage, "a number of ticks is not negative"});
            RunTicks(ticks, [&] {
              r.Step(input);
              return true;
            });
          },
          py::arg("input"), py::arg("ticks") = 1, "Goes on by `ticks` ticks with the same input.")
      .def(
          "step_script",
          [](Running& r, int ticks) {
            RunTicks(ticks, [&] {
              r.Step(scene::CalcScriptInput(*r.scene, r.simulation.GetSnapshot().time));
              return true;
            });
          },
          py::arg("ticks") = 1, "Goes on as the scene's own script says.")
      .def(
          "reset",
          [](Running& r) {
            const py::gil_scoped_release release;
            r.simulation.Reset();
            r.BeginAttempt();
          },
          "Back to the first tick.")
      .def(
          "snapshot", [](const Running& r) { return DescribeSnapshot(r.simulation); },
          "What the last tick published, copied: SI units, world frame.")
      .def(
          "positions",
          [](const Running& r) { return ToArray(std::span(r.simulation.GetSnapshot().positions)); },
          "(nodes, 3) of organs, then of ducts and vessels, world frame [m]; a copy.")
      .def("surfaces", &DescribeSurfaces,
           "Which rows of positions() are which organ, duct or vessel; triangles at rest.")
      .def("events", &DescribeEvents, py::arg("since") = 0,
           "The newest events, at most eight, from number `since` on; event_count numbers them.")
      .def_property_readonly("event_count",
                             [](const Running& r) { return r.simulation.GetSnapshot().event_count; })
      .def("critical_view", &DescribeCriticalView,
           "Criteria of the critical view and what is missing; None in a task.")
      .def("errors", &DescribeErrors, "Errors of an operation so far, in their order.")
      .def("metrics", &DescribeMetrics,
           "What the attempt came to so far, since the simulation was made, reset or restored: {\"metric\", "
           "\"value\", \"unit\"}, of a part also \"hand\", \"phase\", \"tool\". docs/metrics.md says what "
           "each is. Wants metrics=True.")
      .def(
          "save",
          [](const Running& r) {
            std::vector<std::byte> bytes;
            r.simulation.Save(bytes);
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          "The state as bytes.")
      .def(
          "restore",
          [](Running& r, const py::bytes& bytes) {
            const std::string_view view = bytes;
            Check(r.simulation.Restore(std::as_bytes(std::span(view.data(), view.size()))));
            r.BeginAttempt();
          },
          py::arg("state"), "Takes up a saved state of the same model.")
      .def(
          "save_file",
          [](const Running& r, const std::filesystem::path& path) {
            Check(files::WriteStateFile(path, r.simulation));
          },
          py::arg("path"), "As `trocar simulate --save`.")
      .def(
          "restore_file",
          [](Running& r, const std::filesystem::path& path) {
            (void)Take(files::ReadStateFile(path, r.simulation));
            r.BeginAttempt();
          },
          py::arg("path"), "As `trocar simulate --restore`.")
      .def(
          "hash", [](const Running& r) { return base::HashText(r.simulation.Hash()); },
          "Fingerprint of the state, as the commands print it.")
      .def(
          "play",
          [](Running& r, agent::Surgeon& surgeon, int ticks) {
            return RunTicks(ticks, [&] {
              if (surgeon.HasFinished()) return false;
              r.Step(surgeon.Act(r.simulation.GetSnapshot()));
              return true;
            });
          },
          py::arg("surgeon"), py::arg("ticks"),
          "Lets a scripted surgeon go on for at most `ticks` ticks; returns how many it took.");
}

void BindSurgeon(py::module_& module) {
  py::class_<agent::Surgeon>(module, "Surgeon", "A scripted surgeon of one simulation's scene.")
      .def(py::init([](const std::string& name, const Running& r, std::uint64_t seed) {
             return Take(agent::MakeSurgeon(name, r.scene, seed));
           }),
           py::arg("name"), py::arg("simulation"), py::arg("seed") = 1)
      .def(
          "act", [](agent::Surgeon& s, const Running& r) { return s.Act(r.simulation.GetSnapshot()); },
          py::arg("simulation"), "The input of the next tick.")
      .def_property_readonly("has_finished", &agent::Surgeon::HasFinished)
      .def_property_readonly("doing", [](const agent::Surgeon& s) { return std::string(s.Doing()); });
}

}  // namespace

void BindSimulation(py::module_& module) {
  BindInput(module);
  BindRunning(module);
  BindSurgeon(module);
  module.def(
      "tasks",
      [] {
        py::dict out;
        for (const files::TaskEntry& task : Take(files::ListTasks())) {
          py::dict entry;
          entry["name"] = task.name;
          entry["about"] = task.about;
          entry["levels"] = task.levels;
          out[py::str(task.key)] = entry;
        }
        return out;
      },
      "The delivered tasks by key.");
  module.def(
      "set_data_folder", [](const std::filesystem::path& folder) { host::SetDataFolder(folder); },
      py::arg("folder"), "Where the delivered files are, unless TROCAR_DATA_DIR names another place.");
  module.def(
      "find",
      [](const std::string& name) {
        const auto data = Take(host::FindDataFolder());
        const auto path = data / "scenes" / (name + ".json");
        std::error_code ignored;
        return std::filesystem::is_regular_file(path, ignored) ? path : Take(files::FindTask(name));
      },
      py::arg("name"), "File of a delivered task, operation or scene: a dictionary to begin with.");
  module.def(
      "surgeons",
      [](const Running& running) {
        py::dict out;
        for (const agent::SurgeonEntry& entry : agent::ListSurgeons()) {
          if (entry.suits(*running.scene)) out[entry.name] = entry.about;
        }
        return out;
      },
      py::arg("simulation"), "Scripted surgeons that can do a simulation's scene, and what each is.");
}

}  // namespace trocar::python
