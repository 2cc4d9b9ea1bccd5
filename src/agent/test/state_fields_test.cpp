// SPDX-License-Identifier: Apache-2.0
// The control of saving and restoring: without any one of its fields a restored state goes another way, or is seen otherwise.
// state_fields.txt says of each field which course notices that it is missing.
//
// What a field decides is looked for outside of the field: in the other fields and in what is published. So a field that is
// neither saved nor hashed would be noticed as well, by SimulationState.GoesOnToTheSameBits, and a field that nobody reads is
// found to be none of the state.
//
// With TROCAR_STATE_FIELDS_SEARCH=1 in the environment the slow courses also look for the fields that the table knows nowhere, which
// takes many times as long.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "course.h"

namespace trocar::agent {
namespace {

using Fields = std::set<std::string>;

/// How a state without a field differs from the whole one. The greater one proves more.
enum class Effect : int {
  kNone = 0,    ///< not at all, or in nothing but the field
  kKeeps = 1,   ///< a tick or more later, still in the field itself alone
  kShows = 2,   ///< in what is published when it has been restored; the next tick makes the field anew
  kDecides = 3  ///< a tick or more later, in another field or in what is published
};

const std::map<std::string, Effect>& EffectNames() {
  static const std::map<std::string, Effect> names{
      {"keeps", Effect::kKeeps}, {"shows", Effect::kShows}, {"decides", Effect::kDecides}};
  return names;
}

/// state_fields.txt: a line each of course, "decides", "shows" or "keeps", and field; or "nowhere", field, and the reason.
struct Table {
  std::map<std::string, std::map<std::string, Effect>> by_course;
  Fields proved, unproved;

  /// The field, or a list that it is in.
  bool IsUnproved(const std::string& field) const {
    return std::any_of(unproved.begin(), unproved.end(), [&](const std::string& listed) {
      return field.compare(0, listed.size(), listed) == 0 &&
             (field.size() == listed.size() || field[listed.size()] == '/');
    });
  }
};

Table ReadTable() {
  Table table;
  std::ifstream file(std::filesystem::path(TROCAR_SOURCE_DIR) / "src/agent/test/state_fields.txt");
  EXPECT_TRUE(file.good());
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string course, how, field, more;
    words >> course >> how >> field;
    if (course == "nowhere") {
      EXPECT_FALSE(field.empty()) << "has no reason: " << line;
      EXPECT_TRUE(table.unproved.insert(how).second) << "twice: " << line;
      continue;
    }
    EXPECT_TRUE(!field.empty() && !(words >> more) && EffectNames().contains(how)) << line;
    EXPECT_TRUE(table.proved.insert(field).second) << "twice: " << line;
    table.by_course[course][field] = EffectNames().at(how);
  }
  return table;
}

/// What has fields of its own in another state: an empty list counts as one field where it is empty.
bool IsGroup(const std::string& field, const Fields& all) {
  const auto inside = all.lower_bound(field + "/");
  return inside != all.end() && inside->compare(0, field.size() + 1, field + "/") == 0;
}

/// Fields of one name, as those of all organs, are one.
using FieldHashes = std::map<std::string, std::uint64_t>;

FieldHashes HashByField(const Simulation& simulation) {
  FieldHashes fields;
  for (const auto& [field, hash] : simulation.HashFields()) {
    core::StateHash both;
    both.Add(fields[field]);
    both.Add(hash);
    fields[field] = both.Value();
  }
  return fields;
}

/// A simulation at one moment.
struct Moment {
  std::uint64_t hash = 0, published = 0;
  FieldHashes fields;
};

Moment Look(const Simulation& simulation) {
  return {simulation.Hash(), CalcPublishedHash(simulation), HashByField(simulation)};
}

/// Whether anything differs besides the field. Groups are not compared: they hash as empty lists alone.
bool DiffersOutside(const std::string& field, const Moment& whole, const Simulation& without) {
  if (CalcPublishedHash(without) != whole.published) return true;
  if (without.Hash() == whole.hash) return false;
  FieldHashes fields = HashByField(without), expected = whole.fields;
  fields.erase(field), expected.erase(field);
  return fields != expected;
}

/// Ticks after which a state without a field is compared; the last two only where nothing else has become different before.
constexpr std::array kLooks{1, 2, 12, 80};

/// What the hands do from a point on, and what comes of it.
struct Future {
  std::vector<Input> inputs;
  std::array<Moment, kLooks.size()> moments;
};

/// Leaves out fields at one point of a course.
class PointControl {
 public:
  PointControl(const Recording& recording, const Point& point)
      : point_(point), simulation_(std::move(*Simulation::Make(recording.model, 1))) {
    simulation_.Save(others_[0].bytes);
    others_[0].fields = HashByField(simulation_);
    EXPECT_TRUE(simulation_.Restore(point.bytes).ok());
    saved_ = HashByField(simulation_);
    Fumbler fumbler(point.tick + 1);
    for (int tick = 0; tick < kGoesOn; ++tick)
      simulation_.Step(fumbler.Act(simulation_.GetScene(), simulation_.GetSnapshot()));
    simulation_.Save(others_[1].bytes);
    others_[1].fields = HashByField(simulation_);
    for (std::size_t way = 0; way < futures_.size(); ++way) {
      Future& future = futures_[way];
      for (int tick = 0; tick < kLooks.back(); ++tick) {
        future.inputs.push_back(recording.inputs[std::min(point.tick + static_cast<std::size_t>(tick),
                                                          recording.inputs.size() - 1)]);
        // one bad tick: what is taken back then is of the state, too
        if (way == 1 && tick == 0) future.inputs.back().settings.solver = DivergingSolver();
      }
      EXPECT_TRUE(simulation_.Restore(point.bytes).ok());
      GoOn(future, [&](std::size_t look) {
        future.moments[look] = Look(simulation_);
        return true;
      });
    }
    EXPECT_TRUE(simulation_.Restore(point.bytes).ok());
    CheckWhole();
  }

