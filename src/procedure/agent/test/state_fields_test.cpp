// SPDX-License-Identifier: Apache-2.0
// The control of saving and restoring: without any one of its fields a restored state goes another way, or is seen otherwise.
// state_fields.txt says of each field which course notices that it is missing.
//
// What a field decides is looked for outside of the field: in the other fields and in what is published. So a field that is
// neither saved nor hashed would be noticed as well, by SimulationState.GoesOnToTheSameBits, and a field that nobody reads is
// found to be none of the state.
//
// With the beginning of a field's name in TROCAR_STATE_FIELDS_SEARCH the courses look for such fields instead, at all their points.
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

using simulation::Simulation;

namespace {

using Fields = std::set<std::string>;

/// How a state without a field differs from the whole one. The greater one proves more.
enum class Effect : int {
  kNone = 0,    ///< in nothing but the field, which the next tick makes anew
  kKeeps = 1,   ///< a tick or more later, still in the field itself alone
  kShows = 2,   ///< in what is published or cut for the haptic loop when it has been restored, not later
  kDecides = 3  ///< a tick or more later, in another field or in what is published
};

const std::map<std::string, Effect>& EffectNames() {
  static const std::map<std::string, Effect> names{
      {"keeps", Effect::kKeeps}, {"shows", Effect::kShows}, {"decides", Effect::kDecides}};
  return names;
}

/// state_fields.txt: a line each of course, "decides", "shows" or "keeps", and field; or of course, "scratch", field and reason;
/// or of "same", field and reason.
struct Table {
  std::map<std::string, std::map<std::string, Effect>> by_course;
  std::map<std::string, Fields> scratch;  ///< by course
  Fields proved;                          ///< those of both, and of "same"
  Fields same;

