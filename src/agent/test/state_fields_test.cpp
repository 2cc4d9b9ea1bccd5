// SPDX-License-Identifier: Apache-2.0
// The control of saving and restoring: a state that is restored without any one of its fields is another one. state_fields.txt
// says of each field which course notices that it is missing.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
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

/// What a course is there for.
struct Listed {
  Fields decides;  ///< without it the next tick goes another way
  Fields shows;    ///< the restored state is another one at once, and the next tick makes the field anew
};

/// state_fields.txt: a line each of course, "decides" or "shows", and field.
const std::map<std::string, Listed>& Table() {
  static const std::map<std::string, Listed> table = [] {
    std::map<std::string, Listed> by_course;
    std::ifstream file(std::filesystem::path(TROCAR_SOURCE_DIR) / "src/agent/test/state_fields.txt");
    EXPECT_TRUE(file.good());
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream words(line);
      std::string course, how, field, more;
      words >> course >> how >> field;
      EXPECT_TRUE(!field.empty() && !(words >> more) && (how == "decides" || how == "shows")) << line;
      (how == "decides" ? by_course[course].decides : by_course[course].shows).insert(field);
    }
    return by_course;
  }();
  return table;
}

Fields AllListed() {
  Fields all;
  for (const auto& [course, listed] : Table()) {
    all.insert(listed.decides.begin(), listed.decides.end());
    all.insert(listed.shows.begin(), listed.shows.end());
  }
  return all;
}

/// What has fields of its own in another state: an empty list counts as one field where it is empty.
bool IsGroup(const std::string& field, const Fields& all) {
  const auto inside = all.lower_bound(field + "/");
  return inside != all.end() && inside->compare(0, field.size() + 1, field + "/") == 0;
}

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

/// Hash after the next tick. Without one of its fields a state need not fit together, and the tick may crash: it has a process of
/// its own. Nothing where it crashed.
std::optional<std::uint64_t> HashAfter(Simulation& simulation, const Input& input) {
  int ends[2];
  if (::pipe(ends) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(STDERR_FILENO);
    ::alarm(60);
    simulation.Step(input);
    const std::uint64_t hash = simulation.Hash();
    ::_exit(::write(ends[1], &hash, sizeof(hash)) == sizeof(hash) ? 0 : 1);
  }
  ::close(ends[1]);
  std::uint64_t hash = 0;
  const bool has_hash = ::read(ends[0], &hash, sizeof(hash)) == sizeof(hash);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return has_hash ? std::optional(hash) : std::nullopt;
}

/// Leaves out one field after the other.
class Control {
 public:
  /// Of the fields of which each has another value in the state that is replaced: at the start, or where other hands have gone.
  void Check(const Recording& recording, const Point& point) {
    Simulation simulation = std::move(*Simulation::Make(recording.model, 1));
    const std::map<std::string, std::uint64_t> at_start = HashByField(simulation);
    std::vector<std::byte> start, elsewhere;
    simulation.Save(start);
    ASSERT_TRUE(simulation.Restore(point.bytes).ok());
    const std::map<std::string, std::uint64_t> saved = HashByField(simulation);
    const std::array inputs{recording.inputs[point.tick], Diverging(recording.inputs[point.tick])};
    std::array<std::optional<std::uint64_t>, inputs.size()> next;
    for (std::size_t i = 0; i < inputs.size(); ++i) next[i] = HashAfter(simulation, inputs[i]);
    Fumbler fumbler(point.tick + 1);
    for (int tick = 0; tick < kGoesOn; ++tick)
      simulation.Step(fumbler.Act(simulation.GetScene(), simulation.GetSnapshot()));
    const std::map<std::string, std::uint64_t> spoiled = HashByField(simulation);
    simulation.Save(elsewhere);
    for (const auto& [field, hash] : saved) {
      seen.insert(field);
      for (const auto& [before, bytes] : {std::pair(&at_start, &start), std::pair(&spoiled, &elsewhere)}) {
        if (decides.count(field) != 0) break;
        const auto other = before->find(field);
        if (other != before->end() && other->second == hash) continue;
        ASSERT_TRUE(simulation.Restore(*bytes).ok());
        // what does not fit the rest is refused, which is as good
        if (!simulation.RestoreWithout(point.bytes, field).ok()) {
          decides.insert(field);
        } else if (simulation.Hash() != point.hash) {
          shows.insert(field);
          for (std::size_t i = 0; i < inputs.size(); ++i) {
            if (HashAfter(simulation, inputs[i]) != next[i]) decides.insert(field);
          }
        }
      }
    }
  }

