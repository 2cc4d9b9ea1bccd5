// SPDX-License-Identifier: Apache-2.0
#include "state_layout.h"

#include <utility>

#include "trocar/base/assert.h"
#include "trocar/scene/procedure.h"

namespace trocar::environment {
namespace {

using math::Vec3;
using simulation::Snapshot;

constexpr double kMillilitre = 1e6;  // per m^3
constexpr std::size_t kJointCount = 5;

/// Writes one number after the other.
class Writer {
 public:
  explicit Writer(std::span<float> state) : state_(state) {}
  void Put(double value) {
    TROCAR_ASSERT(next_ < state_.size());
    state_[next_++] = static_cast<float>(value);
  }
  void Put(const Vec3& v) { Put(v.x), Put(v.y), Put(v.z); }
  void Put(const math::Quaternion& q) { Put(q.w), Put(q.x), Put(q.y), Put(q.z); }
  std::size_t Count() const { return next_; }

 private:
  std::span<float> state_;
  std::size_t next_ = 0;
};

Vec3 CalcMiddle(const Snapshot& now, const scene::SurfaceInfo& surface) {
  Vec3 sum;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) sum = sum + now.positions[surface.first_node + i];
  return (1.0 / surface.node_count) * sum;
}

}  // namespace

void StateLayout::Add(std::string name, std::size_t count, std::string unit) {
  fields_.push_back({std::move(name), size_, count, std::move(unit)});
  size_ += count;
}

StateLayout::StateLayout(const simulation::Simulation& simulation) {
  const scene::Scene& scene = simulation.GetScene();
  for (const std::string hand : {"left.", "right."}) {
    Add(hand + "tip", 3, "m");
    Add(hand + "shaft", 3, "-");  // unit, from the tip back to the trocar
    Add(hand + "joints", kJointCount, "rad, rad, rad, m, rad");
    Add(hand + "force", 3, "N");
    Add(hand + "is_grasping", 1, "-");
    Add(hand + "is_touching", 1, "-");
    Add(hand + "tool", 1, "-");
    Add(hand + "clips_left", 1, "-");
  }
  Add("laparoscope.joints", 4, "rad, rad, rad, m");
  for (const scene::SceneObject& object : scene.objects) {
    Add("object." + object.name + ".position", 3, "m");
    Add("object." + object.name + ".rotation", 4, "quaternion w, x, y, z");
    if (object.Moves()) Add("object." + object.name + ".held", 2, "-");
  }
  if (scene.task) {
    for (const scene::Region& region : scene.task->regions) Add("region." + region.name + ".centre", 3, "m");
    for (const scene::Goal& goal : scene.task->goals) {
      Add("goal." + goal.name + ".done", 1, "-");
      Add("goal." + goal.name + ".is_open", 1, "-");
    }
  }
  if (scene.model) {
    for (const scene::ModelBand& band : scene.model->bands) Add("band." + band.name + ".is_whole", 1, "-");
  }
  for (const scene::SurfaceInfo& surface : simulation.Surfaces())
    Add("surface." + surface.name + ".middle", 3, "m");
  for (std::size_t i = 0; i < simulation.GetSnapshot().organs.size(); ++i)
    Add("surface." + simulation.Surfaces()[i].name + ".pressure", 1, "Pa");
  if (scene.operation || scene.model) {
    Add("clips", 1, "-");
    Add("cuts", 1, "-");
    Add("strands_intact", 1, "-");  // share
  }
  if (const scene::Procedure* procedure = scene::ProcedureOf(scene)) {
    for (const scene::MeasureRow& measure : procedure->measures) Add(std::string(measure.short_name), 1, "-");
    if (!procedure->criteria.empty()) {
      Add("critical_view", procedure->criteria.size(), "-");
      Add("critical_view_seen", procedure->sights.size(), "-");
    }
    Add("phase", procedure->phases.size(), "-");
  }
  if (scene.operation) {
    const scene::Procedure* procedure = scene.operation->procedure;
    const std::string organ(procedure != nullptr ? procedure->organ_name : "organ");
    Add(organ + "_is_free", 1, "-");
    Add(organ + "_is_in_bag", 1, "-");
    Add("blood", 1, "mL");
    Add("bile", 1, "mL");
    Add("smoke", 1, "-");
  }
  Add("time", 1, "-");  // share of the episode's
}

