// SPDX-License-Identifier: Apache-2.0
#include "acts.h"

#include <algorithm>

#include "class_tables.h"

namespace trocar::dataset {
namespace {

using cholecystectomy::Target;
using cholecystectomy::Verb;
using instrument::ToolKind;

constexpr double kRetraction = 0.3;  // N; what holds harder retracts
constexpr double kMoment = 1.0;      // s for which a cut or a clip is seen as one

const instrument::Tool& ToolOf(const scene::Scene& scene, const simulation::Snapshot& now, std::size_t hand) {
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  if (setup.tray.empty()) return setup.tool;
  return setup.tray[std::min<std::size_t>(now.operation.tools[hand], setup.tray.size() - 1)];
}

}  // namespace

Target ActWatch::TargetOf(std::int32_t surface) const {
  if (surface < 0 || static_cast<std::size_t>(surface) >= surfaces_.size()) return Target::kOmentum;
  const scene::SurfaceInfo& info = surfaces_[static_cast<std::size_t>(surface)];
  switch (view::FindLabelClass(info, scene_->HasPatient())) {
    case view::LabelClass::kLiver:
      return Target::kLiver;
    case view::LabelClass::kGallbladder:
      return Target::kGallbladder;
    case view::LabelClass::kCysticDuct:
      return Target::kCysticDuct;
    case view::LabelClass::kCysticArtery:
      return Target::kCysticArtery;
    case view::LabelClass::kArtery:
    case view::LabelClass::kBileDuct:
      return Target::kBloodVessel;
    default:
      return Target::kGut;
  }
}

void ActWatch::Look(const simulation::Snapshot& now, const scene::Input& input) {
  const simulation::OperationSnapshot& operation = now.operation;
  const bool was_cut = operation.tube_cut_count > cuts_ || operation.topology.version > topology_;
  const bool was_clipped = operation.clip_count > clips_;
  cuts_ = operation.tube_cut_count;
  clips_ = operation.clip_count;
  topology_ = operation.topology.version;
  bool has_bag = false;
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand)
    has_bag = has_bag || ToolOf(*scene_, now, hand).kind == ToolKind::kBag;
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) {
    const simulation::InstrumentSnapshot& tool = now.instruments[hand];
    const ToolKind kind = ToolOf(*scene_, now, hand).kind;
    const scene::HandControls& controls = input.controls[hand];
    Act& act = acts_[hand];
    act = {{InstrumentOf(kind), Verb::kNullVerb, Target::kNullTarget}, hand, view::FindLabelClass(kind)};
    is_instrument_[hand] = kind != ToolKind::kBag;
    if (tool.is_touching || tool.is_grasping) last_target_[hand] = TargetOf(tool.organ);
    const auto does = [&](Verb verb, Target target) {
      act.triplet.verb = verb;
      act.triplet.target = target;
    };
    if (kind == ToolKind::kScissors && was_cut) cut_until_[hand] = now.time + kMoment;
    if (kind == ToolKind::kClipApplier && was_clipped) clip_until_[hand] = now.time + kMoment;
    if (operation.has_current[hand]) {
      does(controls.coagulate && !controls.cut ? Verb::kCoagulate : Verb::kDissect, TargetOf(tool.organ));
    } else if (kind == ToolKind::kScissors && now.time < cut_until_[hand]) {
      does(Verb::kCut, last_target_[hand]);
    } else if (kind == ToolKind::kClipApplier && now.time < clip_until_[hand]) {
      does(Verb::kClip, last_target_[hand]);
    } else if (kind == ToolKind::kSuctionIrrigator && controls.aspirate) {
      does(Verb::kAspirate, Target::kFluid);
    } else if (kind == ToolKind::kSuctionIrrigator && controls.rinse) {
      does(Verb::kIrrigate, tool.organ >= 0 && TargetOf(tool.organ) == Target::kLiver
                                ? Target::kLiver
                                : Target::kAbdominalWallCavity);
    } else if (tool.is_grasping && tool.organ >= 0) {
      const Target target = TargetOf(tool.organ);
      const bool is_packed = has_bag && target == Target::kGallbladder;
      const bool is_pulled = math::Norm(tool.force) > kRetraction;
      does(is_packed ? Verb::kPack : is_pulled ? Verb::kRetract : Verb::kGrasp, target);
    }
  }
}

std::vector<Act> ActWatch::Acts() const {
  std::vector<Act> acts;
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand)
    if (is_instrument_[hand]) acts.push_back(acts_[hand]);
  return acts;
}

}  // namespace trocar::dataset
