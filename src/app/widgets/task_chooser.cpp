// SPDX-License-Identifier: Apache-2.0
#include "task_chooser.h"

#include <algorithm>

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 660, kLevelWidth = 96;  // [pixels]
constexpr double kMostSeed = 2147483647;
/// Scenes that are no tasks, in the data folder's scenes/.
constexpr const char* kScenes[] = {"cholecystectomy.json", "demonstration.json"};

}  // namespace

TaskChooser::TaskChooser() : gui::ListCard(kListWidth) {
  auto* label = Gtk::make_managed<Gtk::Label>("Seed of the task");
  label->add_css_class("name");
  seed_.set_adjustment(Gtk::Adjustment::create(1, 0, kMostSeed, 1, 10));
  seed_.set_tooltip_text("Moves what a task leaves open; the same seed gives the same task");
  AddFoot({label, &seed_});
}

core::Status TaskChooser::Load() {
  if (is_loaded_) return {};
  const auto tasks = scene::ListTasks();
  if (!tasks) return tasks.error();
  const auto data = scene::FindDataFolder();
  if (!data) return data.error();
  AddTitle("Training tasks");
  for (const scene::TaskEntry& task : *tasks) {
    TaskRequest request;
    request.task = task.key;
    AddTask(task.name, task.about, task.levels, request);
  }
  AddTitle("On a patient");
  for (const char* file : kScenes) {
    TaskRequest request;
    request.scene = *data / "scenes" / file;
    auto document = core::JsonDocument::Read(request.scene);
    if (!document) return document.error();
    AddTask(document->Root().Text("name"), document->Root().TextOr("about", ""), {}, request);
    if (const auto status = document->Check(); !status) return status.error();
  }
  is_loaded_ = true;
  return {};
}

void TaskChooser::AddTask(const std::string& name, const std::string& about,
                          const std::vector<std::string>& levels, TaskRequest request) {
  auto* level = levels.empty() ? nullptr : Gtk::make_managed<Gtk::DropDown>();
  if (level != nullptr) {
    level->set_model(Gtk::StringList::create({levels.begin(), levels.end()}));
    const auto normal = std::find(levels.begin(), levels.end(), request.choice.level);
    level->set_selected(static_cast<guint>(normal - levels.begin()));
    level->set_size_request(kLevelWidth, -1);
  }
  auto* start = Gtk::make_managed<Gtk::Button>("Start");
  start->set_tooltip_text(name);
  start->signal_clicked().connect([this, level, levels, request]() mutable {
    if (level != nullptr && level->get_selected() < levels.size())
      request.choice.level = levels[level->get_selected()];
    request.choice.seed = static_cast<std::uint64_t>(seed_.get_value_as_int());
    signal_chosen_.emit(request);
  });
  level != nullptr ? AddRow(name, about, {level, start}) : AddRow(name, about, {start});
}

}  // namespace trocar::app
