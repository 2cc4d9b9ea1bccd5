// SPDX-License-Identifier: Apache-2.0
#include "group_view.h"

#include "trocar/gui/card.h"
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
    all->append(MakeText(host::Translate("There is no group yet. `trocar store group add NAME` makes one, "
                                         "`trocar store group join NAME PSEUDONYM` puts people into it."),
                         "value"));
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
    table->EndRow();
  }
  card.append(*table);
  all->append(card);
  append(MakePage(*all));
}

}  // namespace trocar::centre
