// SPDX-License-Identifier: Apache-2.0
#include "state_layout.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/scene/procedure.h"

namespace trocar::environment {
namespace {

using math::Vec3;
using simulation::Snapshot;

constexpr double kMillilitre = 1e6;  // per m^3
constexpr std::size_t kJointCount = 5;

/// Beyond which a scaled state says no more.
constexpr double kUsualForce = 5;        // [N]
constexpr double kUsualPressure = 3000;  // [Pa]
constexpr double kUsualClips = 20;       // in an applier
constexpr double kUsualCount = 8;        // of clips and cuts
constexpr double kUsualMeasure = 4;      // of what a procedure counts: ducts and arteries that enter an organ
constexpr double kUsualFluid = 100;      // [mL]
constexpr double kRoundPlaces = 0.005;   // round where samples have a place [m]
constexpr double kRoundWork = 0.015;     // round where something is to be done [m]
constexpr double kWidestPlace = 0.040;   // a region that is larger is the field [m]
constexpr double kRoundOrgans = 0.060;   // organs are larger than their landmarks [m]

class Box {
 public:
  void Add(const Vec3& place) {
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], place[axis]);
      high_[axis] = std::max(high_[axis], place[axis]);
    }
  }
  PlaceBounds Round(double margin) const {
    const Vec3 round{margin, margin, margin};
    return {low_ - round, high_ + round};
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low_{kFar, kFar, kFar}, high_{-kFar, -kFar, -kFar};
};

/// Of one place over all samples. \param place_of  a scene's place
template <typename PlaceOf>
PlaceBounds BoundsOf(std::span<const scene::Scene> samples, const PlaceOf& place_of) {
  Box box;
  for (const scene::Scene& scene : samples) box.Add(place_of(scene));
  return box.Round(kRoundPlaces);
}

/// Whether a region is a place to go to and not the whole field.
bool IsPlace(const scene::Region& region) {
  return std::max({region.radius, region.half.x, region.half.y, region.half.z}) < kWidestPlace;
}

/// Where something is to be done.
Box FindWork(std::span<const scene::Scene> samples) {
  Box work;
  for (const scene::Scene& scene : samples) {
    for (const scene::SceneObject& object : scene.objects) {
      if (object.Moves()) work.Add(object.body.X_world_body.translation);
    }
    if (scene.task) {
      for (const scene::Region& region : scene.task->regions) {
        if (IsPlace(region)) work.Add(region.centre);
      }
    }
    if (scene.model) {
      for (const scene::ModelBand& band : scene.model->bands) work.Add(band.from), work.Add(band.to);
      for (const scene::ModelSheet& sheet : scene.model->sheets)
        work.Add(sheet.centre - sheet.half), work.Add(sheet.centre + sheet.half);
    }
    for (const patient::Tube& tube : scene.patient.tubes) {
      if (!scene.model) continue;
      for (const math::Vec3& point : tube.line.points) work.Add(point);
    }
    if (!scene.HasPatient()) continue;
    for (const patient::Landmark& landmark : scene.patient.landmarks) work.Add(landmark.position);
  }
  return work;
}

/// A tip goes from where it begins to where something is to be done.
PlaceBounds FindWay(std::span<const scene::Scene> samples, const Box& work, std::size_t hand) {
  Box box = work;
  const scene::InstrumentSetup& setup = samples.front().instruments[hand];
  box.Add(instrument::CalcToolPose(setup.p_world_port, setup.home).translation);
  return box.Round(samples.front().HasPatient() ? kRoundOrgans : kRoundWork);
}

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

void StateLayout::Add(std::string name, std::size_t count, std::string unit, double low, double high) {
  fields_.push_back({std::move(name), size_, count, std::move(unit)});
  size_ += count;
  low_.resize(size_, static_cast<float>(low));
  high_.resize(size_, static_cast<float>(high));
}

void StateLayout::AddPlace(std::string name, const PlaceBounds& bounds) {
  Add(std::move(name), 3, "m", 0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = size_ - 3 + static_cast<std::size_t>(axis);
    low_[at] = static_cast<float>(bounds.low[axis]);
    high_[at] = static_cast<float>(bounds.high[axis]);
  }
}

void StateLayout::AddRow(std::string name, std::string unit, std::span<const Range> ranges) {
  Add(std::move(name), ranges.size(), std::move(unit), 0, 0);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    low_[size_ - ranges.size() + i] = static_cast<float>(ranges[i].low);
    high_[size_ - ranges.size() + i] = static_cast<float>(ranges[i].high);
  }
}

