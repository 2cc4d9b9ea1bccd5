// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <system_error>

#include "trocar/assessment/course.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/task_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/scene/scene.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using host::JsonView;

constexpr host::NumberRange kPasses{1, 1000}, kDays{0, 3650}, kSeed{0, 2147483647};

/// What courses may name, looked up once for a file.
struct Known {
  std::vector<files::TaskEntry> tasks;
  std::vector<Proficiency> proficiencies;
};

void Refuse(const JsonView& view, const std::string& why) {
  view.Complain(why, ErrorCode::kCourseInvalid);
}

template <typename List, typename Name>
std::string Join(const List& list, Name name) {
  std::string text;
  for (const auto& one : list) text += (text.empty() ? "" : ", ") + name(one);
  return text;
}

/// A text that has to say something.
std::string ReadWords(const JsonView& view, const char* key) {
  std::string text = view.Text(key);
  if (view.Has(key) && text.empty())
    Refuse(view, std::string(key) + " is empty; write what the trainee is to read");
  return text;
}

void ReadTaskOf(const JsonView& view, const Known& known, Step& step) {
  step.task = view.Text("task");
  step.level = view.TextOr("level", "normal");
  for (const char* key : {"patient", "from", "until"}) {
    if (view.Has(key))
      Refuse(view, std::string(key) + " belongs to an operation, not to a task; take it out");
  }
  if (view.Has("seed")) step.seed = base::TruncateTo<std::uint64_t>(view.Number("seed", kSeed));
  const auto task = std::find_if(known.tasks.begin(), known.tasks.end(),
                                 [&](const auto& one) { return one.key == step.task; });
  if (task == known.tasks.end()) {
    Refuse(view, "there is no task \"" + step.task + "\"; known are " +
                     Join(known.tasks, [](const auto& one) { return one.key; }));
  } else if (std::find(task->levels.begin(), task->levels.end(), step.level) == task->levels.end()) {
    Refuse(view, "the task \"" + step.task + "\" has no level \"" + step.level + "\"; it has " +
                     Join(task->levels, [](const auto& level) { return level; }));
  }
}

PatientChoice ReadPatient(const JsonView& view, const fs::path& folder) {
  view.AllowOnly({"folder", "seed", "set"});
  PatientChoice patient;
  if (view.Has("folder") == view.Has("seed"))
    Refuse(view, "a patient has either folder or seed; leave patient out for the operation's own");
  if (view.Has("folder")) {
    patient.folder = (folder / view.Text("folder")).lexically_normal();
    std::error_code ignored;
    if (!fs::is_regular_file(patient.folder / "patient.json", ignored))
      Refuse(view,
             "there is no patient in " + patient.folder.string() +
                 "; make one with trocar anatomy generate, or name its folder relative to the course's file");
    if (view.Has("set"))
      Refuse(view, "set belongs to a generated patient; give its seed in place of the folder");
    return patient;
  }
  patient.seed = base::TruncateTo<std::uint64_t>(view.Number("seed", kSeed));
  if (view.Has("set")) {
    const JsonView settings = view.Object("set");
    for (const std::string& name : settings.Keys()) patient.settings.emplace_back(name, settings.Text(name));
  }
  if (const auto drawn = anatomy::DrawParameters(*patient.seed, patient.settings); !drawn.ok())
    Refuse(view, drawn.error().message);
  return patient;
}

Milestone ReadMilestone(const JsonView& view, const char* key, Milestone fallback) {
  if (!view.Has(key)) return fallback;
  const std::string name = view.Text(key);
  if (const auto milestone = FindMilestone(name)) return *milestone;
  Refuse(view, "there is no moment \"" + name + "\" of an operation; " + key +
                   " is start, critical_view, divided, free or completed");
  return fallback;
}

void ReadOperationOf(const JsonView& view, const fs::path& folder, Step& step) {
  step.operation = view.Text("operation");
  for (const char* key : {"level", "seed"}) {
    if (view.Has(key))
      Refuse(view, std::string(key) + " belongs to a task, not to an operation; take it out");
  }
  const auto data = host::FindDataFolder();
  std::error_code ignored;
  const fs::path scene = data.ok() ? *data / "scenes" / (step.operation + ".json") : fs::path();
  bool is_operation = false;
  if (fs::is_regular_file(scene, ignored)) {
    const auto document = host::JsonDocument::Read(scene);
    is_operation = document.ok() && document->Root().Has("operation");
  }
  if (!is_operation)
    Refuse(view, "there is no operation \"" + step.operation + "\"; delivered is " +
                     std::string(procedures::kUsualProcedure));
  if (view.Has("patient")) step.patient = ReadPatient(view.Object("patient"), folder);
  step.from = ReadMilestone(view, "from", Milestone::kStart);
  step.until = ReadMilestone(view, "until", Milestone::kCompleted);
  if (step.until <= step.from)
    Refuse(view, "the part from \"" + std::string(NameOf(step.from)) + "\" until \"" +
                     std::string(NameOf(step.until)) +
                     "\" is empty; the order is start, critical_view, divided, free, completed");
}

