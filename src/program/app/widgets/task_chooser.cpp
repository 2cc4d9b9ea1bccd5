// SPDX-License-Identifier: Apache-2.0
#include "task_chooser.h"

#include <algorithm>
#include <string>
#include <vector>

#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 760, kLevelWidth = 96;  // [pixels]
constexpr double kMostSeed = 2147483647;

/// What differs at the level, and one's best result at it.
std::string DescribeLevel(const presenter::TaskPage::Level& level) {
  return level.about + (level.about.empty() || level.best.empty() ? "" : ". ") + level.best;
}

}  // namespace

TaskChooser::TaskChooser() : gui::ListCard(kListWidth) {
  auto* label = Gtk::make_managed<Gtk::Label>(host::Translate("Variant of the task"));
  label->add_css_class("name");
  seed_.set_adjustment(Gtk::Adjustment::create(1, 0, kMostSeed, 1, 10));
  gui::SetAccessibleName(seed_, host::Translate("Variant of the task"));
  seed_.set_tooltip_text(
      host::Translate("Moves what a task leaves open; the same number gives the same task"));
  patients_.signal_clicked().connect([this] { signal_patients_.emit(); });
  AddFoot({label, &seed_, &patients_});
}

void TaskChooser::Show(const presenter::TaskPage& page) {
  ClearRows();
  for (const presenter::TaskPage::Group& group : page.groups) {
    AddTitle(group.title);
    for (const presenter::TaskPage::Row& row : group.rows) AddTask(row);
  }
  patients_.set_visible(page.section != presenter::TaskSection::kBasicSkills);
}

void TaskChooser::AddTask(const presenter::TaskPage::Row& row) {
  Gtk::Label* about = gui::MakeLabel(row.about, "fine");
  about->set_tooltip_text(row.about);
  Gtk::Label* best = gui::MakeLabel("", "name");
  auto* start = Gtk::make_managed<Gtk::Button>(host::Translate("Start"));
  start->set_tooltip_text(row.name);
  gui::SetAccessibleName(*start, host::TranslateWith("Start {1}", {row.name}));
  if (row.levels.empty()) {
    start->signal_clicked().connect([this, request = row.request]() mutable {
      request.choice.seed = static_cast<std::uint64_t>(seed_.get_value_as_int());
      signal_chosen_.emit(request);
    });
    return AddPictureRow(row.picture, row.name, {about, best}, {start});
  }
  auto* level = Gtk::make_managed<Gtk::DropDown>();
  std::vector<Glib::ustring> keys;
  std::vector<Glib::ustring> names;
  for (const presenter::TaskPage::Level& one : row.levels) {
    keys.emplace_back(one.key);
    names.emplace_back(host::Translate(one.key));
  }
  level->set_model(Gtk::StringList::create(names));
  gui::SetAccessibleName(*level, host::TranslateWith("Level of {1}", {row.name}));
  const auto normal = std::find(keys.begin(), keys.end(), Glib::ustring(row.request.choice.level));
  level->set_selected(static_cast<guint>(normal == keys.end() ? 0 : normal - keys.begin()));
  level->set_size_request(kLevelWidth, -1);
  const auto show = [level, best, levels = row.levels] {
    if (level->get_selected() < levels.size()) {
      const std::string text = DescribeLevel(levels[level->get_selected()]);
      gui::SetText(*best, text);
      best->set_tooltip_text(text);
    }
  };
  level->property_selected().signal_changed().connect(show);
  show();
  start->signal_clicked().connect([this, level, keys, request = row.request]() mutable {
    if (level->get_selected() < keys.size()) request.choice.level = keys[level->get_selected()].raw();
    request.choice.seed = static_cast<std::uint64_t>(seed_.get_value_as_int());
    signal_chosen_.emit(request);
  });
  AddPictureRow(row.picture, row.name, {about, best}, {level, start});
}

}  // namespace trocar::app
