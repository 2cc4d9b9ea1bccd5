// SPDX-License-Identifier: Apache-2.0
#include "group_view.h"

#include "trocar/gui/card.h"
#include "trocar/gui/columns.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {

GroupView::GroupView() : Gtk::Box(Gtk::Orientation::VERTICAL) {}

void GroupView::Show(const CentrePage& shown) {
  Clear(*this);
  const GroupPage& page = shown.group;
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->add_css_class("page");
  all->set_spacing(14);
  Gtk::Box& head = gui::MakeRow(10, {});
  Gtk::Label& title = MakeLine(page.group.empty() ? host::Translate("Group") : page.group, "page-title");
  title.set_hexpand(true);
  head.append(title);
  if (page.groups.size() > 1) {
    auto* groups = Gtk::make_managed<Gtk::DropDown>();
    std::vector<Glib::ustring> names(page.groups.begin(), page.groups.end());
    groups->set_model(Gtk::StringList::create(names));
    for (std::size_t i = 0; i < page.groups.size(); ++i) {
      if (page.groups[i] == page.group) groups->set_selected(static_cast<guint>(i));
    }
    groups->property_selected().signal_changed().connect([this, groups, list = page.groups] {
      if (groups->get_selected() < list.size()) presenter_->ChooseGroup(list[groups->get_selected()]);
    });
    head.append(*groups);
  }
  all->append(head);
  if (page.group.empty()) {
    all->append(
        MakeText(host::Translate("There is no group yet. Make one, and put people into it."), "value"));
    all->append(MakeNewGroup());
    append(MakePage(*all));
    return;
  }
  if (page.is_cut)
    all->append(MakeText(host::TranslateWith("Only the newest {1} attempts are counted.",
                                             {std::to_string(kMostGroupAttempts)}),
                         "caution"));
  Gtk::Box& card = MakeCard(host::Translate("Members and tasks"));
  if (page.members.empty()) card.append(MakeText(host::Translate("This group has no trainees."), "value"));
  std::vector<std::string> names = {host::Translate("member")};
  for (const GroupPage::Task& task : page.tasks) names.push_back(task.name);
  auto* table = Gtk::make_managed<Table>(names);
  for (const GroupPage::Member& member : page.members) {
    Gtk::Button& open = MakeButton(
        member.name, [this, who = member.pseudonym] { presenter_->ChoosePerson(who); }, "small");
    open.set_tooltip_text(host::Translate("Open the history"));
    table->Add(open);
    for (const GroupPage::Cell& cell : member.cells)
      table->AddText(cell.text.empty() ? "–" : cell.text, cell.text.empty() ? "fine" : StyleOf(cell.tone));
    Gtk::Button& leave = MakeButton(
        host::Translate("Take out"), [this, who = member.pseudonym] { presenter_->LeaveGroup(who); },
        "small");
    leave.set_tooltip_text(host::Translate("Out of this group; attempts stay whose they are"));
    table->Add(leave);
    table->EndRow();
  }
  card.append(*table);
  all->append(card);
  auto* below = Gtk::make_managed<gui::Columns>(14);
  below->Append(MakeNewMember());
  below->Append(MakeAssignment(page));
  below->Append(MakeNewGroup());
  all->append(*below);
  append(MakePage(*all));
}

/// A card with a field and a button that does something with what was typed.
Gtk::Box& GroupView::MakeForm(const std::string& title, const std::string& about, const std::string& hint,
                              const std::string& button, std::function<void(const std::string&)> act) {
  Gtk::Box& card = MakeCard(title);
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  card.append(MakeText(about, "value"));
  auto* entry = Gtk::make_managed<Gtk::Entry>();
  entry->set_placeholder_text(hint);
  gui::SetAccessibleName(*entry, hint);
  entry->set_hexpand(true);
  const auto press = [entry, act = std::move(act)] { act(entry->get_text().raw()); };
  entry->signal_activate().connect(press);
  card.append(gui::MakeRow(8, {entry, &MakeButton(button, press, "primary")}));
  return card;
}

Gtk::Box& GroupView::MakeNewGroup() {
  return MakeForm(host::Translate("A new group"), host::Translate("A year, a hospital, a course."),
                  host::Translate("Name of the group"), host::Translate("Make the group"),
                  [this](const std::string& name) { presenter_->MakeGroup(name); });
}

Gtk::Box& GroupView::MakeNewMember() {
  return MakeForm(
      host::Translate("A new member"),
      host::Translate("A name or a pseudonym. Who is not known yet becomes a trainee with a pseudonym; the "
                      "name stays in a protected file on this computer."),
      host::Translate("Name or pseudonym"), host::Translate("Put in"),
      [this](const std::string& who) { presenter_->JoinGroup(who); });
}

Gtk::Box& GroupView::MakeAssignment(const GroupPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("Assign a course"));
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  card.append(MakeText(host::Translate("Every member finds it at Courses, with its date."), "value"));
  auto* courses = Gtk::make_managed<Gtk::DropDown>();
  std::vector<Glib::ustring> names;
  for (const GroupPage::Task& course : page.courses) names.push_back(course.name);
  courses->set_model(Gtk::StringList::create(names));
  gui::SetAccessibleName(*courses, host::Translate("Course"));
  auto* due = Gtk::make_managed<Gtk::Entry>();
  due->set_placeholder_text(host::Translate("until, as 2026-12-31"));
  gui::SetAccessibleName(*due, host::Translate("until, as 2026-12-31"));
  due->set_hexpand(true);
  Gtk::Button& assign = MakeButton(
      host::Translate("Assign"),
      [this, courses, due, list = page.courses] {
        if (courses->get_selected() < list.size())
          presenter_->AssignCourse(list[courses->get_selected()].key, due->get_text().raw());
      },
      "primary");
  card.append(*courses);
  card.append(gui::MakeRow(8, {due, &assign}));
  return card;
}

}  // namespace trocar::centre