void ReadThresholdsOf(const JsonView& view, const Known& known, Step& step) {
  if (view.Has("thresholds") && view.Has("own_thresholds")) {
    Refuse(view, "a step has either thresholds (the name of delivered ones) or own_thresholds");
  } else if (view.Has("own_thresholds")) {
    step.proficiency.thresholds = ReadThresholds(view.Array("own_thresholds"));
    step.proficiency.source = "the course";
  } else if (view.Has("thresholds")) {
    const std::string key = view.Text("thresholds");
    const auto found = std::find_if(known.proficiencies.begin(), known.proficiencies.end(),
                                    [&](const auto& one) { return one.key == key; });
    if (found == known.proficiencies.end()) {
      Refuse(view, "there are no thresholds \"" + key + "\"; known are " +
                       Join(known.proficiencies, [](const auto& one) { return one.key; }) +
                       "; or write own_thresholds");
    } else if (found->task != (step.IsOperation() ? step.operation : step.task) ||
               found->level != step.level) {
      Refuse(view, "the thresholds \"" + key + "\" are of " + found->task +
                       (found->level.empty() ? "" : ", level " + found->level) +
                       ", and the step is of another");
    } else {
      step.proficiency = *found;
    }
  }
  step.consecutive_passes = static_cast<std::size_t>(view.IntegerOr("consecutive_passes", 2, kPasses));
  step.passes =
      static_cast<std::size_t>(view.IntegerOr("passes", static_cast<int>(step.consecutive_passes), kPasses));
  if (step.passes < step.consecutive_passes)
    Refuse(view, "passes counts those in a row, too: it is at least consecutive_passes");
}

Step ReadStep(const JsonView& view, const fs::path& folder, const Known& known,
              const std::vector<Step>& before) {
  view.AllowOnly({"key", "name", "goal", "briefing", "after_pass", "after_fail", "task", "level", "seed",
                  "operation", "patient", "from", "until", "thresholds", "own_thresholds",
                  "consecutive_passes", "passes", "prerequisites", "due_days"});
  Step step;
  step.key = ReadWords(view, "key");
  if (step.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") != std::string::npos)
    Refuse(view, "a key is of small letters, digits, _ and -");
  const auto is_taken = [&](const Step& other) { return other.key == step.key; };
  if (std::any_of(before.begin(), before.end(), is_taken))
    Refuse(view, "there is a step \"" + step.key + "\" already; keys are given once");
  step.name = ReadWords(view, "name");
  step.goal = ReadWords(view, "goal");
  step.briefing = ReadWords(view, "briefing");
  step.after_pass = ReadWords(view, "after_pass");
  step.after_fail = ReadWords(view, "after_fail");
  if (view.Has("task") == view.Has("operation")) {
    Refuse(view, "a step has either a task or an operation; tasks are " +
                     Join(known.tasks, [](const auto& one) { return one.key; }));
  } else if (view.Has("task")) {
    ReadTaskOf(view, known, step);
  } else {
    ReadOperationOf(view, folder, step);
  }
  ReadThresholdsOf(view, known, step);
  if (view.Has("prerequisites")) {
    for (const JsonView& one : view.Array("prerequisites")) {
      step.prerequisites.push_back(one.AsText());
      const auto is_meant = [&](const Step& other) { return other.key == step.prerequisites.back(); };
      if (std::none_of(before.begin(), before.end(), is_meant))
        Refuse(one, "there is no step \"" + step.prerequisites.back() +
                        "\" before this one; prerequisites stand earlier in the file");
    }
  }
  if (view.Has("due_days")) step.due_days = view.Integer("due_days", kDays);
  return step;
}

base::Result<Course> ReadCourse(const fs::path& path, const Known& known) {
  const auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "about", "steps"});
  if (root.Text("format") != "trocar-course") Refuse(root, "format must be \"trocar-course\"");
  if (root.Integer("version") != 1) Refuse(root, "version must be 1");
  Course course;
  course.key = path.stem().string();
  course.path = path;
  course.name = ReadWords(root, "name");
  course.about = ReadWords(root, "about");
  for (const JsonView& view : root.Array("steps"))
    course.steps.push_back(ReadStep(view, path.parent_path(), known, course.steps));
  if (course.steps.empty()) Refuse(root, "a course has at least one step");
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return course;
}

base::Result<Known> ListKnown() {
  auto tasks = files::ListTasks();
  if (!tasks.ok()) return tasks.error();
  auto proficiencies = ListProficiencies();
  if (!proficiencies.ok()) return proficiencies.error();
  return Known{std::move(*tasks), std::move(*proficiencies)};
}

}  // namespace

base::Result<Course> ReadCourse(const fs::path& path) {
  const auto known = ListKnown();
  if (!known.ok()) return known.error();
  return ReadCourse(path, *known);
}

base::Result<std::vector<Course>> ListCourses() {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  const auto known = ListKnown();
  if (!known.ok()) return known.error();
  const fs::path folder = *data / "assets/courses";
  std::error_code failure;
  std::vector<Course> courses;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() != ".json") continue;
    auto course = ReadCourse(entry.path(), *known);
    if (!course.ok()) return course.error();
    courses.push_back(std::move(*course));
  }
  if (failure) {
    return Error{ErrorCode::kFileMissing,
                 folder.string() + ": " + failure.message() + "; the courses are delivered with the program"};
  }
  std::sort(courses.begin(), courses.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return courses;
}

base::Result<Course> FindCourse(const std::string& name_or_path) {
  std::error_code ignored;
  if (name_or_path.ends_with(".json") || fs::is_regular_file(name_or_path, ignored))
    return ReadCourse(name_or_path);
  auto courses = ListCourses();
  if (!courses.ok()) return courses.error();
  for (Course& course : *courses) {
    if (course.key == name_or_path) return std::move(course);
  }
  return Error{ErrorCode::kUnknownName, "there is no course \"" + name_or_path + "\"; known are " +
                                            Join(*courses, [](const auto& one) { return one.key; }) +
                                            "; or give the path of a file (.json)"};
}

base::Result<Step> FindStep(const Course& course, const std::string& key) {
  if (const Step* step = course.Find(key)) return *step;
  return Error{ErrorCode::kUnknownName, "the course \"" + course.key + "\" has no step \"" + key +
                                            "\"; its steps are " +
                                            Join(course.steps, [](const auto& one) { return one.key; })};
}

}  // namespace trocar::assessment
