// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/operation_guide.h"

#include <array>
#include <limits>

#include "trocar/cholecystectomy/cholecystectomy.h"
#include "trocar/host/translate.h"
#include "trocar/instrument/tool.h"
#include "trocar/presenter/guides.h"

namespace trocar::presenter {
namespace {

using assessment::Milestone;
using instrument::ToolKind;
using math::Vec3;
using roles::StrandRole;

constexpr double kTargetRadius = 0.006;  // [m]

enum Text {
  kLift,
  kTakeNeck,
  kTakeHook,
  kClearTriangle,
  kFreePlate,
  kFreeStructures,
  kShowFront,
  kShowBack,
  kTakeClips,
  kClip,
  kTakeScissors,
  kDivide,
  kTakeOffBed,
  kTakeBag,
  kPutInBag,
  kDrawOut,
  kTextCount
};

// in the order of Text; keys are put in by KeyBindings::Fill
constexpr std::string_view kTexts[kTextCount] = {
    "{assistant}: the assistant takes the fundus and lifts it.",
    "Left hand ({left-hand}): take the gallbladder's neck, {close-jaws}, and draw it out to the patient's "
    "right.",
    "Right hand ({right-hand}): the hook, {next-tool}.",
    "Hook under a fibre of the triangle, lift it off, {cut}: clear fat and fibres until the liver is seen "
    "behind. Stay on "
    "the gallbladder.",
    "Free the lowest third of the gallbladder from the liver with the hook.",
    "Free duct and artery all round: fibre by fibre, close to the gallbladder.",
    "Show the front: turn the neck until duct, artery and liver between them are seen from the front, for a "
    "second.",
    "Show the back: turn the neck the other way, until the same is seen from behind, for a second.",
    "Right hand ({right-hand}): the clip applier, {next-tool}.",
    "Clip duct and artery: jaws right round it, {close-jaws}. Two clips towards the patient, one towards the "
    "gallbladder.",
    "Right hand ({right-hand}): the scissors, {next-tool}.",
    "Cut duct and artery between the clips, {close-jaws}.",
    "Take the gallbladder off its bed with the hook, from the neck upwards, fibre by fibre.",
    "Right hand ({right-hand}): the bag, {next-tool}.",
    "Put the gallbladder into the bag's mouth, and open the jaws that hold it.",
    "Draw the bag out: back along its shaft, through the port."};

bool HasTool(const scene::Scene& scene, const simulation::Snapshot& now, instrument::Hand hand,
             ToolKind kind) {
  const auto& tray = scene.instruments[hand].tray;
  const std::size_t place = now.operation.tools[hand];
  return place < tray.size() ? tray[place].kind == kind : scene.instruments[hand].tool.kind == kind;
}
bool HasToolInTray(const scene::Scene& scene, instrument::Hand hand, ToolKind kind) {
  for (const instrument::Tool& tool : scene.instruments[hand].tray) {
    if (tool.kind == kind) return true;
  }
  return false;
}

/// The fibre of these kinds that is nearest to the right hand's tip and still whole.
template <std::size_t N>
std::optional<Vec3> FindFibre(std::span<const scene::StrandInfo> strands, const simulation::Snapshot& now,
                              const std::array<StrandRole, N>& kinds) {
  const Vec3& tip = now.instruments[instrument::kRight].X_world_tool.translation;
  const auto& is_intact = now.operation.strand_is_intact;
  double least = std::numeric_limits<double>::infinity();
  std::optional<Vec3> nearest;
  for (std::size_t i = 0; i < strands.size(); ++i) {
    if (i < is_intact.size() && is_intact[i] == 0) continue;
    bool is_wanted = false;
    for (const StrandRole kind : kinds) is_wanted = is_wanted || strands[i].kind == kind;
    if (!is_wanted) continue;
    const Vec3 middle = math::Lerp(now.positions[strands[i].a], now.positions[strands[i].b], 0.5);
    if (const double distance = math::SquaredDistance(middle, tip); distance < least)
      least = distance, nearest = middle;
  }
  return nearest;
}

OperationStep Say(Text text, std::optional<Vec3> target = std::nullopt) {
  return {kTexts[text], target};
}

/// Until the view stands.
OperationStep FindViewStep(const scene::Scene& scene, std::span<const scene::StrandInfo> strands,
                           const simulation::Snapshot& now) {
  const scene::ViewScore& view = now.operation.procedure.view;
  if (!now.instruments[instrument::kLeft].is_grasping) return Say(kTakeNeck);
  if (!view.AreCriteriaWhole() && HasToolInTray(scene, instrument::kRight, ToolKind::kHook) &&
      !HasTool(scene, now, instrument::kRight, ToolKind::kHook))
    return Say(kTakeHook);
  const std::array triangle{StrandRole::kPeritoneum, StrandRole::kTriangle};
  if (!view.IsWhole(cholecystectomy::kTriangle))
    return Say(kClearTriangle, FindFibre(strands, now, triangle));
  if (!view.IsWhole(cholecystectomy::kPlate))
    return Say(kFreePlate, FindFibre(strands, now, std::array{StrandRole::kBed}));
  if (!view.IsWhole(cholecystectomy::kTwoStructures))
    return Say(kFreeStructures, FindFibre(strands, now, triangle));
  return Say(view.IsSeen(cholecystectomy::kFromFront) ? kShowBack : kShowFront);
}

}  // namespace

std::span<const std::string_view> OperationStepTexts() noexcept {
  return kTexts;
}

OperationStep FindOperationStep(const scene::Scene& scene, std::span<const scene::StrandInfo> strands,
                                const simulation::Snapshot& now, Milestone reached) {
  const simulation::OperationSnapshot& operation = now.operation;
  if (operation.is_completed) return {};
  const double entering = operation.procedure.Measure(cholecystectomy::kStructuresEntering);
  const bool is_dissecting = reached < Milestone::kCriticalView && entering > 0;
  if (!operation.is_organ_free && operation.assistant.is_there && !operation.assistant.is_holding)
    return Say(kLift);
  if (is_dissecting) return FindViewStep(scene, strands, now);
  if (entering > 0) {
    // three clips for each that enters: two stay, one leaves with the gallbladder
    const auto wanted = static_cast<std::size_t>(3 * entering);
    if (operation.clip_count < wanted)
      return Say(HasTool(scene, now, instrument::kRight, ToolKind::kClipApplier) ? kClip : kTakeClips);
    return Say(HasTool(scene, now, instrument::kRight, ToolKind::kScissors) ? kDivide : kTakeScissors);
  }
  if (!operation.is_organ_free) {
    if (!HasTool(scene, now, instrument::kRight, ToolKind::kHook) &&
        HasToolInTray(scene, instrument::kRight, ToolKind::kHook))
      return Say(kTakeHook);
    return Say(kTakeOffBed, FindFibre(strands, now, std::array{StrandRole::kBed, StrandRole::kPeritoneum}));
  }
  if (!operation.is_in_bag)
    return Say(HasTool(scene, now, instrument::kRight, ToolKind::kBag) ? kPutInBag : kTakeBag);
  return Say(kDrawOut);
}

std::optional<view::Trail> MarkOperationStep(const OperationStep& step,
                                             const math::Pose& X_world_laparoscope) {
  if (!step.target) return std::nullopt;
  // seen as a circle
  return MakeRing(*step.target, math::Rotate(X_world_laparoscope.rotation, Vec3{0, 0, 1}), kTargetRadius,
                  render::Material::kMark);
}

}  // namespace trocar::presenter