  template <typename T>
  static T Of(const std::map<std::string, T>& by_course, const std::string& course) {
    const auto entry = by_course.find(course);
    return entry != by_course.end() ? entry->second : T{};
  }
};

void AddLine(const std::string& line, Table& table) {
  std::istringstream words(line);
  std::string first, second, third, more;
  words >> first >> second >> third >> more;
  const bool is_same = first == "same";
  const bool has_reason = is_same || second == "scratch";
  const std::string& field = is_same ? second : third;
  EXPECT_EQ(has_reason, is_same ? !third.empty() : !more.empty()) << "its reason: " << line;
  EXPECT_TRUE(table.proved.insert(field).second) << "twice: " << line;
  if (is_same) {
    table.same.insert(field);
  } else if (second == "scratch") {
    table.scratch[first].insert(field);
  } else {
    EXPECT_TRUE(EffectNames().contains(second)) << line;
    table.by_course[first][field] = EffectNames().at(second);
  }
}

Table ReadTable() {
  Table table;
  std::ifstream file(std::filesystem::path(TROCAR_SOURCE_DIR) / "src/procedure/agent/test/state_fields.txt");
  EXPECT_TRUE(file.good());
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#') AddLine(line, table);
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
    base::StateHash both;
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

/// What differs from the whole state. Groups are not compared: they hash as empty lists alone.
enum class Difference : int { kNone, kInField, kOutside };

Difference Compare(const std::string& field, const Moment& whole, const Simulation& without) {
  if (CalcPublishedHash(without) != whole.published) return Difference::kOutside;
  if (without.Hash() == whole.hash) return Difference::kNone;
  FieldHashes fields = HashByField(without), expected = whole.fields;
  fields.erase(field), expected.erase(field);
  return fields != expected ? Difference::kOutside : Difference::kInField;
}

/// Ticks after which a state without a field is compared; the last two only where nothing else has become different before.
constexpr std::array kLooks{1, 2, 12, 80};

/// What the hands do from a point on, and what comes of it.
struct Future {
  std::vector<scene::Input> inputs;
  std::array<Moment, kLooks.size()> moments;
};

/// Leaves out fields at one point of a course.
class PointControl {
 public:
  PointControl(const Recording& recording, const Point& point)
      : recording_(recording), point_(point), simulation_(std::move(*Simulation::Make(recording.model))) {
    simulation_.Save(others_[0].bytes);
    others_[0].fields = HashByField(simulation_);
    EXPECT_TRUE(simulation_.Restore(point.bytes).ok());
    saved_ = HashByField(simulation_);
    patches_ = CalcPatchHash(simulation_);
  }

  /// Before LeaveOut: goes on with the whole state, as long as one is looked at without a field.
  void Prepare() {
    Fumbler fumbler(point_.tick + 1);
    for (int tick = 0; tick < kGoesOn; ++tick)
      simulation_.Step(fumbler.Act(simulation_.GetScene(), simulation_.GetSnapshot()));
    simulation_.Save(others_[1].bytes);
    others_[1].fields = HashByField(simulation_);
    for (std::size_t way = 0; way < futures_.size(); ++way) {
      Future& future = futures_[way];
      for (int tick = 0; tick < kLooks.back(); ++tick) {
        const std::size_t at = point_.tick + static_cast<std::size_t>(tick);
        future.inputs.push_back(recording_.inputs[std::min(at, recording_.inputs.size() - 1)]);
        // one bad tick: what is taken back then is of the state, too
        if (way == 1 && tick == 0) future.inputs.back().settings.solver = DivergingSolver();
      }
      EXPECT_TRUE(simulation_.Restore(point_.bytes).ok());
      GoOn(future, [&](std::size_t look) {
        future.moments[look] = Look(simulation_);
        return true;
      });
    }
    for (std::size_t other = 0; other < 2; ++other) CheckWhole(other);
  }

  const FieldHashes& Saved() const { return saved_; }
  /// Whether the field is as it was at the start, where it was there.
  bool IsAsAtStart(const std::string& field) const {
    const auto value = others_[0].fields.find(field);
    return value == others_[0].fields.end() || value->second == saved_.at(field);
  }

  /// Of a field that has another value in the state that is replaced: at the start, where other hands have gone, or at the end
  /// of the course. Nothing where it has the same in all, or is made anew in restoring.
  /// \param tries_same  also where it has the same value: restoring other fields may change it on the way
  std::optional<Effect> LeaveOut(const std::string& field, bool tries_same = false) {
    std::optional<Effect> most;
    for (std::size_t i = 0; i < others_.size(); ++i) {
      const State& other = Other(i);
      const auto value = other.fields.find(field);
      if (!tries_same && value != other.fields.end() && value->second == saved_.at(field)) continue;
      for (const Future& future : futures_) {
        const std::optional<Effect> effect = InProcess([&] { return Play(other, field, future); });
        if (effect) most = std::max(most.value_or(Effect::kNone), *effect);
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

  /// The end of the course is looked at where it is asked for: most fields need it not.
  const State& Other(std::size_t i) {
    State& other = others_[i];
    if (i < 2 || !other.bytes.empty()) return other;
    const auto& points = recording_.points;
    other.bytes = (&point_ == &points.back() ? points.front() : points.back()).bytes;
    EXPECT_TRUE(simulation_.Restore(other.bytes).ok());
    other.fields = HashByField(simulation_);
    CheckWhole(i);
    return other;
  }

  /// The control of the control: with nothing left out, the same comes of it.
  void CheckWhole(std::size_t over) {
    static constexpr std::array kOver{"the start", "where other hands have gone", "the end"};
    for (const Future& future : futures_) {
      EXPECT_TRUE(simulation_.Restore(others_[over].bytes).ok());
      EXPECT_TRUE(simulation_.Restore(point_.bytes).ok());
      EXPECT_EQ(CalcPatchHash(simulation_), patches_) << "of the haptic loop, tick " << point_.tick;
      GoOn(future, [&](std::size_t look) {
        const Moment &whole = future.moments[look], now = Look(simulation_);
        std::string different = now.published != whole.published ? " published" : "";
        for (const auto& [field, hash] : now.fields) {
          const auto expected = whole.fields.find(field);
          if (expected == whole.fields.end() || expected->second != hash) different += " " + field;
        }
        EXPECT_EQ(different, "") << "nothing was left out, tick " << point_.tick << ", " << kLooks[look]
                                 << " later; over the state of " << kOver[over]
                                 << (&future == &futures_[0] ? "" : "; a bad tick");
        return different.empty();
      });
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

  std::optional<Effect> Play(const State& other, const std::string& field, const Future& future) {
    if (!simulation_.Restore(other.bytes).ok()) return std::nullopt;
    // what does not fit the rest is refused, which is as good
    if (!simulation_.RestoreWithout(point_.bytes, field).ok()) return Effect::kDecides;
    if (simulation_.Hash() == point_.hash) return std::nullopt;
    const bool is_shown =
        CalcPublishedHash(simulation_) != point_.published || CalcPatchHash(simulation_) != patches_;
    Effect effect = is_shown ? Effect::kShows : Effect::kNone;
    GoOn(future, [&](std::size_t look) {
      const Difference now = Compare(field, future.moments[look], simulation_);
      if (now == Difference::kOutside) effect = Effect::kDecides;
      if (now == Difference::kInField) effect = std::max(effect, Effect::kKeeps);
      // what is the same in all fields stays the same
      if (now != Difference::kInField) return false;
      return effect == Effect::kKeeps || look == 0;
    });
    return effect;
  }

  /// Without one of its fields a state need not fit together, and what is done with it may crash: it has a process of its own.
  template <typename F>
  static std::optional<Effect> InProcess(F&& play) {
    static constexpr int kNothing = 9;
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(STDERR_FILENO);
      ::alarm(300);
      const std::optional<Effect> effect = play();
      ::_exit(effect ? static_cast<int>(*effect) : kNothing);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFEXITED(status)) {
      if (WTERMSIG(status) == SIGALRM) return std::nullopt;
      return Effect::kDecides;
    }
    if (WEXITSTATUS(status) == kNothing) return std::nullopt;
    return static_cast<Effect>(std::clamp(WEXITSTATUS(status), 0, 3));
  }

  const Recording& recording_;
  const Point& point_;
  Simulation simulation_;
  FieldHashes saved_;
  std::uint64_t patches_ = 0;
  std::array<State, 3> others_;
  std::array<Future, 2> futures_;
};

/// What the fields of a course that are not proved by another one do in it.
struct Found {
  std::map<std::string, Effect> effects;
};

/// At how many points of a course a field is left out that the table does not expect there, or expects to be scratch.
constexpr int kTries = 3;

/// What the search is for: nothing, or the beginning of a field's name.
struct Search {
  const char* beginning = std::getenv("TROCAR_STATE_FIELDS_SEARCH");
  bool IsOn() const { return beginning != nullptr; }
  bool IsFor(const std::string& field) const { return field.rfind(beginning, 0) == 0; }
};

/// Leaves out the fields for which a course is there, and those that nobody knows yet.
class CourseControl {
 public:
  CourseControl(const Table& table, const std::string& course)
      : table_(table),
        listed_(Table::Of(table.by_course, course)),
        scratch_(Table::Of(table.scratch, course)) {}

  const std::map<std::string, Effect>& Listed() const { return listed_; }
  const Fields& Scratch() const { return scratch_; }
  const std::map<std::string, Effect>& Effects() const { return effects_; }

  void LeaveOutEach(const Recording& recording) {
    for (const Point& point : recording.points) {
      PointControl control(recording, point);
      bool is_prepared = false;
      const auto leave_out = [&](const std::string& field) {
        if (!std::exchange(is_prepared, true)) control.Prepare();
        return control.LeaveOut(field, search_.IsOn() || listed_.contains(field));
      };
      for (const auto& [field, hash] : control.Saved()) {
        if (table_.same.contains(field) && !control.IsAsAtStart(field) && TriesOf(field) < kTries) {
          ++tries_[field];
          EXPECT_EQ(leave_out(field), std::nullopt)
              << field << " can be another, as at tick " << point.tick << ": let a course miss it";
        }
        if (!IsOpen(field)) continue;
        if (const std::optional<Effect> effect = leave_out(field)) Add(point, field, *effect);
      }
    }
  }

  static std::string NameOf(Effect effect) {
    for (const auto& [name, named] : EffectNames()) {
      if (named == effect) return name;
    }
    return "scratch";
  }

 private:
  void Add(const Point& point, const std::string& field, Effect effect) {
    ++tries_[field];
    const auto entry = effects_.emplace(field, Effect::kNone).first;
    if (search_.IsOn() && effect > entry->second)
      std::cout << "missed: tick " << point.tick << " " << NameOf(effect) << " " << field
                << std::endl;  // at once: a search may be stopped
    entry->second = std::max(entry->second, effect);
  }
  Effect EffectOf(const std::string& field) const {
    const auto found = effects_.find(field);
    return found != effects_.end() ? found->second : Effect::kNone;
  }
  int TriesOf(const std::string& field) const {
    const auto found = tries_.find(field);
    return found != tries_.end() ? found->second : 0;
  }

  /// Whether it is to be left out at this point.
  bool IsOpen(const std::string& field) const {
    if (search_.IsOn()) return search_.IsFor(field) && EffectOf(field) < Effect::kDecides;
    if (const auto wanted = listed_.find(field); wanted != listed_.end())
      return EffectOf(field) < wanted->second;
    if (scratch_.contains(field)) return TriesOf(field) < kTries;
    const bool is_known = table_.proved.contains(field) || IsGroup(field, table_.proved);
    return !is_known && TriesOf(field) < kTries && EffectOf(field) < Effect::kDecides;
  }

  const Table& table_;
  const std::map<std::string, Effect> listed_;
  const Fields scratch_;
  const Search search_;
  std::map<std::string, Effect> effects_;
  std::map<std::string, int> tries_;
};

void CheckCourse(const Course& course, const std::string& name) {
  const Table table = ReadTable();
  CourseControl control(table, name);
  EXPECT_FALSE(control.Listed().empty() && control.Scratch().empty() && !Search().IsOn())
      << name << " is there for no field";
  const Recording recording = Record(course, ReadCourse(course));
  ASSERT_FALSE(recording.points.empty());
  control.LeaveOutEach(recording);
  std::map<std::string, Effect> effects = control.Effects();
  if (Search().IsOn()) {
    for (const auto& [field, effect] : effects)
      std::cout << "found: " << name << " " << CourseControl::NameOf(effect) << " " << field << "\n";
    return;
  }
  for (const auto& [field, effect] : control.Listed())
    EXPECT_GE(effects[field], effect) << field << ": left out, nothing else differs";
  for (const std::string& field : control.Scratch()) {
    EXPECT_TRUE(effects.contains(field)) << field << " is nowhere another, which proves nothing";
    EXPECT_EQ(effects[field], Effect::kNone) << field << " is no scratch: it is missed";
  }
  for (const auto& [field, effect] : effects) {
    if (control.Listed().contains(field) || control.Scratch().contains(field)) continue;
    EXPECT_EQ(effect, Effect::kNone) << "add to state_fields.txt: " << name << " "
                                     << CourseControl::NameOf(effect) << " " << field;
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

/// The same, looked at a tick before what happens and after it.
Course Moments(Course course) {
  course.looks_before = true;
  return course;
}

Course Swapped(Course course) {
  course.swaps_hands = true;
  return course;
}
Course Dissected(Course course) {
  course.is_dissected = true;
  return course;
}

Course Altered(Course course, const char* alteration) {
  course.alteration = alteration;
  return course;
}

class StateFieldsSlow : public testing::TestWithParam<Course> {};
TEST_P(StateFieldsSlow, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(
    Courses, StateFieldsSlow,
    testing::Values(
        Course{"retraction", "", 900, 6, 0, true},

        Course{"clip_and_cut", "crosses_clips", 1800, 2, 4}, Course{"clip_and_cut", "fumbler", 1500, 6, 4},
        Course{"hook_dissection", "fumbler", 1500, 6, 4},
        Course{"instrument_navigation", "clashes", 2400, 2, 4}, Course{"lift_and_grasp", "drops", 2400, 2, 4},
        Course{"object_transport", "pulls_apart", 2400, 2, 4}, Course{"pattern_cut", "fumbler", 1500, 6, 4},
        Course{"wire_run", "touches_wire", 2400, 2, 4}, Course{"cholecystectomy", "fumbler", 1500, 6, 0},
        Course{"cholecystectomy", "slips_clip", 2700, 3, 2, false, 1250},
        Course{"cholecystectomy", "expert", 900, 3, 1, false, 300},
        Course{"peg_transfer", "loses", 5000, 2, 6, false, 1500},
        Course{"clip_and_cut", "fumbler", 4000, 6, 16, false, 200, true},
        Course{"hook_dissection", "fumbler", 4000, 8, 8, false, 200, true},
        Course{"pattern_cut", "fumbler", 4000, 8, 16, false, 200, true},
        Moments({"pattern_cut", "lifts_piece", 2950, 2, 30, false, 2300}),
        Moments({"clip_and_cut", "divides_left", 800, 2, 4, false, 0, true}),
        Moments({"peg_transfer", "expert", 1500, 0, 8}), Moments({"tearing", "", 600, 2, 4}),
        Moments({"cholecystectomy", "perforates", 1800, 4, 12}),
        Moments({"cholecystectomy", "lets_assistant_hold", 500, 8, 8}),
        Moments({"cholecystectomy", "takes_stones", 900, 4, 12, false, 300}),
        Swapped({"pattern_cut", "expert", 1600, 4, 8}),
        Dissected({"cholecystectomy", "leaves_stones", 12'000, 16, 16, false, 1400}),
        Altered({"peg_transfer", "fumbler", 700, 2, 2}, "handed_over"),
        Altered({"cholecystectomy", "fumbler", 300, 2, 0}, "tight_cavity"),
        Altered({"cholecystectomy", "fumbler", 300, 2, 0}, "held_in_tight_cavity"),
        Altered({"cholecystectomy", "fumbler", 300, 2, 0}, "left_over_values"),
        Course{"cholecystectomy", "spreads_left", 700, 12, 0, false, 200},
        Altered({"clip_and_cut", "divides_left", 608, 6, 0, false, 572, true}, "blade_beyond_duct"),
        Altered({"cholecystectomy", "lets_assistant_hold", 500, 4, 8}, "crushed"),
        Altered({"cholecystectomy", "takes_stones", 900, 4, 6, false, 300}, "completed")),
    NameOf);

// Every field that a scene begins with stands in the table.
TEST(StateFieldsTable, ListsEach) {
  const Table table = ReadTable();
  for (const char* name : {"retraction", "tearing", "cholecystectomy", "clip_and_cut", "hook_dissection",
                           "pattern_cut", "peg_transfer", "camera_navigation_30", "wire_run"}) {
    const Simulation simulation = std::move(*Simulation::Make(ReadCourse({name, "", 0, 0})));
    for (const auto& [field, hash] : simulation.HashFields())
      EXPECT_TRUE(table.proved.contains(field) || IsGroup(field, table.proved)) << field << " of " << name;
  }
}

}  // namespace
}  // namespace trocar::agent
