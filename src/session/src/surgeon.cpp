// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/surgeon.h"

#include <algorithm>

#include "task_surgeon.h"

namespace trocar::session {
namespace {

SurgeonSkill NoviceSkill() {
  SurgeonSkill skill;
  skill.hand.speed = 0.05;
  skill.hand.shortest = 0.5;
  skill.hand.tremor = 0.0003;
  skill.hand.aim_error = 0.0010;
  skill.hand.jaw_rate = 1.0;
  skill.hand.spin_rate = 1.2;
  skill.pause = 0.8;
  skill.miss_share = 0.35;
  skill.camera_speed = 0.03;
  return skill;
}

bool HasGoals(const Scene& scene) {
  return scene.task && !scene.HasPatient();
}
/// Whether the task counts an error of that name.
bool Counts(const Scene& scene, std::string_view name) {
  return HasGoals(scene) && std::any_of(scene.task->errors.begin(), scene.task->errors.end(),
                                        [&](const ErrorRule& rule) { return rule.name == name; });
}

template <Flaw kFlaw>
std::unique_ptr<Surgeon> MakeCareless(std::shared_ptr<const Scene> scene, std::uint64_t seed) {
  return std::make_unique<TaskSurgeon>(std::move(scene), SurgeonSkill{}, kFlaw, seed);
}

constexpr const char *kDropped = "dropped", *kLost = "lost", *kWire = "wire_touched",
                     *kBoard = "board_pressed", *kView = "tip_out_of_view", *kClash = "tools_clash",
                     *kSlipped = "slipped", *kSmeared = "lens_smeared";

const SurgeonEntry kTaskSurgeons[] = {
    {"expert", "does every goal of a task, without an error", "", HasGoals, MakeCareless<Flaw::kNone>},
    {"novice", "slow, hesitant, unsteady; closes the jaws beside things and tries again", "", HasGoals,
     [](std::shared_ptr<const Scene> scene, std::uint64_t seed) -> std::unique_ptr<Surgeon> {
       return std::make_unique<TaskSurgeon>(std::move(scene), NoviceSkill(), Flaw::kNone, seed);
     }},
    {"drops", "lets a thing fall in mid-air, then goes on", kDropped,
     [](const Scene& scene) { return Counts(scene, kDropped); }, MakeCareless<Flaw::kDrops>},
    {"loses", "carries a thing out of the field and drops it there", kLost,
     [](const Scene& scene) { return Counts(scene, kLost); }, MakeCareless<Flaw::kLoses>},
    {"touches_wire", "strays from the path and touches the wire", kWire,
     [](const Scene& scene) { return Counts(scene, kWire); }, MakeCareless<Flaw::kTouchesWire>},
    {"presses_board", "pushes a tip hard into the board", kBoard,
     [](const Scene& scene) { return Counts(scene, kBoard); }, MakeCareless<Flaw::kPressesBoard>},
    {"leaves_view", "takes a tip out of the picture", kView,
     [](const Scene& scene) { return Counts(scene, kView); }, MakeCareless<Flaw::kLeavesView>},
    {"clashes", "runs one tool into the other", kClash,
     [](const Scene& scene) { return Counts(scene, kClash); }, MakeCareless<Flaw::kClashes>},
    {"pulls_apart", "pulls with both hands at one thing until it slips", kSlipped,
     [](const Scene& scene) { return Counts(scene, kSlipped); }, MakeCareless<Flaw::kPullsApart>},
    {"smears_lens", "takes the laparoscope too near", kSmeared,
     [](const Scene& scene) { return Counts(scene, kSmeared); }, MakeCareless<Flaw::kSmearsLens>},
    {"dawdles", "does not get on before the time is over", "time_over",
     [](const Scene& scene) { return HasGoals(scene) && scene.task->time_limit < 36000; },
     MakeCareless<Flaw::kDawdles>},
};

}  // namespace

std::vector<SurgeonEntry> ListSurgeons() {
  return {std::begin(kTaskSurgeons), std::end(kTaskSurgeons)};
}

core::Result<std::unique_ptr<Surgeon>> MakeSurgeon(std::string_view name, std::shared_ptr<const Scene> scene,
                                                   std::uint64_t seed) {
  std::string known;
  for (const SurgeonEntry& entry : ListSurgeons()) {
    if (!entry.suits(*scene)) continue;
    if (name == entry.name) return entry.make(std::move(scene), seed);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  return core::Error{core::ErrorCode::kUnknownName,
                     "no surgeon called \"" + std::string(name) + "\" suits this task; there are " +
                         (known.empty() ? "none for it" : known) + "; see trocar play --list"};
}

}  // namespace trocar::session
