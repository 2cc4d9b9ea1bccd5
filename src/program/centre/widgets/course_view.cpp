// SPDX-License-Identifier: Apache-2.0
#include "course_view.h"

#include <algorithm>

#include "trocar/gui/card.h"
#include "trocar/gui/columns.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

using assessment::StepState;

constexpr int kMapWidth = 420, kGap = 14;  // [pixels]

std::string WordOf(StepState state) {
  switch (state) {
    case StepState::kDone:
      return host::Translate("✓ done");
    case StepState::kOpen:
      return host::TranslateIn("step", "open");
    case StepState::kLocked:
      return host::Translate("locked");
  }
  return "";
}

const char* ClassOf(StepState state) {
  return state == StepState::kDone ? "done" : state == StepState::kOpen ? "open" : "locked";
}

}  // namespace

CourseView::CourseView() : Gtk::Box(Gtk::Orientation::VERTICAL) {}

void CourseView::Show(const CentrePage& shown) {
  Clear(*this);
  const CoursePage& page = shown.courses;
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->add_css_class("page");
  all->set_spacing(kGap);
  Gtk::Box& head = gui::MakeRow(10, {});
  Gtk::Label& title = MakeText(page.name.empty() ? host::Translate("Courses") : page.name, "page-title");
  title.set_hexpand(true);
  head.append(title);
  auto* courses = Gtk::make_managed<Gtk::DropDown>();
  std::vector<Glib::ustring> names;
  guint chosen = 0;
  for (const CoursePage::Choice& course : page.courses) {
    if (course.key == page.course) chosen = static_cast<guint>(names.size());
    names.push_back(course.name);
  }
  courses->set_model(Gtk::StringList::create(names));
  courses->set_selected(chosen);
  courses->property_selected().signal_changed().connect([this, courses, list = page.courses] {
    if (courses->get_selected() < list.size()) presenter_->ChooseCourse(list[courses->get_selected()].key);
  });
  head.append(*courses);
  all->append(head);
  all->append(MakeText(page.about, "name"));
  if (!page.note.empty()) all->append(MakeText(page.note, StyleOf(Tone::kCaution)));

  auto* columns = Gtk::make_managed<gui::Columns>(kGap);
  auto* map = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  map->set_size_request(kMapWidth, -1);
  map->set_spacing(6);
  ShowMap(page, *map);
  columns->Append(*map);
  detail_ = &MakeCard("");
  detail_->set_hexpand(true);
  detail_->set_valign(Gtk::Align::START);
  columns->Append(*detail_);
  all->append(*columns);
  const bool is_there = std::any_of(page.steps.begin(), page.steps.end(),
                                    [this](const CoursePage::Step& step) { return step.key == chosen_; });
  if (!is_there) chosen_ = page.next.empty() && !page.steps.empty() ? page.steps.front().key : page.next;
  ShowStep(page);
  append(MakePage(*all));
}

void CourseView::ShowMap(const CoursePage& page, Gtk::Box& into) {
  int number = 0;
  for (const CoursePage::Step& step : page.steps) {
    auto* content = Gtk::make_managed<Gtk::Box>();
    content->set_spacing(12);
    Gtk::Label& place = MakeLine(std::to_string(++number), "step-number");
    place.add_css_class(ClassOf(step.state));
    place.set_xalign(0.5);
    place.set_valign(Gtk::Align::CENTER);
    content->append(place);
    auto* words = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    words->set_hexpand(true);
    words->append(
        MakeText(step.name + (step.key == page.next ? host::Translate("  ·  next") : ""), "key-text"));
    words->append(MakeText(
        step.locked_by.empty() ? step.progress : host::TranslateWith("after {1}", {step.locked_by}), "fine"));
    if (!step.due.empty()) words->append(MakeText(step.due, step.is_overdue ? "caution" : "fine"));
    content->append(*words);
    content->append(MakeLine(WordOf(step.state), step.state == StepState::kDone ? "good" : "name"));
    auto* button = Gtk::make_managed<Gtk::Button>();
    button->add_css_class("step");
    button->set_child(*content);
    button->signal_clicked().connect([this, page, key = step.key] {
      chosen_ = key;
      ShowStep(page);
    });
    into.append(*button);
  }
}

void CourseView::ShowStep(const CoursePage& page) {
  Clear(*detail_);
  const auto found = std::find_if(page.steps.begin(), page.steps.end(),
                                  [this](const CoursePage::Step& step) { return step.key == chosen_; });
  if (found == page.steps.end()) return;
  const CoursePage::Step& step = *found;
  detail_->append(MakeText(step.name, "page-title"));
  detail_->append(MakeText(step.what, "name"));
  detail_->append(MakeText(step.goal, "key-text"));
  detail_->append(MakeLine(host::Translate("Before you begin"), "card-title"));
  detail_->append(MakeText(step.briefing, "value"));
  detail_->append(MakeLine(host::Translate("What passes"), "card-title"));
  if (step.thresholds.empty())
    detail_->append(MakeText(host::Translate("Whoever completes it passes."), "value"));
  for (const std::string& threshold : step.thresholds) detail_->append(MakeText("•  " + threshold, "value"));
  detail_->append(MakeText(host::TranslateWith("So far: {1}", {step.progress}), "value"));
  const bool is_locked = step.state == StepState::kLocked;
  Gtk::Button& start = MakeButton(
      is_locked ? host::Translate("Practise") : host::Translate("Start"),
      [this, name = StepName{page.course, step.key}] { presenter_->StartStep(name); },
      is_locked ? nullptr : "primary");
  start.set_halign(Gtk::Align::START);
  start.set_margin_top(8);
  if (is_locked) {
    detail_->append(MakeText(
        host::TranslateWith("It is locked until {1} is done: an attempt now is practice and does not count.",
                            {step.locked_by}),
        "caution"));
  }
  detail_->append(start);
}

}  // namespace trocar::centre
