// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/scene_file.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "field_ranges.h"
#include "material_file.h"
#include "patched_json.h"
#include "scene_objects.h"
#include "scene_reader.h"
#include "script.h"
#include "tissue_model_file.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/operation_parameters_file.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/find_procedure.h"

namespace trocar::files {
namespace {

/// A landmark with an offset, or a point: {"at": "fundus", "offset_mm": [0, 0, 10]}, {"at_mm": [0, 40, -120]}.
math::Vec3 ReadTarget(const host::JsonView& view, std::string_view key, const patient::Patient& patient) {
  const host::JsonView target = view.Object(key);
  target.AllowOnly({"at", "offset_mm", "at_mm"});
  if (target.Has("at_mm")) return ReadPointMm(target, "at_mm");
  const std::string name = target.Text("at");
  const patient::Landmark* landmark = patient.FindLandmark(name);
  if (landmark == nullptr) {
    target.Complain(patient.landmarks.empty()
                        ? "a scene without a patient has no landmarks; say where with at_mm: [x, y, z]"
                        : "there is no landmark \"" + name + "\" in the patient",
                    base::ErrorCode::kUnknownName);
    return {};
  }
  return landmark->position +
         (target.Has("offset_mm") ? ReadPointMm(target, "offset_mm", range::kOffsetMm) : math::Vec3{});
}

/// The patient's own port, else the scene's.
math::Vec3 ReadPort(const host::JsonView& view, const patient::Patient& patient, patient::PortUse use) {
  const math::Vec3 of_scene = ReadPointMm(view, "port_mm");
  const patient::Port* port = patient.PortOf(use);
  return port != nullptr ? port->position : of_scene;
}

void ReadInstrument(const host::JsonView& root, const char* hand, const patient::Patient& patient,
                    patient::PortUse use, scene::InstrumentSetup& setup) {
  const host::JsonView view = root.Object("instruments").Object(hand);
  view.AllowOnly({"tool", "tray", "port_mm", "tip", "spin_deg", "jaw_deg"});
  const auto add = [&](const std::string& name) {
    if (const instrument::Tool* tool = instrument::FindTool(name); tool != nullptr) {
      setup.tray.push_back(*tool);
    } else {
      std::string known;
      for (const instrument::Tool& one : instrument::AllTools())
        known += (known.empty() ? "" : ", ") + one.name;
      view.Complain("there is no tool \"" + name + "\"; known are " + known, base::ErrorCode::kUnknownName);
    }
  };
  add(view.Text("tool"));
  if (view.Has("tray")) {
    for (const host::JsonView& name : view.Array("tray")) add(name.AsText());
  }
  if (!setup.tray.empty()) setup.tool = setup.tray.front();
  setup.p_world_port = ReadPort(view, patient, use);
  setup.home = instrument::FindJoints(setup.p_world_port, ReadTarget(view, "tip", patient),
                                      view.NumberOr("spin_deg", 0.0, range::kTurnDeg) * math::kDegree,
                                      view.NumberOr("jaw_deg", 0.0, range::kJawDeg) * math::kDegree);
}

void ReadOperation(const host::JsonView& root, const patient::Patient& patient, scene::Scene& scene) {
  if (!root.Has("operation")) return;
  const host::JsonView view = root.Object("operation");
  view.AllowOnly({"procedure", "fat_spacing_mm", "assistant", "gallstones", "parameters"});
  scene::OperationSetup setup;
  const std::string procedure = view.TextOr("procedure", procedures::kUsualProcedure);
  setup.procedure = procedures::FindProcedure(procedure);
  if (setup.procedure == nullptr)
    view.Complain("there is no procedure \"" + procedure + "\"; known are " + procedures::ListNames(),
                  base::ErrorCode::kUnknownName);
  setup.fat_spacing = 0.001 * view.NumberOr("fat_spacing_mm", 1e3 * setup.fat_spacing, range::kFatSpacingMm);
  if (setup.fat_spacing > 0.0 && setup.fat_spacing < 0.0015)
    view.Complain("fat_spacing_mm must be 0, for none, or at least 1.5");
  if (view.Has("gallstones")) {
    const host::JsonView stones = view.Object("gallstones");
    stones.AllowOnly({"count", "median_diameter_mm"});
    setup.gallstones.count = stones.Integer("count", {0, surgery::kMostGallstones});
    setup.gallstones.median_diameter =
        0.001 * stones.NumberOr("median_diameter_mm", 1e3 * setup.gallstones.median_diameter,
                                range::kGallstoneDiameterMm);
  }
  if (patient.tubes.empty())
    view.Complain(
        "the patient has no ducts; an operation needs them: place a template with trocar anatomy edit");
  if (view.Has("assistant")) {
    const host::JsonView hand = view.Object("assistant");
    hand.AllowOnly({"port_mm", "at", "lift_mm"});
    scene::AssistantSetup assistant;
    assistant.tool = *instrument::FindTool("grasper");
    assistant.p_world_port = ReadPort(hand, patient, patient::PortUse::kAssistant);
    assistant.lift = ReadPointMm(hand, "lift_mm", range::kOffsetMm);
    const std::string name = hand.Text("at");
    if (const patient::Landmark* landmark = patient.FindLandmark(name)) {
      assistant.p_world_target = landmark->position;
    } else {
      hand.Complain("there is no landmark \"" + name + "\" in the patient", base::ErrorCode::kUnknownName);
    }
    setup.assistant = std::move(assistant);
  }
  scene.operation = std::move(setup);
}

/// The operation's tables: those that the scene names, else the delivered ones.
base::Status ReadParameters(const host::JsonView& root, const std::filesystem::path& folder,
                            scene::OperationSetup& operation) {
  std::filesystem::path path;
  if (root.Has("operation") && root.Object("operation").Has("parameters")) {
    path = folder / root.Object("operation").Text("parameters");
  } else {
    const auto data = host::FindDataFolder();
    if (!data.ok()) return data.error();
    path = *data / kOperationParametersFile;
  }
  const auto read = ReadOperationParameters(path, operation.level.parameters_patch);
  if (!read.ok()) return read.error();
  operation.parameters = *read;
  return {};
}

void ReadLaparoscope(const host::JsonView& root, const patient::Patient& patient,
                     scene::LaparoscopeSetup& setup, scene::LiveSettings& settings) {
  const host::JsonView view = root.Object("laparoscope");
  view.AllowOnly({"port_mm", "target", "depth_mm", "view_angle_deg", "post_deg", "field_of_view_deg",
                  "look_at_target", "holder"});
  const std::string holder = view.TextOr("holder", "trainee");
  if (holder != "trainee" && holder != "automatic")
    view.Complain("holder must be trainee or automatic, not \"" + holder + "\"",
                  base::ErrorCode::kUnknownName);
  settings.holds_camera = holder == "automatic";
  setup.p_world_port = ReadPort(view, patient, patient::PortUse::kLaparoscope);
  setup.home = instrument::FindJoints(setup.p_world_port, ReadTarget(view, "target", patient),
                                      view.NumberOr("post_deg", 0.0, range::kTurnDeg) * math::kDegree, 0.0);
  setup.home.depth = 0.001 * view.Number("depth_mm", range::kLaparoscopeDepthMm);
  setup.view_angle = view.NumberOr("view_angle_deg", 0.0, range::kViewAngleDeg) * math::kDegree;
  setup.field_of_view = view.NumberOr("field_of_view_deg", 75.0, range::kFieldOfViewDeg) * math::kDegree;
  if (!view.BooleanOr("look_at_target", false)) return;
  scene::ViewRequest request;
  request.p_world = ReadTarget(view, "target", patient);
  request.distance = std::max(0.02, math::Distance(request.p_world, setup.p_world_port) - setup.home.depth);
  if (const auto found = scene::FindView(setup, request)) setup.home = *found;
}

/// Complains where two of the ports are one hole: no two shafts pass it, and no surgeon would place them so.
void CheckPorts(const host::JsonView& root, const scene::Scene& scene) {
  struct Port {
    const char* name;
    math::Vec3 p_world;
  };
  std::vector<Port> ports = {{"the left instrument", scene.instruments[instrument::kLeft].p_world_port},
                             {"the right instrument", scene.instruments[instrument::kRight].p_world_port},
                             {"the laparoscope", scene.laparoscope.p_world_port}};
  if (scene.operation && scene.operation->assistant)
    ports.push_back({"the assistant", scene.operation->assistant->p_world_port});
  for (std::size_t i = 0; i < ports.size(); ++i) {
    for (std::size_t j = i + 1; j < ports.size(); ++j) {
      if (math::Distance(ports[i].p_world, ports[j].p_world) >= 0.001 * range::kLeastPortDistanceMm) continue;
      root.Complain(std::string(ports[i].name) + " and " + ports[j].name +
                        " have their ports in one place; keep port_mm at least 5 mm apart",
                    base::ErrorCode::kSceneInvalid);
      return;
    }
  }
}

void ReadSettings(const host::JsonView& root, scene::LiveSettings& settings) {
  if (!root.Has("settings")) return;
  const host::JsonView view = root.Object("settings");
  view.AllowOnly({"stiffness_scale", "shape_scale", "gravity_m_s2", "head_up_deg", "right_up_deg", "solver",
                  "max_iterations", "tolerance", "max_error", "max_newton_steps", "max_linear_total",
                  "follow_snap_through"});
  settings.stiffness_scale =
      view.NumberOr("stiffness_scale", settings.stiffness_scale, range::kStiffnessScale);
  settings.shape_scale = view.NumberOr("shape_scale", settings.shape_scale, range::kShapeScale);
  settings.gravity = view.NumberOr("gravity_m_s2", settings.gravity, range::kGravity);
  settings.head_up = view.NumberOr("head_up_deg", 0.0, range::kTiltDeg) * math::kDegree;
  settings.right_up = view.NumberOr("right_up_deg", 0.0, range::kTiltDeg) * math::kDegree;
  settings.solver.max_iterations =
      view.IntegerOr("max_iterations", settings.solver.max_iterations, range::kMaxIterations);
  settings.solver.tolerance = view.NumberOr("tolerance", settings.solver.tolerance, range::kTolerance);
  settings.solver.max_error = view.NumberOr("max_error", settings.solver.max_error, range::kMaxError);
  settings.solver.newton.max_steps =
      view.IntegerOr("max_newton_steps", settings.solver.newton.max_steps, range::kMaxNewtonSteps);
  settings.solver.newton.max_linear_total =
      view.IntegerOr("max_linear_total", settings.solver.newton.max_linear_total, range::kMaxLinearTotal);
  settings.solver.newton.follows_snap_through =
      view.BooleanOr("follow_snap_through", settings.solver.newton.follows_snap_through);
  const std::string solver = view.TextOr("solver", "adaptive");
  if (const auto kind = tissue::FindSolverKind(solver); kind) {
    settings.solver.kind = *kind;
  } else {
    std::string names;
    for (const auto known : tissue::kSolverKinds)
      names += (names.empty() ? "" : ", ") + std::string(tissue::SolverName(known));
    view.Complain("there is no solver \"" + solver + "\"; known are " + names, base::ErrorCode::kUnknownName);
  }
}

}  // namespace

base::Result<scene::Scene> ReadSceneFields(const host::JsonDocument& document, const host::JsonView& view,
                                           const std::filesystem::path& folder,
                                           const std::filesystem::path& patient_folder,
                                           const scene::OperationLevel& level) {
  view.AllowOnly({"format", "version", "name", "about", "patient", "tick_hz", "seed", "settings", "materials",
                  "instruments", "laparoscope", "script", "operation", "objects", "model"});
  scene::Scene scene;
  scene.name = view.TextOr("name", "");
  scene.tick_seconds = 1.0 / view.NumberOr("tick_hz", 120.0, range::kTickHz);
  scene.seed = static_cast<std::uint64_t>(view.IntegerOr("seed", 0, range::kSeed));
  if (view.Has("objects")) scene.objects = ReadObjects(view, "objects");
  // what needs no patient may have no patient
  const bool has_patient = (scene.objects.empty() && !view.Has("model")) || view.Has("patient");
  const std::string own_patient = has_patient ? view.Text("patient") : "";
  if (!has_patient && !patient_folder.empty())
    view.Complain("is without a patient, so none can take its place", base::ErrorCode::kSceneInvalid);
  if (view.Has("model")) {
    if (view.Has("patient") || view.Has("operation"))
      view.Complain("a model takes the place of patient and operation; leave them out",
                    base::ErrorCode::kSceneInvalid);
    if (scene.objects.empty())
      view.Complain("a model stands among objects, at least on a board", base::ErrorCode::kSceneInvalid);
    ReadTissueModel(view.Object("model"), scene);
  }
  if (const auto status = document.Check(); !status.ok()) return status.error();

  if (has_patient) {
    scene.patient_folder = patient_folder.empty() ? folder / own_patient : patient_folder;
    auto patient = ReadPatient(scene.patient_folder);
    if (!patient.ok()) return patient.error();
    scene.patient = std::move(*patient);
  }
  if (has_patient || view.Has("materials")) {
    auto materials = ReadMaterials(view, folder);
    if (!materials.ok()) return materials.error();
    scene.materials = std::move(*materials);
  }
  ReadSettings(view, scene.settings);
  view.Object("instruments").AllowOnly({"left", "right"});
  if (scene.patient.table) {
    scene.settings.head_up = scene.patient.table->head_up;
    scene.settings.right_up = scene.patient.table->right_up;
  }
  ReadInstrument(view, "left", scene.patient, patient::PortUse::kLeftHand,
                 scene.instruments[instrument::kLeft]);
  ReadInstrument(view, "right", scene.patient, patient::PortUse::kRightHand,
                 scene.instruments[instrument::kRight]);
  ReadLaparoscope(view, scene.patient, scene.laparoscope, scene.settings);
  ReadOperation(view, scene.patient, scene);
  CheckPorts(view, scene);
  const std::string script = view.TextOr("script", "");
  if (const auto status = document.Check(); !status.ok()) return status.error();
  if (scene.operation) {
    scene.operation->level = level;
    if (const auto status = ReadParameters(view, folder, *scene.operation); !status.ok())
      return status.error();
  }
  if (!script.empty()) {
    auto read = ReadScript(folder / script, scene.patient);
    if (!read.ok()) return read.error();
    scene.script = std::move(*read);
  }
  return scene;
}

base::Result<scene::Scene> ParsePlainScene(const std::string& text, const std::filesystem::path& source,
                                           const std::filesystem::path& patient_folder,
                                           const scene::OperationLevel& level) {
  auto document = ParsePatched(text, source.string(), level.scene_patch);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  const std::string format = root.Text("format");
  if (format == "trocar-task") return ParseTask(text, source, {.patient_folder = patient_folder});
  if (format != "trocar-scene") root.Complain("format must be \"trocar-scene\" (or \"trocar-task\")");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  if (root.Text("name").empty()) root.Complain("the scene needs a name");
  return ReadSceneFields(*document, root, source.parent_path(), patient_folder, level);
}

base::Result<scene::Scene> ReadScene(const std::filesystem::path& path,
                                     const std::filesystem::path& patient_folder) {
  const auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  return ParsePlainScene(*text, path, patient_folder, {});
}

base::Result<std::optional<scene::Scene>> FindOperation(const std::string& name,
                                                        const std::filesystem::path& patient_folder,
                                                        std::uint64_t seed, const std::string& level) {
  std::filesystem::path path = name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    const auto data = host::FindDataFolder();
    if (!data.ok()) return data.error();
    path = *data / "scenes" / (name + ".json");
  }
  if (!std::filesystem::is_regular_file(path, ignored)) return std::optional<scene::Scene>();
  const auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  const auto document = host::JsonDocument::Parse(*text, path.string());
  if (!document.ok()) return document.error();
  if (!document->Root().Has("operation")) return std::optional<scene::Scene>();
  const auto chosen = FindOperationLevel(level);
  if (!chosen.ok()) return chosen.error();
  auto scene = ParsePlainScene(*text, path, patient_folder, *chosen);
  if (!scene.ok()) return scene.error();
  scene->seed = seed;
  return std::optional<scene::Scene>(std::move(*scene));
}

}  // namespace trocar::files
