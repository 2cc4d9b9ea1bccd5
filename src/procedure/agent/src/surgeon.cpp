// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/surgeon.h"

#include <algorithm>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "task_surgeon.h"
#include "trocar/agent/skill.h"

namespace trocar::agent {

using scene::ErrorRule;
using scene::Scene;

namespace {

bool HasGoals(const Scene& scene) {
  return IsDoneByGoals(scene);
}
/// Whether the task counts an error of that name.
bool Counts(const Scene& scene, std::string_view name) {
  return HasGoals(scene) && std::any_of(scene.task->errors.begin(), scene.task->errors.end(),
                                        [&](const ErrorRule& rule) { return rule.name == name; });
}

template <ErrorScenario kScenario>
std::unique_ptr<Surgeon> MakeCareless(std::shared_ptr<const Scene> scene, std::uint64_t seed) {
  return std::make_unique<TaskSurgeon>(std::move(scene), SurgeonSkill{}, kScenario, seed);
}

template <SkillLevel kLevel>
std::unique_ptr<Surgeon> MakeOfLevel(std::shared_ptr<const Scene> scene, std::uint64_t seed) {
  auto made = MakeSkilledSurgeon(std::move(scene), LevelSkill(kLevel), seed);
  return made.ok() ? std::move(*made) : nullptr;
}

/// Able but for one thing. The names and lines are string literals, so that they end with a zero.
template <Weakness kWeakness>
SurgeonEntry WithWeakness() {
  return {NameOf(kWeakness).data(), AboutOf(kWeakness).data(), "",
          [](const Scene& scene) { return HasGoals(scene) && CanShow(kWeakness, scene); },
          [](std::shared_ptr<const Scene> scene, std::uint64_t seed) -> std::unique_ptr<Surgeon> {
            auto made = MakeSkilledSurgeon(std::move(scene),
                                           PlantWeakness(LevelSkill(SkillLevel::kExpert), kWeakness), seed);
            return made.ok() ? std::move(*made) : nullptr;
          }};
}

template <std::size_t... kIndex>
void AddWeaknesses(std::vector<SurgeonEntry>& all, std::index_sequence<kIndex...>) {
  (all.push_back(WithWeakness<static_cast<Weakness>(kIndex)>()), ...);
}

constexpr const char *kDropped = "dropped", *kLost = "lost", *kWire = "wire_touched",
                     *kBoard = "board_pressed", *kView = "tip_out_of_view", *kClash = "tools_clash",
                     *kSlipped = "slipped", *kSmeared = "lens_smeared";

const SurgeonEntry kTaskSurgeons[] = {
    {"expert", "does every goal of a task, without an error", "", HasGoals,
     MakeCareless<ErrorScenario::kNone>},
    {"intermediate", "between the two: some pauses, misses and detours", "", HasGoals,
     MakeOfLevel<SkillLevel::kIntermediate>},
    {"novice", "slow, hesitant, unsteady; closes the jaws beside things and tries again", "", HasGoals,
     MakeOfLevel<SkillLevel::kNovice>},
    {"drops", "lets a thing fall in mid-air, then goes on", kDropped,
     [](const Scene& scene) { return Counts(scene, kDropped); }, MakeCareless<ErrorScenario::kDrops>},
    {"loses", "carries a thing out of the field and drops it there", kLost,
     [](const Scene& scene) { return Counts(scene, kLost); }, MakeCareless<ErrorScenario::kLoses>},
    {"touches_wire", "strays from the path and touches the wire", kWire,
     [](const Scene& scene) { return Counts(scene, kWire); }, MakeCareless<ErrorScenario::kTouchesWire>},
    {"presses_board", "pushes a tip hard into the board", kBoard,
     [](const Scene& scene) { return Counts(scene, kBoard); }, MakeCareless<ErrorScenario::kPressesBoard>},
    {"leaves_view", "takes a tip out of the picture", kView,
     [](const Scene& scene) { return Counts(scene, kView); }, MakeCareless<ErrorScenario::kLeavesView>},
    {"clashes", "runs one tool into the other", kClash,
     [](const Scene& scene) { return Counts(scene, kClash); }, MakeCareless<ErrorScenario::kClashes>},
    {"pulls_apart", "pulls with both hands at one thing until it slips", kSlipped,
     [](const Scene& scene) { return Counts(scene, kSlipped); }, MakeCareless<ErrorScenario::kPullsApart>},
    {"smears_lens", "takes the laparoscope too near", kSmeared,
     [](const Scene& scene) { return Counts(scene, kSmeared); }, MakeCareless<ErrorScenario::kSmearsLens>},
    {"clips_astray", "closes a clip off its mark", "clip_off_mark",
     [](const Scene& scene) { return Counts(scene, "clip_off_mark"); },
     MakeCareless<ErrorScenario::kClipsAstray>},
    {"crosses_clips", "closes one clip over another", "clip_crossed",
     [](const Scene& scene) { return Counts(scene, "clip_crossed"); },
     MakeCareless<ErrorScenario::kCrossesClips>},
    {"clips_partly", "closes a clip around a part of the duct", "clip_partial",
     [](const Scene& scene) { return Counts(scene, "clip_partial"); },
     MakeCareless<ErrorScenario::kClipsPartly>},
    {"drops_clip", "closes a clip around nothing", "clip_dropped",
     [](const Scene& scene) { return Counts(scene, "clip_dropped"); },
     MakeCareless<ErrorScenario::kDropsClip>},
    {"cuts_astray", "cuts the duct in the wrong place", "cut_off_mark",
     [](const Scene& scene) { return Counts(scene, "cut_off_mark"); },
     MakeCareless<ErrorScenario::kCutsAstray>},
    {"cuts_unclipped", "cuts the duct before the clips are on", "too_few_clips",
     [](const Scene& scene) { return Counts(scene, "too_few_clips"); },
     MakeCareless<ErrorScenario::kCutsUnclipped>},
    {"burns_spared", "burns a strand that is to be spared", "wrong_strand_burnt",
     [](const Scene& scene) { return Counts(scene, "wrong_strand_burnt"); },
     MakeCareless<ErrorScenario::kBurnsSpared>},
    {"cuts_aside", "cuts a sheet beside its line", "cut_off_line",
     [](const Scene& scene) { return Counts(scene, "cut_off_line"); },
     MakeCareless<ErrorScenario::kCutsAside>},
    {"burns_air", "presses the pedal in the air", "energy_without_contact",
     [](const Scene& scene) { return Counts(scene, "energy_without_contact"); },
     MakeCareless<ErrorScenario::kBurnsAir>},
    {"burns_unseen", "presses the pedal out of the picture", "energy_out_of_view",
     [](const Scene& scene) { return Counts(scene, "energy_out_of_view"); },
     MakeCareless<ErrorScenario::kBurnsUnseen>},
    {"dawdles", "does not get on before the time is over", "time_over",
     [](const Scene& scene) { return HasGoals(scene) && scene.task->time_limit < 36000; },
     MakeCareless<ErrorScenario::kDawdles>},
};

template <OperationErrorScenario kScenario>
std::unique_ptr<Surgeon> MakeCarelessOperator(std::shared_ptr<const Scene> scene, std::uint64_t seed) {
  return std::make_unique<CholecystectomySurgeon>(std::move(scene), SurgeonSkill{}, kScenario, seed);
}

const SurgeonEntry kOperators[] = {
    {"expert", "does the whole cholecystectomy", "", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kNone>},
    {"novice", "does it slowly and unsteadily", "", IsCholecystectomy, MakeOfLevel<SkillLevel::kNovice>},
    {"clips_main_duct", "closes a clip on the common hepatic duct", "wrong_structure_clipped",
     IsCholecystectomy, MakeCarelessOperator<OperationErrorScenario::kClipsMainDuct>},
    {"cuts_main_duct", "cuts the common hepatic duct", "wrong_structure_cut", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kCutsMainDuct>},
    {"burns_main_duct", "holds the electrode to the common hepatic duct", "wrong_structure_burnt",
     IsCholecystectomy, MakeCarelessOperator<OperationErrorScenario::kBurnsMainDuct>},
    {"cuts_unclipped", "cuts the cystic duct without a clip", "unclipped_cut", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kCutsUnclipped>},
    {"clips_early", "clips before the critical view", "clip_before_critical_view", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kClipsEarly>},
    {"too_few_clips", "cuts with one clip on the patient's side", "too_few_clips", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kTooFewClips>},
    {"crosses_clips", "puts one clip over another", "clip_crossed", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kCrossesClips>},
    {"clips_partly", "closes a clip around half of the duct", "clip_partial", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kClipsPartly>},
    {"bleeds", "cuts the cystic artery and watches", "bleeding", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kBleeds>},
    {"rinses", "cuts the cystic artery, and rinses and aspirates while it bleeds", "bleeding",
     IsCholecystectomy, MakeCarelessOperator<OperationErrorScenario::kRinses>},
    {"slips_clip", "closes a clip around the edge of the cystic artery and cuts it", "clip_slipped",
     IsCholecystectomy, MakeCarelessOperator<OperationErrorScenario::kSlipsClip>},
    {"perforates", "burns the gallbladder", "gallbladder_perforated", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kPerforates>},
    {"leaves_stones", "opens the free gallbladder, and leaves the stones that spill", "stones_left",
     IsCholecystectomy, MakeCarelessOperator<OperationErrorScenario::kLeavesStones>},
    {"burns_liver", "burns the liver", "liver_burnt", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kBurnsLiver>},
    {"burns_near_duct", "uses current beside the common hepatic duct", "energy_near_duct", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kBurnsNearDuct>},
    {"burns_unseen", "presses the pedal out of the picture", "energy_out_of_view", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kBurnsUnseen>},
    {"burns_air", "presses the pedal in the air", "energy_without_contact", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kBurnsAir>},
    {"drops_clip", "closes a clip around nothing", "clip_dropped", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kDropsClip>},
    {"grasps_liver", "takes the liver into the jaws", "liver_grasped", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kGraspsLiver>},
    {"pulls_hard", "pulls until the tissue slips out of the jaws", "excess_force", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kPullsHard>},
    {"cuts_liver", "cuts into the liver", "structure_torn", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kCutsLiver>},
    {"inserts_blind", "pushes a tool in out of the picture", "blind_insertion", IsCholecystectomy,
     MakeCarelessOperator<OperationErrorScenario::kInsertsBlind>},
};

}  // namespace

std::vector<SurgeonEntry> ListSurgeons() {
  std::vector<SurgeonEntry> all(std::begin(kTaskSurgeons), std::end(kTaskSurgeons));
  AddWeaknesses(all, std::make_index_sequence<kWeaknessCount>());
  all.insert(all.end(), std::begin(kOperators), std::end(kOperators));
  return all;
}

base::Result<std::unique_ptr<Surgeon>> MakeSurgeon(std::string_view name, std::shared_ptr<const Scene> scene,
                                                   std::uint64_t seed) {
  std::string known;
  for (const SurgeonEntry& entry : ListSurgeons()) {
    if (!entry.suits(*scene)) continue;
    if (name == entry.name) return entry.make(std::move(scene), seed);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  return base::Error{base::ErrorCode::kUnknownName,
                     "no surgeon called \"" + std::string(name) + "\" suits this task; there are " +
                         (known.empty() ? "none for it" : known) + "; see trocar play --list"};
}

}  // namespace trocar::agent
