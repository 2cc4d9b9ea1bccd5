// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "layout_set.h"
#include "trocar/dataset/hdf5_file.h"
#include "trocar/environment/demonstration.h"
#include "trocar/host/json_text.h"
#include "trocar/roles/roles.h"
#include "trocar/view/labels.h"

namespace trocar::dataset {
namespace {

using nlohmann::ordered_json;

constexpr float kNormalUnit = 127;  // of a stored component of 1
constexpr int kJoints = 5;
constexpr std::size_t kCriteria = 3;  // of the critical view

/// Homogeneous, row after row.
std::array<double, 16> ToMatrix(const math::Pose& pose) {
  std::array<double, 16> m{};
  for (std::size_t column = 0; column < 3; ++column) {
    math::Vec3 axis;
    axis[static_cast<int>(column)] = 1;
    const math::Vec3 turned = math::Rotate(pose.rotation, axis);
    for (std::size_t row = 0; row < 3; ++row) m[4 * row + column] = turned[static_cast<int>(row)];
    m[4 * column + 3] = pose.translation[static_cast<int>(column)];
  }
  m[15] = 1;
  return m;
}

/// What there is, which rows of the positions it has, and what its ducts and vessels join: the anatomy as a graph.
ordered_json DescribeAnatomy(const simulation::Simulation& simulation) {
  auto surfaces = ordered_json::array();
  for (const scene::SurfaceInfo& surface : simulation.Surfaces()) {
    const bool is_tube = surface.triangles.empty();
    surfaces.push_back(
        {{"name", surface.name},
         {"kind", is_tube ? "tube" : "organ"},
         {"class", view::NameOf(view::FindLabelClass(surface, simulation.GetScene().HasPatient()))},
         {"first_node", surface.first_node},
         {"node_count", surface.node_count},
         {"joins", is_tube ? ordered_json(surface.ends) : ordered_json::array()}});
  }
  return {{"surfaces", surfaces}};
}

constexpr std::array<std::pair<const char*, environment::ActionKind>, 2> kActions = {
    {{"action_joints", environment::ActionKind::kJoints}, {"action_tip", environment::ActionKind::kTip}}};
constexpr double kShortest = 1e-3;  // between two inputs [s]

ordered_json DescribeFields(std::span<const environment::Field> fields) {
  auto out = ordered_json::array();
  for (const environment::Field& field : fields)
    out.push_back(
        {{"name", field.name}, {"first", field.first}, {"count", field.count}, {"unit", field.unit}});
  return out;
}

/// What the numbers of states and actions are.
ordered_json DescribeFields(const environment::Demonstration& demonstration) {
  ordered_json out = {{"state", DescribeFields(demonstration.StateFields())}};
  for (const auto& [name, kind] : kActions) out[name] = DescribeFields(demonstration.ActionFields(kind));
  return out;
}

class TrocarWriter : public VideoWriter {
 public:
  TrocarWriter(const VideoTask& task, const simulation::Simulation& simulation)
      : path_(task.folder / (NameVideo("video_", task.plan->first_seed + task.index, 5) + ".h5")),
        has_pictures_(task.plan->has_pictures),
        anatomy_(host::FormatJson(DescribeAnatomy(simulation))),
        demonstration_(simulation),
        fields_(host::FormatJson(DescribeFields(demonstration_))) {}

  void Look(const simulation::Simulation& simulation, const scene::Input& input) override {
    now_ = {input, simulation.GetSnapshot().time};
  }

  base::Status Add(const Frame& frame, const simulation::Simulation& simulation) override {
    if (!file_) {
      auto made = Hdf5File::Make(path_);
      if (!made) return made.error();
      file_.emplace(std::move(*made));
      if (has_pictures_) {
        if (auto s = file_->SetNumber("focal_length", frame.focal_length); !s) return s;
      }
      if (auto s = file_->SetText("anatomy", anatomy_); !s) return s;
      if (auto s = file_->SetText("fields", fields_); !s) return s;
    } else {
      AddActions();
    }
    at_frame_ = now_;
    if (has_pictures_) {
      if (auto s = AddPictures(frame); !s) return s;
    }
    std::vector<float> state(demonstration_.StateSize());
    demonstration_.Observe(simulation, state);
    Put("state", {state.size()}, state);
    return AddState(simulation.GetSnapshot());
  }

  base::Status Finish() override {
    if (!file_) return {};
    AddActions();
    if (!status_.ok()) return status_;
    return file_->Close();
  }

 private:
  template <typename T>
  void Put(const char* name, const std::vector<std::size_t>& shape, const std::vector<T>& row) {
    if (status_.ok()) status_ = file_->Append<T>(name, shape, row);
  }

