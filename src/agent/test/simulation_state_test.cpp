// SPDX-License-Identifier: Apache-2.0
// A state that was saved goes on to the same bits: in the same simulation, in a fresh one, and whoever looks on or not.
// The simulation in a process of its own is played by tests/command/state_file_test.cpp.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "task_play.h"
#include "trocar/math/random.h"

namespace trocar::agent {

using scene::CalcScriptInput;
using scene::ReadScene;
using simulation::InstrumentSnapshot;
using simulation::MakeSimulationModel;
using simulation::OperationSnapshot;
using simulation::SimulationModel;
using simulation::StatePart;
using simulation::StonePlace;
using simulation::StoneSnapshot;
namespace {

/// A scene, and who acts in it.
struct Course {
  std::string name;     ///< of a delivered task, or of a scene file
  std::string surgeon;  ///< "" for the scene's script
  int ticks = 0;        ///< at most
  int points = 0;       ///< random ticks at which it is saved
  bool at_events = true;
  bool changes_settings = false;  ///< as ChangeSettings() does
};

void PrintTo(const Course& course, std::ostream* out) {
  *out << course.name << " " << course.surgeon;
}

constexpr int kGoesOn = 240;  // ticks after a point

std::shared_ptr<const Scene> ReadCourse(const Course& course) {
  const auto file = std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes" / (course.name + ".json");
  if (!std::filesystem::exists(file)) return ReadDelivered(course.name);
  auto scene = ReadScene(file);
  EXPECT_TRUE(scene.ok()) << scene.error().Text();
  return std::make_shared<const Scene>(std::move(*scene));
}

/// Cuts, clips, stones, things taken: where a state is the least like the one of before.
std::uint64_t CountEvents(const Snapshot& snapshot) {
  const OperationSnapshot& operation = snapshot.operation;
  std::uint64_t count = operation.topology_version + operation.clip_count + snapshot.task.error_count;
  for (const StoneSnapshot& stone : operation.stones) count += stone.place != StonePlace::kInside ? 1 : 0;
  for (const InstrumentSnapshot& tool : snapshot.instruments) count += tool.is_grasping ? 1 : 0;
  return count;
}

/// An instructor who tilts the table, stiffens the tissue for a while, again and again, and leaves the camera to its holder.
void ChangeSettings(std::size_t tick, scene::LiveSettings& settings) {
  settings.holds_camera = true;
  if (tick / 90 % 2 == 0) return;
  settings.head_up = 0.3;
  settings.stiffness_scale *= 1.5;
  settings.shape_scale *= 1.2;
}

struct Point {
  std::size_t tick = 0;
  std::vector<std::byte> bytes;
  std::uint64_t hash = 0, hash_after = 0;
};

/// One course with its inputs, and the states on its way.
struct Recording {
  std::shared_ptr<const SimulationModel> model;
  std::vector<Input> inputs;
  std::vector<Point> points;
};

Recording Record(const Course& course, std::shared_ptr<const Scene> scene) {
  Recording recording;
  auto model = MakeSimulationModel(scene);
  EXPECT_TRUE(model.ok()) << model.error().Text();
  recording.model = *model;
  Simulation simulation = std::move(*Simulation::Make(recording.model, 1));
  std::unique_ptr<Surgeon> surgeon;
  if (!course.surgeon.empty()) surgeon = std::move(*MakeSurgeon(course.surgeon, scene, 1));
  math::Random random(std::hash<std::string>()(course.name));
  std::set<std::size_t> chosen;
  for (int i = 0; i < course.points; ++i)
    chosen.insert(static_cast<std::size_t>(random.Uniform(0.0, 1.0) * course.ticks));
  std::uint64_t events = 0, events_saved = 0;
  std::map<std::size_t, std::size_t> ends;  // tick to point
  for (std::size_t tick = 0; tick < static_cast<std::size_t>(course.ticks + kGoesOn); ++tick) {
    if (const auto end = ends.find(tick); end != ends.end())
      recording.points[end->second].hash_after = simulation.Hash();
    const Snapshot& seen = simulation.GetSnapshot();
    const bool is_event = course.at_events && CountEvents(seen) != events && events_saved < 12;
    events = CountEvents(seen);
    if (is_event) ++events_saved;
    const bool is_over = surgeon != nullptr && surgeon->HasFinished();
    const bool has_time = tick < static_cast<std::size_t>(course.ticks);
    if ((chosen.count(tick) != 0 || is_event) && has_time && !is_over) {
      ends[tick + kGoesOn] = recording.points.size();
      Point& point = recording.points.emplace_back();
      point.tick = tick;
      simulation.Save(point.bytes);
      point.hash = simulation.Hash();
    }
    Input input = surgeon != nullptr ? surgeon->Act(seen) : CalcScriptInput(simulation.GetScene(), seen.time);
    if (course.changes_settings) ChangeSettings(tick, input.settings);
    recording.inputs.push_back(input);
    simulation.Step(input);
  }
  return recording;
}

void GoOn(const Recording& recording, const Point& point, Simulation& simulation) {
  for (std::size_t tick = point.tick; tick < point.tick + kGoesOn; ++tick)
    simulation.Step(recording.inputs[tick]);
}

void CheckCourse(const Course& course) {
  const auto scene = ReadCourse(course);
  const Recording recording = Record(course, scene);
  ASSERT_GE(recording.points.size(), 2U) << course.name;
  Simulation used = std::move(*Simulation::Make(recording.model, 2));
  // backwards, so that every state is one of another past
  for (std::size_t i = recording.points.size(); i-- > 0;) {
    const Point& point = recording.points[i];
    Simulation fresh = std::move(*Simulation::Make(recording.model, 1));
    for (Simulation* simulation : {&used, &fresh}) {
      const core::Status restored = simulation->Restore(point.bytes);
      ASSERT_TRUE(restored.ok()) << restored.error().Text();
      ASSERT_EQ(simulation->Hash(), point.hash) << course.name << ", tick " << point.tick;
      GoOn(recording, point, *simulation);
      ASSERT_EQ(simulation->Hash(), point.hash_after)
          << course.name << ", " << kGoesOn << " ticks after tick " << point.tick
          << (simulation == &fresh ? ", in a fresh simulation" : "");
    }
  }
}

class SimulationState : public testing::TestWithParam<Course> {};
TEST_P(SimulationState, GoesOnToTheSameBits) {
  CheckCourse(GetParam());
}
std::string NameOf(const testing::TestParamInfo<Course>& info) {
  return info.param.name + (info.param.surgeon.empty() ? "" : "_" + info.param.surgeon);
}
INSTANTIATE_TEST_SUITE_P(Scenes, SimulationState,
                         testing::Values(Course{"retraction", "", 700, 2},
                                         Course{"demonstration", "", 700, 2}, Course{"tearing", "", 500, 2},
                                         Course{"cholecystectomy", "", 120, 2}),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Tasks, SimulationState,
                         testing::Values(Course{"camera_navigation_0", "expert", 900, 3},
                                         Course{"camera_navigation_30", "expert", 900, 3},
                                         Course{"clip_and_cut", "crosses_clips", 1700, 3},
                                         Course{"hook_dissection", "expert", 1000, 3},
                                         Course{"instrument_navigation", "clashes", 900, 3},
                                         Course{"lift_and_grasp", "drops", 1200, 3},
                                         Course{"object_transport", "pulls_apart", 1200, 3},
                                         Course{"pattern_cut", "expert", 2000, 3},
                                         Course{"peg_transfer", "expert", 1500, 3},
                                         Course{"wire_run", "touches_wire", 1200, 3}),
                         NameOf);

class SimulationStateSlow : public testing::TestWithParam<Course> {};
TEST_P(SimulationStateSlow, GoesOnToTheSameBits) {
  CheckCourse(GetParam());
}
INSTANTIATE_TEST_SUITE_P(
    Courses, SimulationStateSlow,
    testing::Values(
        Course{"retraction", "", 6000, 20}, Course{"demonstration", "", 2000, 20},
        Course{"tearing", "", 1500, 20}, Course{"cholecystectomy", "expert", 40'000, 20},
        Course{"cholecystectomy", "leaves_stones", 60'000, 20},
        Course{"camera_navigation_0", "expert", 1600, 20}, Course{"camera_navigation_30", "expert", 1600, 20},
        Course{"clip_and_cut", "expert", 1800, 20}, Course{"hook_dissection", "burns_spared", 1100, 20},
        Course{"instrument_navigation", "expert", 2400, 20}, Course{"lift_and_grasp", "expert", 4000, 20},
        Course{"object_transport", "expert", 4000, 20}, Course{"pattern_cut", "cuts_aside", 2200, 20},
        Course{"peg_transfer", "loses", 9000, 20}, Course{"wire_run", "expert", 4000, 20}),
    NameOf);

/// Fields of one name, as those of all organs, are one.
std::map<std::string, std::uint64_t> HashByField(const Simulation& simulation) {
  std::map<std::string, std::uint64_t> fields;
  for (const auto& [field, hash] : simulation.HashFields()) {
    core::StateHash both;
    both.Add(fields[field]);
    both.Add(hash);
    fields[field] = both.Value();
  }
  return fields;
}

/// Fields of the state that a control leaves out, and what would have to happen for it to see them.
struct Exceptions {
  const char* reason;
  std::set<std::string> fields;
};

/// Fields that are as they begin at every point of the courses below.
const std::vector<Exceptions>& Unchanged() {
  static const std::vector<Exceptions> exceptions = {
      {"a tick has to go wrong, as in recovery_test.cpp", {"guard/bad_in_a_row", "was_frozen"}},
      {"a piece of tissue has to come free, as the gallbladder does at the end of the operation",
       {"conserved/X_world_rest", "conserved/regions/of_node", "good_conserved/X_world_rest",
        "good_conserved/regions/of_node"}},
      {"is set in the very tick of a cut, and taken back in the next",
       {"conserved/responses/has_new_topology"}},
      {"an organ has to touch the wall of the cavity or another organ",
       {"contacts/cavity_contacts/allowed", "contacts/cavity_contacts/is_held", "contacts/overlap",
        "contacts/pairs/allowed"}},
      {"a sleeve or a shaft has to hold a tool back, or more contacts than there is memory for",
       {"contacts/contacts/dropped", "contacts/contacts/held_back"}},
      {"a grasp has to damage what it holds", {"grasps/is_damaged", "grasps/ticks_over_limit"}},
      {"the table has to be tilted under rings and pegs", {"rigid/bodies/gravity"}},
      {"the judges of the cholecystectomy, which no task has",
       {"judge/blind_seconds", "judge/is_inserting", "judge/view/behind_seconds", "judge/view/front_seconds",
        "judge/view/is_seen_from_behind", "judge/view/is_seen_from_front", "judge/was_achieved",
        "judge/was_completed", "judge/dissection/facts/is_triangle_in_view",
        "judge/dissection/facts/skeletonised", "judge/dissection/facts/structures_entering",
        "judge/dissection/first_azimuth", "judge/dissection/has_looked", "judge/dissection/neck_turn"}},
      {"blood, bile, stones, bag and the freed gallbladder: no task has them",
       {"operation/bag_hand", "operation/fluids/aspirated", "operation/fluids/left",
        "operation/fluids/pooled", "operation/fluids/rinse_aspirated", "operation/fluids/rinse_pooled",
        "operation/holes/count", "operation/is_completed", "operation/is_in_bag", "operation/leaked_seen",
        "operation/ooze/lost", "operation/ooze/rate", "operation/open_area", "operation/stones/carried",
        "operation/stones/has_taken", "operation/stones/held", "operation/stones/stones"}},
      {"the vessels of a patient, which no task has",
       {"arc_of", "operation/vessels/acts/openings", "operation/vessels/ends",
        "operation/vessels/network/pressure", "operation/vessels/network/supply",
        "operation/vessels/report/leak_count", "operation/vessels/report/rate", "tube_of",
        "tubes/graph/edges", "tubes/graph/is_cut_end", "tubes/graph/radii", "tubes/graph/rest",
        "tubes/next_spare", "tubes/nodes"}},
      {"a clip has to slip off its vessel",
       {"operation/vessels/acts/clips/vessel", "operation/vessels/clips/is_lost",
        "operation/vessels/clips/loose/anchor", "operation/vessels/clips/loose/offset",
        "operation/vessels/clips/loose/position", "operation/vessels/clips/loose/still_seconds",
        "operation/vessels/clips/loose/support", "operation/vessels/clips/loose/triangle",
        "operation/vessels/clips/loose/upright", "operation/vessels/clips/loose/velocity",
        "operation/vessels/clips/loose/weights", "operation/vessels/clips/tube"}},
      {"a sheet has to be parted", {"operation/sheets/is_free", "operation/sheets/off_area"}},
      {"these surgeons hold the other tool in this hand, or none that has it",
       {"operation/active_tools",
        "operation/left_hand/blade/has_edge",
        "operation/left_hand/blade/jaw",
        "operation/left_hand/caught",
        "operation/left_hand/clips",
        "operation/left_hand/exchange_seconds",
        "operation/left_hand/fronts/count",
        "operation/left_hand/fronts/tips",
        "operation/left_hand/has_clip_open",
        "operation/left_hand/has_current",
        "operation/left_hand/idle_seconds",
        "operation/left_hand/opened",
        "operation/left_hand/spread_lower/has_edge",
        "operation/left_hand/spread_lower/jaw",
        "operation/left_hand/spread_upper/has_edge",
        "operation/left_hand/spread_upper/jaw",
        "operation/left_hand/was_open",
        "operation/left_hand/was_refused",
        "operation/left_hand/was_outside_emitted",
        "operation/right_hand/blade/jaw",
        "operation/right_hand/exchange_seconds",
        "operation/right_hand/idle_seconds",
        "operation/right_hand/spread_lower/has_edge",
        "operation/right_hand/spread_lower/jaw",
        "operation/right_hand/spread_upper/has_edge",
        "operation/right_hand/spread_upper/jaw",
        "operation/right_hand/was_refused",
        "operation/right_hand/was_outside_emitted"}},
  };
  return exceptions;
}

/// Fields that the next tick makes anew from the others at every such point.
const std::vector<Exceptions>& MadeAnew() {
  static const std::vector<Exceptions> exceptions = {
      {"taken up where a tick goes wrong (recovery_test.cpp)",
       {"good_conserved/intact_links", "good_conserved/last_motion", "good_conserved/last_position",
        "good_conserved/organs/leaked", "good_conserved/organs/opening_area",
        "good_conserved/organs/pressure", "good_conserved/organs/target", "guard/good"}},
      {"read where a piece of tissue is free", {"conserved/last_position"}},
      {"follows the settings of the tick; kept for what is compared with it",
       {"conserved/responses/shape_scale", "conserved/responses/stiffness_scale"}},
      {"decides where a contact goes on with friction or as the initial guess; at these points it is found "
       "anew",
       {"contacts/X_world_device", "contacts/are_tools_touching", "contacts/contacts/hand",
        "contacts/contacts/is_friction", "contacts/contacts/is_pinch", "contacts/contacts/key",
        "contacts/contacts/nodes", "contacts/contacts/normal", "contacts/contacts/normal_force",
        "contacts/contacts/offset", "contacts/contacts/p_device", "contacts/contacts/p_tool_stuck",
        "contacts/contacts/stiffness", "contacts/contacts/surface", "contacts/contacts/weights",
        "contacts/pairs/is_inside"}},
      {"of the last tick, for those who look at a restored state before its next tick",
       {"forces", "gravity", "iterations", "judge/view/criteria", "judge/dissection/facts/cleared_share",
        "judge/dissection/facts/detached_share", "judge/dissection/facts/view_azimuth", "laparoscope",
        "operation/X_world_tools", "operation/is_gallbladder_free", "organ_volume", "residual",
        "task/goals/is_open", "task/phase", "task/score", "touched_organs"}},
      {"of the last tick: what has changed since is found by it, and at these points nothing has",
       {"grasps/pinch", "operation/right_hand/blade/a", "operation/right_hand/blade/b",
        "operation/right_hand/has_current", "rigid/bodies/touched", "rigid/forces", "rigid/jaw_before",
        "rigid/obstacle_force", "rigid/obstacles", "rigid/pinch", "rigid/wanted_jaw", "task_monitor/from",
        "task_monitor/held_by", "task_monitor/to"}},
      {"heat parts what it has parted again", {"tissue/strand_is_intact"}},
  };
  return exceptions;
}

/// Leaves out one field after the other, as a control of what a state holds.
struct FieldControl {
  std::set<std::string> all;
  std::set<std::string> needed;    ///< without it a restored state is another one, or is refused
  std::set<std::string> decisive;  ///< nor does the next tick make it anew

  /// A group of fields counts as one field where it is empty: not where another course has fields in it.
  void RemoveGroups() {
    for (auto field = all.begin(); field != all.end();) {
      const auto inside = all.lower_bound(*field + "/");
      const bool is_group = inside != all.end() && inside->compare(0, field->size() + 1, *field + "/") == 0;
      if (is_group) needed.erase(*field), decisive.erase(*field);
      field = is_group ? all.erase(field) : std::next(field);
    }
  }
};

/// Whether the next tick comes to the same state without the field that was left out. Such a state need not fit together, and
/// the tick may crash: it has a process of its own.
bool IsMadeAnew(Simulation& without, const Input& input, std::uint64_t hash_next) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(STDERR_FILENO);
    ::alarm(60);
    without.Step(input);
    ::_exit(without.Hash() == hash_next ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Leaves out each field that a point has changed from how it begins.
void CheckFields(const Recording& recording, const Point& point, FieldControl& control) {
  Simulation fresh = std::move(*Simulation::Make(recording.model, 1));
  const std::map<std::string, std::uint64_t> at_start = HashByField(fresh);
  ASSERT_TRUE(fresh.Restore(point.bytes).ok());
  const std::map<std::string, std::uint64_t> restored = HashByField(fresh);
  fresh.Step(recording.inputs[point.tick]);
  const std::uint64_t hash_next = fresh.Hash();
  for (const auto& [field, hash] : restored) {
    control.all.insert(field);
    if (control.decisive.count(field) != 0) continue;
    const auto before = at_start.find(field);
    if (before != at_start.end() && before->second == hash) continue;
    fresh.Reset();
    // what does not fit the rest is refused, which is as good
    if (!fresh.RestoreWithout(point.bytes, field).ok()) {
      control.needed.insert(field), control.decisive.insert(field);
      continue;
    }
    if (fresh.Hash() == point.hash) continue;
    control.needed.insert(field);
    if (!IsMadeAnew(fresh, recording.inputs[point.tick], hash_next)) control.decisive.insert(field);
  }
}

/// Those of `fields` that are not in `of`.
std::set<std::string> Without(const std::set<std::string>& fields, const std::set<std::string>& of) {
  std::set<std::string> rest;
  std::set_difference(fields.begin(), fields.end(), of.begin(), of.end(), std::inserter(rest, rest.end()));
  return rest;
}

std::set<std::string> Merge(const std::vector<Exceptions>& exceptions) {
  std::set<std::string> all;
  for (const Exceptions& some : exceptions) all.insert(some.fields.begin(), some.fields.end());
  return all;
}

std::string Join(const std::set<std::string>& fields) {
  std::string text;
  for (const std::string& field : fields) text += "\n  " + field;
  return text;
}

// A sample of the control below.
TEST(SimulationStateFields, EachThatASampleChangesIsNeeded) {
  FieldControl control;
  for (const Course& course :
       {Course{"pattern_cut", "expert", 1600, 2}, Course{"clip_and_cut", "crosses_clips", 1500, 1},
        Course{"hook_dissection", "expert", 900, 1}, Course{"peg_transfer", "expert", 700, 1},
        Course{"retraction", "", 400, 1}}) {
    const Recording recording = Record(course, ReadCourse(course));
    ASSERT_FALSE(recording.points.empty());
    CheckFields(recording, recording.points.back(), control);
  }
  EXPECT_GT(control.needed.size(), control.all.size() / 3)
      << control.needed.size() << " of " << control.all.size();
}

// Control: without any one of its fields a restored state is another one, and the next tick does not make the field anew.
TEST(SimulationStateFieldsSlow, EachIsNeeded) {
  FieldControl control;
  for (const Course& course :
       {Course{"retraction", "", 3000, 2}, Course{"retraction", "", 900, 6, false, true},
        Course{"tearing", "", 1500, 2}, Course{"demonstration", "", 1500, 2},
        Course{"camera_navigation_30", "expert", 1600, 2}, Course{"clip_and_cut", "crosses_clips", 1800, 2},
        Course{"hook_dissection", "burns_spared", 1100, 2},
        Course{"instrument_navigation", "clashes", 2400, 2}, Course{"lift_and_grasp", "drops", 2400, 2},
        Course{"object_transport", "pulls_apart", 2400, 2}, Course{"pattern_cut", "cuts_aside", 2200, 2},
        Course{"peg_transfer", "loses", 4000, 2}, Course{"wire_run", "touches_wire", 2400, 2}}) {
    const Recording recording = Record(course, ReadCourse(course));
    for (const Point& point : recording.points) CheckFields(recording, point, control);
  }
  control.RemoveGroups();
  const std::set<std::string> unchanged = Merge(Unchanged()), made_anew = Merge(MadeAnew());
  const std::set<std::string> missed = Without(control.all, control.needed);
  EXPECT_TRUE(Without(missed, unchanged).empty())
      << "no course changes these; let one change them, or say why not in Unchanged():"
      << Join(Without(missed, unchanged));
  const std::set<std::string> undecisive = Without(control.needed, control.decisive);
  EXPECT_TRUE(Without(undecisive, made_anew).empty())
      << "the next tick makes these anew; let them be scratch, or say why not in MadeAnew():"
      << Join(Without(undecisive, made_anew));
  for (const auto& listed : {unchanged, made_anew})
    EXPECT_TRUE(Without(listed, control.all).empty())
        << "no such field:" << Join(Without(listed, control.all));
  RecordProperty("fields", std::to_string(control.all.size()));
  RecordProperty("needed", std::to_string(control.needed.size()));
  RecordProperty("decisive", std::to_string(control.decisive.size()));
  RecordProperty("needed_though_listed", Join(Without(unchanged, missed)));
}

// Judging, publishing and task rules change nothing of the world.
TEST(SimulationWorld, IsTheSameWithoutThoseWhoLook) {
  for (const Course& course :
       {Course{"pattern_cut", "expert", 1200, 1}, Course{"clip_and_cut", "crosses_clips", 1200, 1},
        Course{"peg_transfer", "expert", 600, 1}}) {
    const Recording recording = Record(course, ReadCourse(course));
    Simulation judged = std::move(*Simulation::Make(recording.model, 1));
    Simulation alone = std::move(*Simulation::Make(recording.model, 1));
    for (const Input& input : recording.inputs) {
      judged.Step(input);
      alone.StepWorld(input);
    }
    EXPECT_EQ(alone.Hash(StatePart::kWorld), judged.Hash(StatePart::kWorld)) << course.name;
    EXPECT_NE(alone.Hash(), judged.Hash()) << course.name << ": the control; nothing was judged";
  }
}

TEST(SimulationStateBytes, RefusesWhatIsDamagedOrOfAnotherModel) {
  const auto scene = ReadDelivered("hook_dissection");
  Simulation simulation = std::move(*Simulation::Make(scene, 1));
  std::vector<std::byte> bytes;
  simulation.Save(bytes);
  const std::uint64_t hash = simulation.Hash();
  const auto refuses = [&](std::span<const std::byte> damaged) {
    const core::Status restored = simulation.Restore(damaged);
    return !restored.ok() && restored.error().code == core::ErrorCode::kStateInvalid;
  };
  for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97)
    EXPECT_TRUE(refuses(std::span(bytes).first(length))) << length;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 101) {
    bytes[at] ^= std::byte{0x10};
    EXPECT_TRUE(refuses(bytes)) << "byte " << at;
    bytes[at] ^= std::byte{0x10};
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back({});
  EXPECT_TRUE(refuses(longer));
  Simulation other = std::move(*Simulation::Make(ReadDelivered("clip_and_cut"), 1));
  EXPECT_FALSE(other.Restore(bytes).ok());
  EXPECT_EQ(simulation.Hash(), hash) << "what was refused has changed nothing";
  EXPECT_TRUE(simulation.Restore(bytes).ok());
}

std::size_t ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * 4096;
}

// One more simulation of a model adds its state and scratch alone.
TEST(SimulationModelMemory, IsShared) {
  const auto scene = ReadCourse({"cholecystectomy", "", 0, 0});
  auto model = MakeSimulationModel(scene);
  ASSERT_TRUE(model.ok());
  std::vector<Simulation> simulations;
  simulations.push_back(std::move(*Simulation::Make(*model, 1)));
  const std::size_t before = ResidentBytes();
  constexpr std::size_t kMore = 8;
  for (std::size_t i = 0; i < kMore; ++i) simulations.push_back(std::move(*Simulation::Make(*model, 1)));
  const double each_mb = static_cast<double>(ResidentBytes() - before) / kMore * 1e-6;
  std::vector<std::byte> bytes;
  simulations.back().Save(bytes);
  RecordProperty("mb_each", std::to_string(each_mb));
  RecordProperty("state_bytes", std::to_string(bytes.size()));
  EXPECT_LT(each_mb, 30.0);
  EXPECT_LT(bytes.size(), 5'000'000U);
  EXPECT_EQ(&simulations.front().Surfaces()[0], &simulations.back().Surfaces()[0]);
}

}  // namespace
}  // namespace trocar::agent