  const FieldHashes& Saved() const { return saved_; }

  /// Of a field that has another value in the state that is replaced: at the start, or where other hands have gone. Nothing where
  /// it has the same in both.
  std::optional<Effect> LeaveOut(const std::string& field) {
    std::optional<Effect> most;
    for (const State& other : others_) {
      const auto value = other.fields.find(field);
      if (value != other.fields.end() && value->second == saved_.at(field)) continue;
      for (const Future& future : futures_) {
        most = std::max(most.value_or(Effect::kNone), InProcess([&] { return Play(other, field, future); }));
        if (most == Effect::kDecides) return most;
      }
    }
    return most;
  }

 private:
  struct State {
    std::vector<std::byte> bytes;
    FieldHashes fields;
  };

  /// The control of the control: with nothing left out, the same comes of it.
  void CheckWhole() {
    for (const State& other : others_) {
      for (const Future& future : futures_) {
        EXPECT_TRUE(simulation_.Restore(other.bytes).ok());
        EXPECT_TRUE(simulation_.Restore(point_.bytes).ok());
        GoOn(future, [&](std::size_t look) {
          const Moment &whole = future.moments[look], now = Look(simulation_);
          std::string different = now.published != whole.published ? " published" : "";
          for (const auto& [field, hash] : now.fields) {
            const auto expected = whole.fields.find(field);
            if (expected == whole.fields.end() || expected->second != hash) different += " " + field;
          }
          EXPECT_EQ(different, "") << "nothing was left out, tick " << point_.tick << ", " << kLooks[look]
                                   << " later; over the state "
                                   << (&other == &others_[0] ? "of the start" : "where other hands have gone")
                                   << (&future == &futures_[0] ? "" : "; a bad tick");
          return different.empty();
        });
      }
    }
    EXPECT_TRUE(simulation_.Restore(point_.bytes).ok());
  }