StateLayout::StateLayout(const simulation::Simulation& simulation, std::span<const scene::Scene> samples) {
  TROCAR_ASSERT(!samples.empty());
  const scene::Scene& scene = simulation.GetScene();
  const Box work = FindWork(samples);
  const PlaceBounds worked = work.Round(scene.HasPatient() ? kRoundOrgans : kRoundWork);
  const double turn = std::numbers::pi;
  const instrument::JointLimits limits;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const std::string name = hand == instrument::kLeft ? "left." : "right.";
    const scene::InstrumentSetup& setup = scene.instruments[hand];
    AddPlace(name + "tip", FindWay(samples, work, static_cast<std::size_t>(hand)));
    Add(name + "shaft", 3, "-", -1, 1);  // unit, from the tip back to the trocar
    AddRow(name + "joints", "rad, rad, rad, m, rad",
           std::array<Range, kJointCount>{{{-limits.max_pan, limits.max_pan},
                                           {-limits.max_tilt, limits.max_tilt},
                                           {-turn, turn},
                                           {limits.min_depth, limits.max_depth},
                                           {0, limits.max_jaw}}});
    Add(name + "force", 3, "N", -kUsualForce, kUsualForce);
    Add(name + "is_grasping", 1, "-", 0, 1);
    Add(name + "is_touching", 1, "-", 0, 1);
    Add(name + "tool", 1, "-", 0, std::max(1.0, static_cast<double>(setup.tray.size()) - 1));
    Add(name + "clips_left", 1, "-", 0, kUsualClips);
  }
  AddRow("laparoscope.joints", "rad, rad, rad, m",
         std::array<Range, 4>{{{-limits.max_pan, limits.max_pan},
                               {-limits.max_tilt, limits.max_tilt},
                               {-turn, turn},
                               {0, limits.max_depth}}});
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const scene::SceneObject& object = scene.objects[i];
    AddPlace("object." + object.name + ".position",
             object.Moves() ? worked : BoundsOf(samples, [i](const scene::Scene& of) {
               return of.objects[i].body.X_world_body.translation;
             }));
    Add("object." + object.name + ".rotation", 4, "quaternion w, x, y, z", -1, 1);
    if (object.Moves()) Add("object." + object.name + ".held", 2, "-", 0, 1);
  }
  if (scene.task) {
    for (std::size_t i = 0; i < scene.task->regions.size(); ++i) {
      AddPlace("region." + scene.task->regions[i].name + ".centre",
               BoundsOf(samples, [i](const scene::Scene& of) { return of.task->regions[i].centre; }));
    }
    for (const scene::Goal& goal : scene.task->goals) {
      Add("goal." + goal.name + ".done", 1, "-", 0, 1);
      Add("goal." + goal.name + ".is_open", 1, "-", 0, 1);
    }
  }
  if (scene.model) {
    for (std::size_t i = 0; i < scene.model->bands.size(); ++i) {
      const std::string name = "band." + scene.model->bands[i].name;
      AddPlace(name + ".from",
               BoundsOf(samples, [i](const scene::Scene& of) { return of.model->bands[i].from; }));
      AddPlace(name + ".to",
               BoundsOf(samples, [i](const scene::Scene& of) { return of.model->bands[i].to; }));
      Add(name + ".is_whole", 1, "-", 0, 1);
    }
    for (std::size_t i = 0; i < scene.model->sheets.size(); ++i) {
      const scene::ModelSheet& sheet = scene.model->sheets[i];
      AddPlace("sheet." + sheet.name + ".circle_centre",
               BoundsOf(samples, [i](const scene::Scene& of) { return of.model->sheets[i].centre; }));
      Add("sheet." + sheet.name + ".circle_radius", 1, "m", 0, 0.05);
    }
  }
  for (const scene::SurfaceInfo& surface : simulation.Surfaces())
    AddPlace("surface." + surface.name + ".middle", worked);
  for (std::size_t i = 0; i < simulation.GetSnapshot().organs.size(); ++i)
    Add("surface." + simulation.Surfaces()[i].name + ".pressure", 1, "Pa", 0, kUsualPressure);
  if (scene.operation || scene.model) {
    Add("clips", 1, "-", 0, kUsualCount);
    Add("cuts", 1, "-", 0, kUsualCount);
    Add("strands_intact", 1, "-", 0, 1);  // share
  }
  if (const scene::Procedure* procedure = scene::ProcedureOf(scene)) {
    for (const scene::MeasureRow& measure : procedure->measures)
      Add(std::string(measure.short_name), 1, "-", 0, measure.is_share ? 1 : kUsualMeasure);
    if (!procedure->criteria.empty()) {
      Add("critical_view", procedure->criteria.size(), "-", 0, scene::ViewScore::kWhole);
      Add("critical_view_seen", procedure->sights.size(), "-", 0, 1);
    }
    Add("phase", procedure->phases.size(), "-", 0, 1);
  }
  if (scene.operation) {
    const scene::Procedure* procedure = scene.operation->procedure;
    const std::string organ(procedure != nullptr ? procedure->organ_name : "organ");
    Add(organ + "_is_free", 1, "-", 0, 1);
    Add(organ + "_is_in_bag", 1, "-", 0, 1);
    Add("blood", 1, "mL", 0, kUsualFluid);
    Add("bile", 1, "mL", 0, kUsualFluid);
    Add("smoke", 1, "-", 0, 1);
  }
  Add("time", 1, "-", 0, 1);  // share of the episode's
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
    for (std::size_t i = 0; i < scene.model->bands.size(); ++i) {
      out.Put(scene.model->bands[i].from);
      out.Put(scene.model->bands[i].to);
      out.Put(operation.band_is_whole[i]);
    }
    for (const scene::ModelSheet& sheet : scene.model->sheets) out.Put(sheet.centre), out.Put(sheet.circle);
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
