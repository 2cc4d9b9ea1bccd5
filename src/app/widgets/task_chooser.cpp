// SPDX-License-Identifier: Apache-2.0
#include "task_chooser.h"

#include <algorithm>

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 660, kListHeight = 520, kLevelWidth = 96;  // [pixels]
constexpr double kMostSeed = 2147483647;
/// Scenes that are no tasks, in the data folder's scenes/.
constexpr const char* kScenes[] = {"cholecystectomy.json", "demonstration.json"};

}  // namespace

TaskChooser::TaskChooser() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  rows_.set_spacing(4);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_height(true);
  scroller->set_max_content_height(kListHeight);
  scroller->set_size_request(kListWidth, -1);
  scroller->set_child(rows_);
  append(*scroller);

  auto* line = Gtk::make_managed<Gtk::Box>();
  line->set_spacing(8);
  auto* label = Gtk::make_managed<Gtk::Label>("Seed of the task");
  label->add_css_class("name");
  seed_.set_adjustment(Gtk::Adjustment::create(1, 0, kMostSeed, 1, 10));
  seed_.set_tooltip_text("Moves what a task leaves open; the same seed gives the same task");
  auto* close = Gtk::make_managed<Gtk::Button>("Close");
  close->set_hexpand(true);
  close->set_halign(Gtk::Align::END);
  close->signal_clicked().connect([this] { signal_closed_.emit(); });
  line->append(*label);
  line->append(seed_);
  line->append(*close);
  append(*line);
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
    AddRow(task.name, task.about, task.levels, request);
  }
  AddTitle("On a patient");
  for (const char* file : kScenes) {
    TaskRequest request;
    request.scene = *data / "scenes" / file;
    auto document = core::JsonDocument::Read(request.scene);
    if (!document) return document.error();
    AddRow(document->Root().Text("name"), document->Root().TextOr("about", ""), {}, request);
    if (const auto status = document->Check(); !status) return status.error();
  }
  is_loaded_ = true;
  return {};
}

void TaskChooser::AddTitle(const char* text) {
  auto* title = Gtk::make_managed<Gtk::Label>(text);
  title->add_css_class("card-title");
  title->set_xalign(0);
  rows_.append(*title);
}

void TaskChooser::AddRow(const std::string& name, const std::string& about,
                         const std::vector<std::string>& levels, TaskRequest request) {
  auto* row = Gtk::make_managed<Gtk::Box>();
  row->set_spacing(8);
  auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  text->set_hexpand(true);
  auto* title = Gtk::make_managed<Gtk::Label>(name);
  title->add_css_class("key");
  title->set_xalign(0);
  auto* line = Gtk::make_managed<Gtk::Label>(about);
  line->add_css_class("fine");
  line->set_xalign(0);
  line->set_ellipsize(Pango::EllipsizeMode::END);
  line->set_tooltip_text(about);
  text->append(*title);
  text->append(*line);
  row->append(*text);
  auto* level = Gtk::make_managed<Gtk::DropDown>();
  if (!levels.empty()) {
    level->set_model(Gtk::StringList::create({levels.begin(), levels.end()}));
    const auto normal = std::find(levels.begin(), levels.end(), request.choice.level);
    level->set_selected(static_cast<guint>(normal - levels.begin()));
    level->set_valign(Gtk::Align::CENTER);
    level->set_size_request(kLevelWidth, -1);
    row->append(*level);
  }
  auto* start = Gtk::make_managed<Gtk::Button>("Start");
  start->set_valign(Gtk::Align::CENTER);
  start->set_tooltip_text(name);
  start->signal_clicked().connect([this, level, levels, request]() mutable {
    if (level->get_selected() < levels.size()) request.choice.level = levels[level->get_selected()];
    request.choice.seed = static_cast<std::uint64_t>(seed_.get_value_as_int());
    signal_chosen_.emit(request);
  });
  row->append(*start);
  rows_.append(*row);
}

}  // namespace trocar::app