  /// \param look  called with the number of each of kLooks; whether to go on
  template <typename F>
  void GoOn(const Future& future, F&& look) {
    std::size_t next = 0;
    for (int tick = 0; tick < kLooks.back(); ++tick) {
      simulation_.Step(future.inputs[static_cast<std::size_t>(tick)]);
      if (tick + 1 == kLooks[next] && !look(next++)) return;
    }
  }

  Effect Play(const State& other, const std::string& field, const Future& future) {
    if (!simulation_.Restore(other.bytes).ok()) return Effect::kNone;
    // what does not fit the rest is refused, which is as good
    if (!simulation_.RestoreWithout(point_.bytes, field).ok()) return Effect::kDecides;
    if (simulation_.Hash() == point_.hash) return Effect::kNone;  // is made anew in restoring
    Effect effect = CalcPublishedHash(simulation_) != point_.published ? Effect::kShows : Effect::kNone;
    GoOn(future, [&](std::size_t look) {
      if (DiffersOutside(field, future.moments[look], simulation_)) {
        effect = Effect::kDecides;
      } else if (simulation_.Hash() != future.moments[look].hash) {
        effect = std::max(effect, Effect::kKeeps);
      }
      return effect <= Effect::kKeeps || (effect == Effect::kShows && look == 0);
    });
    return effect;
  }

  /// Without one of its fields a state need not fit together, and what is done with it may crash: it has a process of its own.
  template <typename F>
  static Effect InProcess(F&& play) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(STDERR_FILENO);
      ::alarm(300);
      ::_exit(static_cast<int>(play()));
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WIFEXITED(status)) return static_cast<Effect>(std::clamp(WEXITSTATUS(status), 0, 3));
    return WTERMSIG(status) == SIGALRM ? Effect::kNone : Effect::kDecides;
  }

  const Point& point_;
  Simulation simulation_;
  FieldHashes saved_;
  std::array<State, 2> others_;
  std::array<Future, 2> futures_;
};

/// What the fields of a course that are not proved by another one do in it.
struct Found {
  std::map<std::string, Effect> effects;
};

/// At how many points of a course a field is left out that the table does not expect there.
constexpr int kTries = 3;

Found LeaveOutEach(const Recording& recording, const Table& table,
                   const std::map<std::string, Effect>& listed, bool looks_for_unproved) {
  Found found;
  std::map<std::string, int> tries;
  for (const Point& point : recording.points) {
    const auto is_open = [&](const std::string& field) {
      if (!listed.contains(field) &&
          (table.proved.contains(field) || IsGroup(field, table.proved) || IsGroup(field, table.unproved)))
        return false;
      if (const auto wanted = listed.find(field); wanted != listed.end())
        return found.effects[field] < wanted->second;
      if (tries[field] >= kTries || (!looks_for_unproved && table.IsUnproved(field))) return false;
      return found.effects[field] < Effect::kDecides;
    };
    PointControl control(recording, point);
    for (const auto& [field, hash] : control.Saved()) {
      if (!is_open(field)) continue;
      const std::optional<Effect> effect = control.LeaveOut(field);
      if (!effect) continue;
      ++tries[field];
      Effect& most = found.effects[field];
      if (looks_for_unproved && *effect > most)
        std::cout << "missed: " << field << std::endl;  // at once: a search may be stopped
      most = std::max(most, *effect);
    }
  }
  return found;
}

void CheckCourse(const Course& course, const std::string& name) {
  const Table table = ReadTable();
  const bool looks_for_unproved = std::getenv("TROCAR_STATE_FIELDS_SEARCH") != nullptr;
  const auto entry = table.by_course.find(name);
  const std::map<std::string, Effect> listed =
      entry != table.by_course.end() ? entry->second : std::map<std::string, Effect>{};
  EXPECT_FALSE(listed.empty() && table.unproved.empty()) << name << " is there for no field";
  const Recording recording = Record(course, ReadCourse(course));
  ASSERT_FALSE(recording.points.empty());
  Found found = LeaveOutEach(recording, table, listed, looks_for_unproved);
  for (const auto& [field, effect] : listed)
    EXPECT_GE(found.effects[field], effect) << field << ": left out, nothing else differs";
  for (const auto& [field, effect] : found.effects) {
    if (listed.contains(field)) continue;
    std::string line = name;
    for (const auto& [how, named] : EffectNames()) line += named == effect ? " " + how + " " + field : "";
    if (table.IsUnproved(field)) {
      if (effect != Effect::kNone)
        std::cout << "can take the place of a line of \"nowhere\": " << line << "\n";
      continue;
    }
    EXPECT_EQ(effect, Effect::kNone) << "add to state_fields.txt: " << line;
    EXPECT_NE(effect, Effect::kNone) << field << " is new, and nothing else differs without it in " << name
                                     << ": let a course notice it";
  }
}