  Fields seen, decides, shows;

 private:
  static Input Diverging(Input input) {
    input.settings.solver = DivergingSolver();
    return input;
  }
};

/// Those of `fields` that are not in `of`.
Fields Without(const Fields& fields, const Fields& of) {
  Fields rest;
  std::set_difference(fields.begin(), fields.end(), of.begin(), of.end(), std::inserter(rest, rest.end()));
  return rest;
}

std::string Join(const Fields& fields) {
  std::string text;
  for (const std::string& field : fields) text += "\n  " + field;
  return text;
}

void CheckCourse(const Course& course, const std::string& name) {
  const Recording recording = Record(course, ReadCourse(course));
  ASSERT_FALSE(recording.points.empty());
  Control control;
  for (const Point& point : recording.points) control.Check(recording, point);
  // of which the table is made
  testing::Test::RecordProperty("seen", Join(control.seen));
  testing::Test::RecordProperty("decides", Join(control.decides));
  testing::Test::RecordProperty("shows", Join(control.shows));
  const Fields all = AllListed();
  for (const std::string& field : control.seen)
    EXPECT_TRUE(all.count(field) != 0 || IsGroup(field, all))
        << field << " is new: let a course notice it, and list it in state_fields.txt";
  const auto listed = Table().find(name);
  ASSERT_NE(listed, Table().end()) << name << " is there for no field";
  EXPECT_TRUE(Without(listed->second.decides, control.decides).empty())
      << "left out, the next tick is the same:" << Join(Without(listed->second.decides, control.decides));
  EXPECT_TRUE(Without(listed->second.shows, control.shows).empty())
      << "left out, the restored state is the same:" << Join(Without(listed->second.shows, control.shows));
}

class StateFields : public testing::TestWithParam<Course> {};
TEST_P(StateFields, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(Courses, StateFields,
                         testing::Values(Course{"pattern_cut", "expert", 1600, 2},
                                         Course{"peg_transfer", "fumbler", 700, 2},
                                         Course{"retraction", "fumbler", 700, 4}),
                         NameOf);

class StateFieldsSlow : public testing::TestWithParam<Course> {};
TEST_P(StateFieldsSlow, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(
    Courses, StateFieldsSlow,
    testing::Values(
        Course{"retraction", "", 3000, 2}, Course{"retraction", "", 900, 6, false, true},
        Course{"tearing", "", 1500, 2}, Course{"demonstration", "", 1500, 2},
        Course{"camera_navigation_30", "expert", 1600, 2}, Course{"clip_and_cut", "crosses_clips", 1800, 2},
        Course{"clip_and_cut", "fumbler", 1500, 6}, Course{"hook_dissection", "burns_spared", 1100, 2},
        Course{"hook_dissection", "fumbler", 1500, 6}, Course{"instrument_navigation", "clashes", 2400, 2},
        Course{"lift_and_grasp", "drops", 2400, 2}, Course{"object_transport", "pulls_apart", 2400, 2},
        Course{"pattern_cut", "cuts_aside", 2200, 2}, Course{"pattern_cut", "fumbler", 1500, 6},
        Course{"peg_transfer", "loses", 4000, 2}, Course{"wire_run", "touches_wire", 2400, 2},
        Course{"cholecystectomy", "fumbler", 1500, 10, false}),
    NameOf);

class StateFieldsWhole : public testing::TestWithParam<Course> {};
TEST_P(StateFieldsWhole, AreMissed) {
  CheckCourse(GetParam(), NameOf({GetParam(), 0}));
}
INSTANTIATE_TEST_SUITE_P(Courses, StateFieldsWhole,
                         testing::Values(Course{"cholecystectomy", "leaves_stones", 60'000, 16, false},
                                         Course{"cholecystectomy", "slips_clip", 60'000, 16, false}),
                         NameOf);

// Every field that a scene begins with has its course.
TEST(StateFieldsTable, ListsEach) {
  const Fields all = AllListed();
  for (const char* name : {"retraction", "tearing", "cholecystectomy", "clip_and_cut", "hook_dissection",
                           "pattern_cut", "peg_transfer", "camera_navigation_30", "wire_run"}) {
    const Simulation simulation = std::move(*Simulation::Make(ReadCourse({name, "", 0, 0}), 1));
    for (const auto& [field, hash] : simulation.HashFields())
      EXPECT_TRUE(all.count(field) != 0 || IsGroup(field, all)) << field << " of " << name;
  }
}

}  // namespace
}  // namespace trocar::agent
