// SPDX-License-Identifier: Apache-2.0
#include "snapshot_description.h"

#include <cmath>
#include <string>
#include <vector>

#include "trocar/scene/procedure.h"
#include "trocar/scene/task.h"

namespace trocar::python {

using instrument::kHandCount;
using simulation::Simulation;
using simulation::Snapshot;

void FromJoints(const instrument::TrocarJoints& joints, double* at) {
  at[0] = joints.pan, at[1] = joints.tilt, at[2] = joints.spin, at[3] = joints.depth, at[4] = joints.jaw;
}

py::object SurfaceName(const Simulation& running, std::int32_t surface) {
  if (surface < 0) return py::none();
  return py::str(running.Surfaces()[static_cast<std::size_t>(surface)].name);
}
py::object ObjectName(const Simulation& running, std::int32_t object) {
  if (object < 0) return py::none();
  return py::str(running.GetScene().objects[static_cast<std::size_t>(object)].name);
}

namespace {

py::dict DescribeInstrument(const Simulation& running, int hand) {
  const simulation::InstrumentSnapshot& tool = running.GetSnapshot().instruments[hand];
  py::dict out;
  py::array_t<double> joints(5);
  FromJoints(tool.joints, joints.mutable_data());
  out["pose"] = ToMatrix(tool.X_world_tool);
  out["joints"] = joints;
  out["force"] = ToArray(tool.force);
  out["pinch"] = tool.pinch;
  out["is_grasping"] = tool.is_grasping;
  out["is_touching"] = tool.is_touching;
  out["is_touching_tool"] = tool.is_touching_tool;
  out["surface"] = SurfaceName(running, tool.organ);
  out["object"] = ObjectName(running, tool.object);
  return out;
}

py::dict DescribeTask(const Simulation& running) {
  const Snapshot& now = running.GetSnapshot();
  const scene::Task& task = *running.GetScene().task;
  py::dict out, goals, errors;
  for (std::size_t i = 0; i < task.goals.size(); ++i) {
    py::dict goal;
    goal["is_done"] = now.task.goals[i].is_done;
    goal["is_open"] = now.task.goals[i].is_open;
    goal["steps_done"] = now.task.goals[i].steps_done;
    goal["steps"] = task.goals[i].steps.size();
    goals[py::str(task.goals[i].name)] = goal;
  }
  for (std::size_t i = 0; i < task.errors.size(); ++i)
    errors[py::str(task.errors[i].name)] = now.task.errors[i];
  out["phase"] = std::string(scene::PhaseName(now.task.phase));
  out["is_over"] = now.task.IsOver();
  out["time"] = now.task.time;
  out["score"] = scene::CalcShownScore(task, now.task);
  out["goals"] = goals;
  out["errors"] = errors;
  return out;
}

py::dict DescribeOperation(const Simulation& running) {
  const simulation::OperationSnapshot& now = running.GetSnapshot().operation;
  const auto& fluids = now.flow.ledger.fluids;
  py::dict out;
  const scene::Procedure* procedure = scene::ProcedureOf(running.GetScene());
  out["phase"] = std::string(scene::PhaseName(procedure, now.procedure.phase));
  for (std::size_t row = 0; procedure != nullptr && row < procedure->measures.size(); ++row) {
    const scene::MeasureRow& measure = procedure->measures[row];
    const double value = now.procedure.Measure(row);
    const py::str name{std::string(measure.short_name)};
    if (measure.is_share) {
      out[name] = value;
    } else {
      out[name] = std::lround(value);
    }
  }
  out["is_gallbladder_free"] = now.is_organ_free;
  out["is_in_bag"] = now.is_in_bag;
  out["is_completed"] = now.is_completed;
  out["errors"] = now.errors;
  out["critical_errors"] = now.critical_errors;
  out["clips"] = now.clip_count;
  out["cuts"] = now.tube_cut_count;
  out["blood_ml"] = kMillilitre * fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left;
  out["bile_ml"] = kMillilitre * fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left;
  out["smoke"] = now.smoke;
  return out;
}

py::list DescribeContacts(const Simulation& running) {
  std::vector<simulation::ToolContact> contacts;
  running.FindToolContacts(contacts);
  const scene::Scene& scene = running.GetScene();
  const auto& tools = running.GetSnapshot().operation.tools;
  py::list out;
  for (const simulation::ToolContact& contact : contacts) {
    const auto& tray = scene.instruments[static_cast<std::size_t>(contact.hand)].tray;
    py::dict entry;
    entry["point"] = ToArray(contact.point);
    entry["normal"] = ToArray(contact.normal);
    entry["force"] = ToArray(contact.force);
    entry["hand"] = kHandNames[static_cast<std::size_t>(contact.hand)];
    entry["tool"] = tray.at(tools[contact.hand]).name;
    entry["organ"] = SurfaceName(running, contact.surface);
    entry["object"] = ObjectName(running, contact.object);
    out.append(entry);
  }
  return out;
}

}  // namespace

py::dict DescribeSnapshot(const Simulation& running) {
  const Snapshot& now = running.GetSnapshot();
  py::dict out, instruments, organs, objects;
  for (int hand = 0; hand < kHandCount; ++hand)
    instruments[kHandNames[hand]] = DescribeInstrument(running, hand);
  for (std::size_t i = 0; i < now.organs.size(); ++i) {
    py::dict organ;
    organ["volume"] = now.organs[i].volume;
    organ["pressure"] = now.organs[i].pressure;
    organ["leaked"] = now.organs[i].leaked;
    organs[py::str(running.Surfaces()[i].name)] = organ;
  }
  for (std::size_t i = 0; i < now.objects.size(); ++i) {
    const scene::ObjectSnapshot& object = now.objects[i];
    py::dict entry;
    entry["pose"] = ToMatrix(object.X_world_object);
    entry["velocity"] = ToArray(object.velocity);
    entry["held_by"] = py::make_tuple((object.held_by & 1) != 0, (object.held_by & 2) != 0);
    entry["touched_by"] = py::make_tuple((object.touched_by & 1) != 0, (object.touched_by & 2) != 0);
    entry["is_at_rest"] = object.is_at_rest;
    objects[py::str(running.GetScene().objects[i].name)] = entry;
  }
  out["tick"] = now.tick;
  out["time"] = now.time;
  out["instruments"] = instruments;
  out["organs"] = organs;
  out["objects"] = objects;
  out["task"] = running.GetScene().task ? py::object(DescribeTask(running)) : py::none();
  out["operation"] = running.GetScene().operation ? py::object(DescribeOperation(running)) : py::none();
  out["camera"] = ToMatrix(now.X_world_laparoscope);
  out["contacts"] = DescribeContacts(running);
  out["residual"] = now.residual;
  return out;
}

}  // namespace trocar::python
