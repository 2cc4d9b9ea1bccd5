// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/task_file.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "field_ranges.h"
#include "ideal_path.h"
#include "scene_reader.h"
#include "task_parameters.h"
#include "task_rules.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"

namespace trocar::files {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using host::JsonView;

constexpr const char* kDefaultLevel = "normal";

std::vector<std::string> ReadLevels(const JsonView& root) {
  if (!root.Has("levels")) return {kDefaultLevel};
  std::vector<std::string> levels;
  for (const JsonView& level : root.Array("levels")) levels.push_back(level.AsText());
  if (std::find(levels.begin(), levels.end(), kDefaultLevel) == levels.end())
    root.Complain("levels must contain \"normal\"", ErrorCode::kSceneInvalid);
  return levels;
}

/// What the best shown score of a level is: 100 where the file says nothing.
double ReadBestScore(const JsonView& root, const std::vector<std::string>& levels, const std::string& level) {
  if (!root.Has("level_scores")) return 100.0;
  const JsonView scores = root.Object("level_scores");
  for (const std::string& key : scores.Keys()) {
    if (std::find(levels.begin(), levels.end(), key) == levels.end())
      scores.Complain("there is no level \"" + key + "\" in levels", ErrorCode::kSceneInvalid);
  }
  for (const std::string& each : levels) (void)scores.Number(each, range::kLevelScore);
  return scores.Number(level, range::kLevelScore);
}

}  // namespace

// --- a task's text, read once

struct TaskForm::Content {
  std::filesystem::path source;
  std::string text;  // without blanks
  std::string level;
  std::vector<std::string> levels;
  TaskParameters parameters;
};

TaskForm::TaskForm(std::unique_ptr<const Content> content) : content_(std::move(content)) {}
TaskForm::TaskForm(TaskForm&&) noexcept = default;
TaskForm& TaskForm::operator=(TaskForm&&) noexcept = default;
TaskForm::~TaskForm() = default;

base::Result<TaskForm> TaskForm::Parse(const std::string& text, const fs::path& source,
                                       const std::string& level) {
  auto content = std::make_unique<Content>();
  content->source = source;
  content->level = level;
  const auto written = host::JsonDocument::Parse(text, source.string());
  if (!written.ok()) return written.error();
  const JsonView form = written->Root();
  if (form.Text("format") != "trocar-task") form.Complain("format must be \"trocar-task\"");
  content->levels = ReadLevels(form);
  if (std::find(content->levels.begin(), content->levels.end(), level) == content->levels.end()) {
    std::string known;
    for (const auto& each : content->levels) known += (known.empty() ? "" : ", ") + each;
    form.Complain("there is no level \"" + level + "\"; known are " + known, ErrorCode::kUnknownName);
  }
  content->parameters = ReadTaskParameters(form, content->levels, level);
  if (const auto status = written->Check(); !status.ok()) return status.error();
  content->text = WithoutBlanks(text);
  return TaskForm(std::move(content));
}

base::Result<scene::Scene> TaskForm::MakeScene(std::uint64_t seed, bool is_varied,
                                               const fs::path& patient_folder) const {
  const Content& c = *content_;
  auto document = host::JsonDocument::Parse(SubstituteParameters(c.text, c.parameters.Draw(seed, is_varied)),
                                            c.source.string());
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "about", "levels", "level_scores", "parameters", "shuffle",
                  "scene", "regions", "rules", "ideal_path"});
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  const std::string name = root.Text("name"), about = root.Text("about");
  auto scene = ReadSceneFields(*document, root.Object("scene"), c.source.parent_path(), patient_folder);
  if (!scene.ok()) return scene.error();
  scene->name = name;
  scene->seed = seed;
  scene::Task task = ReadTaskRules(root, *scene);
  ReadIdealPath(root, *scene, task);
  task.best_score = ReadBestScore(root, c.levels, c.level);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  task.name = name;
  task.about = about;
  task.level = c.level;
  scene->task = std::move(task);
  return scene;
}

base::Result<scene::Scene> ReadTask(const fs::path& path, const TaskChoice& choice) {
  auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  return ParseTask(std::move(*text), path, choice);
}

base::Result<scene::Scene> ParseTask(std::string text, const fs::path& source, const TaskChoice& choice) {
  const auto form = TaskForm::Parse(text, source, choice.level);
  if (!form.ok()) return form.error();
  return form->MakeScene(choice.seed, choice.is_varied, choice.patient_folder);
}

base::Result<std::vector<TaskEntry>> ListTasks() {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  const fs::path folder = *data / "scenes/tasks";
  std::error_code failure;
  std::vector<TaskEntry> tasks;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() != ".json") continue;
    auto document = host::JsonDocument::Read(entry.path());
    if (!document.ok()) return document.error();
    const JsonView root = document->Root();
    TaskEntry task{entry.path().stem().string(), entry.path(), root.Text("name"), root.Text("about"),
                   ReadLevels(root)};
    if (const auto status = document->Check(); !status.ok()) return status.error();
    tasks.push_back(std::move(task));
  }
  if (failure) {
    return base::Error{ErrorCode::kFileMissing, folder.string() + ": " + failure.message() +
                                                    "; the tasks are delivered with the program"};
  }
  std::sort(tasks.begin(), tasks.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return tasks;
}

base::Result<fs::path> FindTask(const std::string& name_or_path) {
  std::error_code ignored;
  if (name_or_path.ends_with(".json") || fs::is_regular_file(name_or_path, ignored))
    return fs::path(name_or_path);
  const auto tasks = ListTasks();
  if (!tasks.ok()) return tasks.error();
  std::string known;
  for (const TaskEntry& task : *tasks) {
    if (task.key == name_or_path) return task.path;
    known += (known.empty() ? "" : ", ") + task.key;
  }
  return base::Error{ErrorCode::kUnknownName, "there is no task \"" + name_or_path + "\"; known are " +
                                                  known + "; or give the path of a task file (.json)"};
}

}  // namespace trocar::files