void StateLayout::Write(const simulation::Simulation& simulation, double time_share,
                        std::span<float> state) const {
  TROCAR_ASSERT(state.size() == size_);
  const scene::Scene& scene = simulation.GetScene();
  const Snapshot& now = simulation.GetSnapshot();
  const simulation::OperationSnapshot& operation = now.operation;
  Writer out(state);
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const simulation::InstrumentSnapshot& tool = now.instruments[hand];
    out.Put(tool.X_world_tool.translation);
    out.Put(math::Rotate(tool.X_world_tool.rotation, Vec3{0, 0, 1}));
    for (const double joint :
         {tool.joints.pan, tool.joints.tilt, tool.joints.spin, tool.joints.depth, tool.joints.jaw})
      out.Put(joint);
    out.Put(tool.force);
    out.Put(tool.is_grasping || tool.object >= 0);
    out.Put(tool.is_touching);
    out.Put(operation.tools[hand]);
    out.Put(operation.clips_left[hand]);
  }
  for (const double joint :
       {now.laparoscope.pan, now.laparoscope.tilt, now.laparoscope.spin, now.laparoscope.depth})
    out.Put(joint);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const scene::ObjectSnapshot& object = now.objects[i];
    out.Put(object.X_world_object.translation);
    out.Put(object.X_world_object.rotation);
    if (scene.objects[i].Moves()) out.Put(object.held_by & 1), out.Put((object.held_by >> 1) & 1);
  }
  if (scene.task) {
    for (const scene::Region& region : scene.task->regions) out.Put(region.centre);
    for (std::size_t i = 0; i < scene.task->goals.size(); ++i) {
      const scene::GoalSnapshot& goal = now.task.goals[i];
      out.Put(goal.is_done ? 1.0 : static_cast<double>(goal.steps_done) / scene.task->goals[i].steps.size());
      out.Put(goal.is_open);
    }
  }
  if (scene.model) {
    for (const std::uint8_t is_whole : operation.band_is_whole) out.Put(is_whole);
  }
  for (const scene::SurfaceInfo& surface : simulation.Surfaces()) out.Put(CalcMiddle(now, surface));
  for (const simulation::OrganSnapshot& organ : now.organs) out.Put(organ.pressure);
  if (scene.operation || scene.model) {
    out.Put(static_cast<double>(operation.clip_count));
    out.Put(static_cast<double>(operation.tube_cut_count));
    std::size_t intact = 0;
    for (const std::uint8_t is_intact : operation.strand_is_intact) intact += is_intact;
    const std::size_t strands = operation.strand_is_intact.size();
    out.Put(strands == 0 ? 1.0 : static_cast<double>(intact) / static_cast<double>(strands));
  }
  if (scene.operation) {
    const scene::ProcedureSnapshot& procedure = operation.procedure;
    for (const double measure : procedure.measures) out.Put(measure);
    for (const std::uint8_t points : procedure.view.criteria) out.Put(points);
    for (const std::uint8_t is_seen : procedure.view.sights) out.Put(is_seen);
    const std::size_t phases =
        scene.operation->procedure == nullptr ? 0 : scene.operation->procedure->phases.size();
    for (std::size_t phase = 0; phase < phases; ++phase) out.Put(procedure.phase == phase);
    out.Put(operation.is_organ_free);
    out.Put(operation.is_in_bag);
    const auto& fluids = operation.flow.ledger.fluids;
    out.Put(kMillilitre * fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left);
    out.Put(kMillilitre * fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left);
    out.Put(operation.smoke);
  }
  out.Put(time_share);
  TROCAR_ASSERT(out.Count() == size_);
}

}  // namespace trocar::environment
