// SPDX-License-Identifier: Apache-2.0
#include "result_card.h"

#include <utility>

#include "trocar/host/translate.h"
#include "trocar/presenter/read_outs.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 560, kHeight = 380;  // of the list [pixels]

}  // namespace

ResultCard::ResultCard() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  title_.add_css_class("card-title");
  verdict_.add_css_class("key");
  score_.add_css_class("force");
  for (Gtk::Label* label : {&title_, &verdict_, &score_}) {
    label->set_xalign(0);
    append(*label);
  }
  lines_.set_column_spacing(16);
  lines_.set_row_spacing(2);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_height(true);
  scroller->set_max_content_height(kHeight);
  scroller->set_size_request(kWidth, -1);
  scroller->set_child(lines_);
  append(*scroller);
  auto* note = Gtk::make_managed<Gtk::Label>(host::Translate("Training feedback, not certified assessment."));
  note->add_css_class("fine");
  note->set_xalign(0);
  append(*note);

  auto* buttons = Gtk::make_managed<Gtk::Box>();
  buttons->set_spacing(8);
  const std::pair<std::string, sigc::signal<void()>*> all[] = {
      {host::Translate("Again"), &signal_again_},
      {host::Translate("Other task"), &signal_other_},
      {host::Translate("Save …"), &signal_save_},
      {host::Translate("Close"), &signal_closed_}};
  for (const auto& one : all) {
    auto* button = Gtk::make_managed<Gtk::Button>(one.first);
    if (one.second == &signal_again_) button->add_css_class("primary");
    button->signal_clicked().connect([signal = one.second] { signal->emit(); });
    buttons->append(*button);
  }
  append(*buttons);
}

void ResultCard::AddLine(const std::string& left, const std::string& middle, const std::string& right,
                         const char* style) {
  int column = 0;
  for (const std::string* text : {&left, &middle, &right}) {
    auto* label = Gtk::make_managed<Gtk::Label>(*text);
    label->add_css_class(column == 1 ? style : "value");
    label->set_xalign(column == 2 ? 1 : 0);
    label->set_hexpand(column == 1);
    label->set_wrap(column == 1);
    lines_.attach(*label, column++, line_count_);
  }
  ++line_count_;
}

void ResultCard::Show(const presenter::TaskResult& result) {
  while (Gtk::Widget* old = lines_.get_first_child()) lines_.remove(*old);
  line_count_ = 0;
  title_.set_text(host::Translate(result.task) + ", " + host::Translate(result.level) +
                  (result.is_demonstration ? host::Translate(", shown by the expert") : std::string()));
  verdict_.set_text(result.verdict + host::Translate(" after ") + presenter::FormatTime(result.time));
  score_.set_text(host::Translate("Score ") + presenter::FormatScore(result));
  const bool is_completed = result.phase == scene::TaskPhase::kCompleted;
  score_.set_css_classes({is_completed ? "force" : "note"});
  for (const presenter::TaskResult::GoalRow& goal : result.goals)
    AddLine(goal.is_done ? "✓" : "—", host::TranslateComposed(goal.name), "", "meaning");
  if (result.errors.empty())
    AddLine("",
            is_completed ? host::Translate("No errors.")
                         : host::Translate("No errors, but not all goals were reached."),
            "", "meaning");
  for (const presenter::TaskResult::ErrorRow& error : result.errors)
    AddLine(presenter::FormatTime(error.time),
            host::TranslateComposed(error.about) +
                (error.by.empty() ? "" : " (" + presenter::DescribeDoer(error) + ")"),
            host::Translate(error.severity), "note");
  if (!result.recording.empty()) AddLine("", host::Translate("Recorded: ") + result.recording, "", "meaning");
}

}  // namespace trocar::app
