// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/task_page.h"

#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include "trocar/assessment/course.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/operation_part.h"
#include "trocar/presenter/patient_list.h"
#include "trocar/scene/scene.h"
#include "trocar/view/picture_series.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBasicCourse = "basic-skills";
constexpr const char* kPictures = "assets/pictures";
/// A scene that is no task, in the data folder's scenes/.
constexpr const char* kDemonstration = "demonstration.json";
/// Pictures of the series, of the operation and of its parts.
constexpr std::pair<const char*, const char*> kOperationPictures[] = {{"", "01-preparation"},
                                                                      {"critical-view", "04-critical-view"},
                                                                      {"clip-and-cut", "06-clips"},
                                                                      {"bed", "08-bed"}};

fs::path FindPicture(const fs::path& data, const std::string& name) {
  const fs::path path = data / kPictures / (name + ".png");
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) ? path : fs::path();
}

/// The easiest first, as the course of basic skills has them; tasks that it has not, last.
void SortByDifficulty(std::vector<files::TaskEntry>& tasks) {
  const auto course = assessment::FindCourse(kBasicCourse);
  if (!course.ok()) return;
  const auto place = [&](const files::TaskEntry& task) {
    const auto& steps = course->steps;
    return std::find_if(steps.begin(), steps.end(),
                        [&](const assessment::Step& step) { return step.task == task.key; }) -
           steps.begin();
  };
  std::stable_sort(tasks.begin(), tasks.end(),
                   [&](const files::TaskEntry& a, const files::TaskEntry& b) { return place(a) < place(b); });
}

base::Status AddBasicSkills(const fs::path& data, TaskPage& page) {
  auto tasks = files::ListTasks();
  if (!tasks.ok()) return tasks.error();
  SortByDifficulty(*tasks);
  std::map<std::string, std::string> pictures;
  for (const view::SeriesSitting& sitting : view::ListPictureSeries()) {
    if (!sitting.shots.empty()) pictures.emplace(sitting.task, sitting.shots.front().name);
  }
  TaskPage::Group group{host::Translate("Basic skills, the easiest first"), {}};
  for (const files::TaskEntry& task : *tasks) {
    TaskPage::Row row;
    row.name = host::Translate(task.name), row.about = host::Translate(task.about);
    for (const std::string& level : task.levels) row.levels.push_back({level, "", ""});
    row.request.task = task.key;
    if (const auto picture = pictures.find(task.key); picture != pictures.end())
      row.picture = FindPicture(data, picture->second);
    group.rows.push_back(std::move(row));
  }
  page.groups.push_back(std::move(group));
  return {};
}

base::Status AddOperation(const fs::path& data, const fs::path& patient, TaskPage& page) {
  const auto levels = files::ListOperationLevels();
  if (!levels.ok()) return levels.error();
  const auto parts = ListOperationParts();
  if (!parts.ok()) return parts.error();
  TaskPage::Group group{
      host::TranslateWith("Laparoscopic cholecystectomy on {1}", {ShortPatientName(patient)}), {}};
  const auto add = [&](const std::string& part, const std::string& name, const std::string& about) {
    TaskPage::Row row;
    row.name = name, row.about = about;
    for (const scene::OperationLevel& level : *levels)
      row.levels.push_back({level.key, host::Translate(level.about), ""});
    row.request.task = kOperationTask;
    row.request.part = part;
    row.request.choice.patient_folder = patient;
    for (const auto& [key, picture] : kOperationPictures) {
      if (part == key) row.picture = FindPicture(data, picture);
    }
    // a part without one of its own shows the operation
    if (row.picture.empty()) row.picture = FindPicture(data, kOperationPictures[0].second);
    group.rows.push_back(std::move(row));
  };
  add("", host::Translate("The whole operation"),
      host::Translate("From the first look to the gallbladder in its bag"));
  for (const OperationPart& part : *parts)
    add(part.key, host::Translate(part.name), host::Translate(part.goal));
  page.groups.push_back(std::move(group));
  return {};
}

base::Status AddDemonstration(const fs::path& data, TaskPage& page) {
  TaskPage::Row row;
  row.request.scene = data / "scenes" / kDemonstration;
  auto document = host::JsonDocument::Read(row.request.scene);
  if (!document.ok()) return document.error();
  row.name = host::Translate(document->Root().Text("name"));
  row.about = host::Translate(document->Root().TextOr("about", ""));
  if (const auto status = document->Check(); !status.ok()) return status;
  page.groups.push_back({host::Translate("To look at"), {std::move(row)}});
  return {};
}

}  // namespace

base::Result<TaskPage> LoadTaskPage(TaskSection section, const fs::path& patient) {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  TaskPage page;
  page.section = section;
  if (section != TaskSection::kOperation) {
    if (const base::Status added = AddBasicSkills(*data, page); !added.ok()) return added.error();
  }
  if (section != TaskSection::kBasicSkills) {
    if (const base::Status added = AddOperation(*data, patient, page); !added.ok()) return added.error();
  }
  if (section == TaskSection::kAll) {
    if (const base::Status added = AddDemonstration(*data, page); !added.ok()) return added.error();
  }
  return page;
}

void AddBestResults(const centre::BestResults& results, TaskPage& page) {
  for (TaskPage::Group& group : page.groups) {
    for (TaskPage::Row& row : group.rows) {
      if (!row.request.part.empty() || row.request.task.empty()) continue;
      for (TaskPage::Level& level : row.levels) {
        const bool is_operation = row.request.task == kOperationTask;
        level.best =
            centre::DescribeBest(results, row.request.task, is_operation ? KeepLevel(level.key) : level.key);
      }
    }
  }
}

}  // namespace trocar::presenter
