// SPDX-License-Identifier: Apache-2.0
#include "history_view.h"

#include "trocar/gui/card.h"
#include "trocar/gui/columns.h"
#include "trocar/host/translate.h"
#include "view_parts.h"

namespace trocar::centre {
namespace {

constexpr int kPlotWidth = 440, kGap = 14, kTaskWidth = 220;  // [pixels]

}  // namespace

HistoryView::HistoryView() : Gtk::Box(Gtk::Orientation::VERTICAL) {}

void HistoryView::Show(const CentrePage& shown) {
  Clear(*this);
  const HistoryPage& page = shown.history;
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->add_css_class("page");
  all->set_spacing(kGap);
  all->append(MakeHead(page));
  if (!page.pending.empty()) {
    Gtk::Box& card = MakeCard(host::Translate("Not measured yet"));
    for (const HistoryPage::Pending& one : page.pending) {
      Gtk::Label& what = MakeText(one.when + "  ·  " + one.task, "value");
      what.set_hexpand(true);
      card.append(gui::MakeRow(10, {&what, &MakeLine(one.is_measured_now ? host::Translate("being measured")
                                                                         : host::Translate("waits"),
                                                     "name")}));
    }
    card.append(
        MakeText(host::Translate("They ended with the program, or were not measured while they were played. "
                                 "They enter by themselves."),
                 "fine"));
    all->append(card);
  }
  auto* columns = Gtk::make_managed<gui::Columns>(kGap);
  columns->Append(MakeList(page));
  columns->Append(MakeLearning(page));
  all->append(*columns);
  append(MakePage(*all));
}

Gtk::Box& HistoryView::MakeHead(const HistoryPage& page) {
  Gtk::Box& head = gui::MakeRow(10, {});
  Gtk::Label& title = MakeLine(
      host::TranslateWith("History: {1}", {(page.who.empty() ? std::string("…") : page.who)}), "page-title");
  title.set_hexpand(true);
  head.append(title);
  head.append(MakeLine(host::Translate("Task"), "name"));
  auto* tasks = Gtk::make_managed<Gtk::DropDown>();
  std::vector<Glib::ustring> names = {host::Translate("All tasks")};
  guint chosen = 0;
  for (const HistoryPage::Task& task : page.tasks) {
    if (task.key == page.query.task) chosen = static_cast<guint>(names.size());
    names.push_back(task.name);
  }
  tasks->set_model(Gtk::StringList::create(names));
  tasks->set_selected(chosen);
  tasks->set_size_request(kTaskWidth, -1);
  tasks->property_selected().signal_changed().connect([this, tasks, list = page.tasks] {
    const guint now = tasks->get_selected();
    presenter_->ChooseTask(now == 0 || now > list.size() ? std::string() : list[now - 1].key);
  });
  head.append(*tasks);
  return head;
}

Gtk::Widget& HistoryView::MakeList(const HistoryPage& page) {
  Gtk::Box& card = MakeCard(host::Translate("Attempts, the newest first"));
  card.set_hexpand(true);
  card.set_valign(Gtk::Align::START);
  if (page.rows.empty()) {
    card.append(MakeText(host::Translate("No attempt is kept here yet. Every attempt in the simulator enters "
                                         "by itself when it has ended."),
                         "value"));
    return card;
  }
  const bool is_everyone = page.query.person.empty();
  std::vector<std::string> head = {host::Translate("when"),
                                   host::Translate("task"),
                                   host::Translate("outcome"),
                                   host::Translate("score"),
                                   host::Translate("time"),
                                   "",
                                   ""};
  if (is_everyone) head.insert(head.begin() + 1, host::Translate("who"));
  auto* table = Gtk::make_managed<Table>(head);
  for (const HistoryPage::Row& row : page.rows) {
    table->AddText(row.when);
    if (is_everyone) table->AddText(row.person);
    table->AddText(row.task, "value", true);
    table->AddText(row.outcome, StyleOf(row.tone), true);
    table->AddText(row.score);
    table->AddText(row.time);
    Gtk::Button& result = MakeButton(
        host::Translate("Result"), [this, row] { presenter_->OpenResultOf(row); }, "small");
    Gtk::Button& replay = MakeButton(
        host::Translate("Replay"), [this, row] { presenter_->OpenReplayOf(row); }, "small");
    for (Gtk::Button* button : {&result, &replay}) {
      button->set_sensitive(!row.recording.empty());
      if (row.recording.empty())
        button->set_tooltip_text(host::Translate("Its recording is not on this computer"));
      table->Add(*button);
    }
    table->EndRow();
  }
  card.append(*table);
  Gtk::Box& pages = gui::MakeRow(8, {});
  Gtk::Button& newest = MakeButton(host::Translate("Newest"), [this] { presenter_->GoToFirstPage(); });
  newest.set_sensitive(!page.query.page.empty());
  Gtk::Button& older = MakeButton(host::Translate("Older"), [this] { presenter_->GoToNextPage(); });
  older.set_sensitive(!page.next.empty());
  pages.append(newest);
  pages.append(older);
  card.append(pages);
  return card;
}

Gtk::Box& HistoryView::MakeLearning(const HistoryPage& page) {
  Gtk::Box& card = MakeCard(
      page.level.empty() ? host::Translate("How it is learnt")
                         : host::TranslateWith("How it is learnt, level {1}", {host::Translate(page.level)}));
  card.set_size_request(kPlotWidth, -1);
  card.set_valign(Gtk::Align::START);
  if (page.query.task.empty()) {
    card.append(MakeText(host::Translate("Choose a task to see its learning curve."), "value"));
    return card;
  }
  if (page.drawings.empty() && page.findings.empty())
    card.append(MakeText(host::Translate("There is no attempt at this task."), "value"));
  for (const std::string& finding : page.findings) card.append(MakeText(finding, "value"));
  for (const report::Drawing& drawing : page.drawings) card.append(MakePlot(drawing, kPlotWidth));
  return card;
}

}  // namespace trocar::centre
