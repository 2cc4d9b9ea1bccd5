// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/scene.h"

#include <cmath>
#include <string>

#include "material_file.h"
#include "script.h"
#include "trocar/core/json.h"

namespace trocar::session {
namespace {

constexpr double kDegree = M_PI / 180.0;

Vec3 ReadPoint(const core::JsonView& view, std::string_view key) {
  const auto mm = view.Numbers(key, 3);
  return 0.001 * Vec3{mm[0], mm[1], mm[2]};
}

/// A point [mm], or a landmark with an offset: "target": {"at": "fundus", "offset_mm": [0, 0, 10]}.
Vec3 ReadTarget(const core::JsonView& view, std::string_view key, const anatomy::Patient& patient) {
  const core::JsonView target = view.Object(key);
  target.AllowOnly({"at", "offset_mm"});
  const std::string name = target.Text("at");
  const anatomy::Landmark* landmark = patient.FindLandmark(name);
  if (landmark == nullptr) {
    target.Complain("there is no landmark \"" + name + "\" in the patient", core::ErrorCode::kUnknownName);
    return {};
  }
  return landmark->position + (target.Has("offset_mm") ? ReadPoint(target, "offset_mm") : Vec3{});
}

void ReadInstrument(const core::JsonView& root, const char* hand, const anatomy::Patient& patient,
                    InstrumentSetup& setup) {
  const core::JsonView view = root.Object("instruments").Object(hand);
  view.AllowOnly({"tool", "tray", "port_mm", "tip", "spin_deg", "jaw_deg"});
  const auto add = [&](const std::string& name) {
    if (const instrument::Tool* tool = instrument::FindTool(name); tool != nullptr) {
      setup.tray.push_back(*tool);
    } else {
      view.Complain(
          "there is no tool \"" + name +
              "\"; known are grasper, maryland, hook, scissors, clip_applier, suction_irrigator and bag",
          core::ErrorCode::kUnknownName);
    }
  };
  add(view.Text("tool"));
  if (view.Has("tray")) {
    for (const core::JsonView& name : view.Array("tray")) add(name.AsText());
  }
  if (!setup.tray.empty()) setup.tool = setup.tray.front();
  setup.p_world_port = ReadPoint(view, "port_mm");
  setup.home = instrument::FindJoints(setup.p_world_port, ReadTarget(view, "tip", patient),
                                      view.NumberOr("spin_deg", 0.0) * kDegree,
                                      view.NumberOr("jaw_deg", 0.0, {0.0, 90.0}) * kDegree);
}

void ReadLaparoscope(const core::JsonView& root, const anatomy::Patient& patient, LaparoscopeSetup& setup) {
  const core::JsonView view = root.Object("laparoscope");
  view.AllowOnly({"port_mm", "target", "depth_mm", "view_angle_deg", "post_deg", "field_of_view_deg"});
  setup.p_world_port = ReadPoint(view, "port_mm");
  setup.home = instrument::FindJoints(setup.p_world_port, ReadTarget(view, "target", patient),
                                      view.NumberOr("post_deg", 0.0) * kDegree, 0.0);
  setup.home.depth = 0.001 * view.Number("depth_mm", {10.0, 300.0});
  setup.view_angle = view.NumberOr("view_angle_deg", 0.0, {0.0, 70.0}) * kDegree;
  setup.field_of_view = view.NumberOr("field_of_view_deg", 75.0, {20.0, 120.0}) * kDegree;
}

void ReadSettings(const core::JsonView& root, LiveSettings& settings) {
  if (!root.Has("settings")) return;
  const core::JsonView view = root.Object("settings");
  view.AllowOnly({"stiffness_scale", "shape_scale", "gravity_m_s2", "head_up_deg", "right_up_deg", "solver",
                  "max_iterations", "tolerance", "max_error", "max_newton_steps"});
  settings.stiffness_scale = view.NumberOr("stiffness_scale", settings.stiffness_scale, {0.05, 20.0});
  settings.shape_scale = view.NumberOr("shape_scale", settings.shape_scale, {0.0, 20.0});
  settings.gravity = view.NumberOr("gravity_m_s2", settings.gravity, {0.0, 30.0});
  settings.head_up = view.NumberOr("head_up_deg", 0.0, {-30.0, 30.0}) * kDegree;
  settings.right_up = view.NumberOr("right_up_deg", 0.0, {-30.0, 30.0}) * kDegree;
  settings.solver.max_iterations =
      view.IntegerOr("max_iterations", settings.solver.max_iterations, {1, 100'000});
  settings.solver.tolerance = view.NumberOr("tolerance", settings.solver.tolerance, {0.0, 1.0});
  settings.solver.max_error = view.NumberOr("max_error", settings.solver.max_error, {1e-9, 1.0});
  settings.solver.max_newton_steps =
      view.IntegerOr("max_newton_steps", settings.solver.max_newton_steps, {1, 1000});
  const std::string solver = view.TextOr("solver", "adaptive");
  if (const auto kind = tissue::FindSolverKind(solver); kind) {
    settings.solver.kind = *kind;
  } else {
    std::string names;
    for (const auto known : tissue::kSolverKinds)
      names += (names.empty() ? "" : ", ") + std::string(tissue::SolverName(known));
    view.Complain("there is no solver \"" + solver + "\"; known are " + names, core::ErrorCode::kUnknownName);
  }
}

}  // namespace

core::Result<Scene> ReadScene(const std::filesystem::path& path,
                              const std::filesystem::path& patient_folder) {
  auto document = core::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const core::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "about", "patient", "tick_hz", "seed", "settings", "materials",
                  "instruments", "laparoscope", "script"});
  if (root.Text("format") != "trocar-scene") root.Complain("format must be \"trocar-scene\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  Scene scene;
  scene.name = root.Text("name");
  scene.tick_seconds = 1.0 / root.NumberOr("tick_hz", 120.0, {10.0, 2000.0});
  scene.seed = static_cast<std::uint64_t>(root.IntegerOr("seed", 0, {0.0, 2147483647.0}));
  const std::string own_patient = root.Text("patient");
  if (const auto status = document->Check(); !status.ok()) return status.error();

  scene.patient_folder = patient_folder.empty() ? path.parent_path() / own_patient : patient_folder;
  auto patient = anatomy::ReadPatient(scene.patient_folder);
  if (!patient.ok()) return patient.error();
  scene.patient = std::move(*patient);

  for (const core::JsonView& view : root.Array("materials")) {
    auto material = ReadMaterial(view, path.parent_path());
    if (!material.ok()) return material.error();
    scene.materials.push_back(std::move(*material));
  }
  ReadSettings(root, scene.settings);
  root.Object("instruments").AllowOnly({"left", "right"});
  ReadInstrument(root, "left", scene.patient, scene.instruments[kLeft]);
  ReadInstrument(root, "right", scene.patient, scene.instruments[kRight]);
  ReadLaparoscope(root, scene.patient, scene.laparoscope);
  const std::string script = root.TextOr("script", "");
  if (const auto status = document->Check(); !status.ok()) return status.error();
  if (!script.empty()) {
    auto read = ReadScript(path.parent_path() / script, scene.patient);
    if (!read.ok()) return read.error();
    scene.script = std::move(*read);
  }
  return scene;
}

}  // namespace trocar::session