  /// What was done from the last frame to now.
  void AddActions() {
    for (const auto& [name, kind] : kActions) {
      std::vector<double> action(demonstration_.ActionSize(kind));
      // the last frame may be that of the last tick: then nothing was done after it
      const double seconds = std::max(now_.time - at_frame_.time, kShortest);
      demonstration_.FindAction(kind, at_frame_.input, now_.input, seconds, action);
      Put(name, {action.size()}, std::vector<float>(action.begin(), action.end()));
    }
  }

  base::Status AddPictures(const Frame& frame) {
    const auto h = static_cast<std::size_t>(frame.colour.height),
               w = static_cast<std::size_t>(frame.colour.width);
    std::vector<std::int8_t> normals;
    for (const float component : frame.geometry.normals)
      normals.push_back(static_cast<std::int8_t>(std::lround(kNormalUnit * component)));
    std::vector<std::uint8_t> classes, instances;
    for (const std::uint16_t label : frame.geometry.labels) {
      classes.push_back(static_cast<std::uint8_t>(view::ClassOf(label)));
      instances.push_back(view::InstanceOf(label));
    }
    Put("colour", {h, w, 3}, frame.colour.pixels);
    Put("depth", {h, w}, frame.geometry.depth);
    Put("normals", {h, w, 3}, normals);
    Put("classes", {h, w}, classes);
    Put("instances", {h, w}, instances);
    Put("flow", {h, w, 2}, frame.geometry.flow);
    return status_;
  }

  base::Status AddState(const simulation::Snapshot& now) {
    Put<double>("time", {}, {now.time});
    const auto pose = ToMatrix(now.X_world_laparoscope);
    Put<double>("pose", {4, 4}, {pose.begin(), pose.end()});
    std::vector<double> tips, forces, joints;
    std::vector<std::uint8_t> tools;
    for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) {
      const simulation::InstrumentSnapshot& tool = now.instruments[hand];
      const auto tip = ToMatrix(tool.X_world_tool);
      tips.insert(tips.end(), tip.begin(), tip.end());
      forces.insert(forces.end(), {tool.force.x, tool.force.y, tool.force.z});
      joints.insert(joints.end(), {tool.joints.pan, tool.joints.tilt, tool.joints.spin, tool.joints.depth,
                                   tool.joints.jaw});
      tools.push_back(now.operation.tools[hand]);
    }
    Put("tools", {instrument::kHandCount}, tools);
    Put("tool_poses", {instrument::kHandCount, 4, 4}, tips);
    Put("forces", {instrument::kHandCount, 3}, forces);
    Put("joints", {instrument::kHandCount, kJoints}, joints);
    std::vector<float> positions;
    for (const math::Vec3& p : now.positions)
      for (const double coordinate : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(coordinate));
    if (!positions.empty()) Put("positions", {now.positions.size(), 3}, positions);
    const scene::ProcedureSnapshot& procedure = now.operation.procedure;
    Put<std::uint8_t>("phase", {}, {procedure.phase});
    std::vector<std::uint8_t> criteria = procedure.view.criteria;
    criteria.resize(kCriteria);  // a scene without a procedure has none
    Put<std::uint8_t>("critical_view", {kCriteria}, criteria);
    return status_;
  }

  /// What the simulation was given last, and when.
  struct Given {
    scene::Input input;
    double time = 0;  // [s]
  };

  std::filesystem::path path_;
  bool has_pictures_;
  std::string anatomy_;
  environment::Demonstration demonstration_;
  std::string fields_;
  Given now_, at_frame_;
  std::optional<Hdf5File> file_;
  base::Status status_;
};

class TrocarSet : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& simulation) override {
    return std::make_unique<TrocarWriter>(task, simulation);
  }
  ordered_json Classes() const override {
    auto classes = ordered_json::array();
    for (std::size_t i = 0; i < view::kLabelClassCount; ++i)
      classes.push_back({{"id", i}, {"name", view::NameOf(static_cast<view::LabelClass>(i))}});
    return classes;
  }
  std::vector<std::string> Gaps() const override {
    return {
        "Normals are rounded to 1/127.",
        "Actions are those of an environment, whose hands move at most 0.12 m/s: faster ones are cut to "
        "that.",
        "Flow is since the frame before, and NaN of fibres, drops and pools, and where nothing was before.",
        "Films of blood, bile and burns are colours of an organ and have no mask."};
  }
};

}  // namespace

std::unique_ptr<LayoutSet> MakeTrocar() {
  return std::make_unique<TrocarSet>();
}

}  // namespace trocar::dataset
