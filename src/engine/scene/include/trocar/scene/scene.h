// SPDX-License-Identifier: Apache-2.0
/// \file scene.h  Scene: all that is constant while a simulation runs, such as patient, ports, tools, script.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/instrument/tool.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/input.h"
#include "trocar/scene/operation_level.h"
#include "trocar/scene/operation_parameters.h"
#include "trocar/scene/scene_object.h"
#include "trocar/scene/task.h"
#include "trocar/surgery/gallstones.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::scene {

struct Procedure;

/// Straight or angled telescope in its port.
struct LaparoscopeSetup {
  math::Vec3 p_world_port;          ///< [m]
  instrument::TrocarJoints home;    ///< where it starts
  double view_angle = 0;            ///< 0 or 30 deg, between shaft and line of sight [rad]
  double field_of_view = 1.308997;  ///< diagonal, 75 deg [rad]
};

struct InstrumentSetup {
  instrument::Tool tool;               ///< at the start: the first of the tray
  std::vector<instrument::Tool> tray;  ///< what can be exchanged through this trocar, at least one
  math::Vec3 p_world_port;             ///< [m]
  instrument::TrocarJoints home;       ///< where it starts
};

/// Pose of both hands at one time; between keys the tips move smoothly along straight lines.
struct ScriptKey {
  double time = 0;  ///< [s]
  std::array<math::Vec3, instrument::kHandCount> p_world_tip;
  std::array<double, instrument::kHandCount> spin{};  ///< [rad]
  std::array<double, instrument::kHandCount> jaw{};   ///< [rad]
};

/// A row of keys in time order: a deterministic pair of hands.
struct Script {
  std::vector<ScriptKey> keys;
  double tremor =
      0;  ///< amplitude of the hands' physiological tremor, 8 to 12 Hz, different for each seed [m]
  double Duration() const { return keys.empty() ? 0.0 : keys.back().time; }
};

/// The third grasper and who holds it.
struct AssistantSetup {
  instrument::Tool tool;
  math::Vec3 p_world_port;    ///< [m]
  math::Vec3 p_world_target;  ///< a landmark of the patient: what it takes, as it lies at rest [m]
  math::Vec3 lift;            ///< from where it took it, when told to retract [m]
};

/// Setup that makes a scene an operation: tissue to be dissected, and tools that do more than push and hold.
struct OperationSetup {
  /// What is performed, and who judges it (scene/procedure.h); null: nobody does, and no organ is taken out. Of static storage.
  const Procedure* procedure = nullptr;
  double fat_spacing = 0.0022;  ///< of the lobules in the hepatocystic triangle [m]; 0: none
  std::optional<AssistantSetup> assistant;
  /// Of a patient whose parameters say nothing of stones.
  surgery::GallstoneSettings gallstones;
  OperationParameters parameters;
  OperationLevel level;
};

/// A cord between two fixed points, of pieces one after the other: divided when one of them is.
struct ModelBand {
  std::string name;
  ObjectColour colour = ObjectColour::kRed;
  math::Vec3 from, to;     ///< world frame [m]
  double radius = 0.0006;  ///< [m]
};

/// A level sheet that is held at its border, with a circle drawn round its middle.
struct ModelSheet {
  std::string name;
  math::Vec3 centre;       ///< world frame [m]
  math::Vec3 half;         ///< of its sides along x and y [m]; z is 0
  double spacing = 0.003;  ///< of its nodes [m]
  double circle = 0.020;   ///< radius [m]
  double prestrain = 0;    ///< how far the frame stretches it in every direction [-]
};

/// Tissue that a training task makes for itself. Its ducts are the tubes of Scene::patient, its sheets the organs.
struct ModelSetup {
  std::vector<ModelBand> bands;
  std::vector<ModelSheet> sheets;
};

/// How stiff one organ is; see tissue/material.h for the formulas.
struct OrganMaterial {
  std::string organ;              ///< its name, or what tissue it is: "liver", "duct"
  double young_modulus = 0;       ///< of the wall or capsule [Pa]
  double wall_thickness = 0;      ///< [m]
  double foundation_modulus = 0;  ///< of what lies behind the surface [Pa]
  double depth = 0;               ///< of that foundation [m]
  double density = 0;             ///< [kg/m^3]
  /// Strands of this material tear when longer than at rest by this share of the thickness [-].
  double failure_strain = std::numeric_limits<double>::infinity();
  /// The end of a tube of this material is torn out of its organ by this force [N].
  double failure_force = std::numeric_limits<double>::infinity();
  tissue::SpringLaw wall_law;    ///< of the wall's edges: how it stiffens and tears
  double internal_pressure = 0;  ///< under which the organ is filled and sealed before the first tick [Pa]
  std::string source;
  roles::TissueRole tissue = roles::ConventionalRole<roles::TissueRole>(organ);
};

struct Scene {
  std::string name;
  std::filesystem::path patient_folder;
  patient::Patient patient;
  std::vector<OrganMaterial> materials;
  std::array<InstrumentSetup, instrument::kHandCount> instruments;
  LaparoscopeSetup laparoscope;
  LiveSettings settings;             ///< at the start
  double tick_seconds = 1.0 / 120;   ///< [s]
  std::uint64_t seed = 0;            ///< of everything random: now the tremor of a script's hands
  Script script;                     ///< empty when the scene names none
  std::vector<SceneObject> objects;  ///< of a training task; without a patient there is at least one
  std::optional<OperationSetup> operation;
  std::optional<ModelSetup> model;  ///< then `patient` is made from it, and nobody's
  std::optional<Task> task;         ///< what is to be done

  bool HasPatient() const { return !patient.organs.empty() && !model; }
};

/// Pose of the lens: looks along -z, bent from the shaft by the view angle towards the light post; the horizon stays.
math::Pose CalcLaparoscopePose(const LaparoscopeSetup& setup,
                               const instrument::TrocarJoints& joints) noexcept;

/// Request for a view: the point in the middle of the picture, its distance, and the side from which it is seen.
struct ViewRequest {
  math::Vec3 p_world;                ///< in its middle [m]
  double distance = 0.08;            ///< from the lens [m], > 0
  std::optional<math::Vec3> facing;  ///< from this side as nearly as can be, unit
  double most_depth = 0.28;          ///< of the lens [m]
};
/// Joints of a laparoscope that shows it, with the light post that does it best; nothing where none can.
/// \note Real-time safe, as the one below.
std::optional<instrument::TrocarJoints> FindView(const LaparoscopeSetup& setup,
                                                 const ViewRequest& request) noexcept;
/// Joints of a laparoscope that shows it with the light post as given; nothing where none can. `facing` is ignored.
/// \param spin  of the light post [rad]
std::optional<instrument::TrocarJoints> FindView(const LaparoscopeSetup& setup, const ViewRequest& request,
                                                 double spin) noexcept;

/// The script's input at `time` [s], clamped to its first and last key; the home pose without a script.
Input CalcScriptInput(const Scene& scene, double time);

}  // namespace trocar::scene