class StateFields : public testing::TestWithParam<Course> {};
TEST_P(StateFields, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(Courses, StateFields,
                         testing::Values(Course{"pattern_cut", "expert", 1600, 2, 4},
                                         Course{"peg_transfer", "fumbler", 700, 2, 4}),
                         NameOf);

class StateFieldsSlow : public testing::TestWithParam<Course> {};
TEST_P(StateFieldsSlow, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(
    Courses, StateFieldsSlow,
    testing::Values(
        Course{"retraction", "", 3000, 2, 4}, Course{"retraction", "", 900, 6, 0, true},
        Course{"retraction", "fumbler", 700, 4, 4}, Course{"demonstration", "", 1500, 2, 4},
        Course{"tearing", "", 1500, 2, 4}, Course{"peg_transfer", "loses", 4000, 2, 4},
        Course{"camera_navigation_30", "expert", 1600, 2, 4},
        Course{"clip_and_cut", "crosses_clips", 1800, 2, 4}, Course{"clip_and_cut", "fumbler", 1500, 6, 4},
        Course{"hook_dissection", "burns_spared", 1100, 2, 4},
        Course{"hook_dissection", "fumbler", 1500, 6, 4},
        Course{"instrument_navigation", "clashes", 2400, 2, 4}, Course{"lift_and_grasp", "drops", 2400, 2, 4},
        Course{"object_transport", "pulls_apart", 2400, 2, 4},
        Course{"pattern_cut", "cuts_aside", 2200, 2, 4}, Course{"pattern_cut", "fumbler", 1500, 6, 4},
        Course{"wire_run", "touches_wire", 2400, 2, 4}, Course{"cholecystectomy", "fumbler", 1500, 6, 0},
        Course{"cholecystectomy", "slips_clip", 2700, 3, 2, false, 1250},
        Course{"cholecystectomy", "expert", 900, 3, 1, false, 300},
        Course{"peg_transfer", "loses", 5000, 2, 6, false, 1500},
        Course{"clip_and_cut", "fumbler", 4000, 6, 16, false, 200, true},
        Course{"hook_dissection", "fumbler", 4000, 8, 8, false, 200, true},
        Course{"pattern_cut", "fumbler", 4000, 8, 16, false, 200, true}),
    NameOf);

class StateFieldsWhole : public testing::TestWithParam<Course> {};
TEST_P(StateFieldsWhole, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(Courses, StateFieldsWhole,
                         testing::Values(Course{"cholecystectomy", "leaves_stones", 60'000, 16, 0}), NameOf);

// Every field that a scene begins with stands in the table.
TEST(StateFieldsTable, ListsEach) {
  const Table table = ReadTable();
  for (const char* name : {"retraction", "tearing", "cholecystectomy", "clip_and_cut", "hook_dissection",
                           "pattern_cut", "peg_transfer", "camera_navigation_30", "wire_run"}) {
    const Simulation simulation = std::move(*Simulation::Make(ReadCourse({name, "", 0, 0}), 1));
    for (const auto& [field, hash] : simulation.HashFields())
      EXPECT_TRUE(table.proved.contains(field) || table.IsUnproved(field) || IsGroup(field, table.proved) ||
                  IsGroup(field, table.unproved))
          << field << " of " << name;
  }
}

}  // namespace
}  // namespace trocar::agent
