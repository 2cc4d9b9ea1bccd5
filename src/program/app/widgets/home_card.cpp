// SPDX-License-Identifier: Apache-2.0
#include "home_card.h"

#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 620, kMostHeight = 480, kPictureWidth = 96, kPictureHeight = 60;  // pixels

}  // namespace

HomeCard::HomeCard() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  set_size_request(kWidth, -1);
  auto* title = Gtk::make_managed<Gtk::Label>(host::Translate("What do you want to train?"));
  title->add_css_class("page-title");
  title->set_xalign(0);
  append(*title);

  auto* person = Gtk::make_managed<Gtk::Box>();
  person->set_spacing(8);
  who_.add_css_class("name");
  who_.set_xalign(0);
  who_.set_hexpand(true);
  name_.set_placeholder_text(host::Translate("Your name, or nothing"));
  name_.set_tooltip_text(host::Translate(
      "Your results are kept under a pseudonym; the name stays in a protected file on this computer"));
  gui::SetAccessibleName(name_, host::Translate("Your name, or nothing"));
  const auto give = [this] { signal_person_.emit(name_.get_text()); };
  name_.signal_activate().connect(give);
  auto* be = Gtk::make_managed<Gtk::Button>(host::Translate("That is me"));
  be->signal_clicked().connect(give);
  person->append(who_);
  person->append(name_);
  person->append(*be);
  append(*person);

  patient_.add_css_class("name");
  patient_.set_xalign(0);
  patient_.set_wrap(true);
  append(patient_);

  problem_.add_css_class("bad");
  problem_.set_wrap(true);
  problem_.set_max_width_chars(70);
  problem_.set_xalign(0);
  problem_.set_visible(false);
  append(problem_);

  auto* entries = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  entries->set_spacing(6);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_height(true);
  scroller->set_max_content_height(kMostHeight);
  scroller->set_child(*entries);
  append(*scroller);
  for (const presenter::HomeEntry& entry : presenter::HomeEntries()) {
    Row row{Gtk::make_managed<Gtk::Button>(), Gtk::make_managed<Gtk::Label>(host::Translate(entry.title)),
            Gtk::make_managed<Gtk::Label>(host::Translate(entry.about)), Gtk::make_managed<Gtk::Picture>()};
    row.picture->set_size_request(kPictureWidth, kPictureHeight);
    row.picture->set_can_shrink(true);
    row.picture->set_halign(Gtk::Align::START);
    row.picture->add_css_class("thumbnail");
    row.picture->set_visible(false);
    row.title->add_css_class("key-text");
    row.about->add_css_class("name");
    auto* text = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    for (Gtk::Label* label : {row.title, row.about}) {
      label->set_xalign(0);
      label->set_wrap(true);
      text->append(*label);
    }
    text->set_valign(Gtk::Align::CENTER);
    text->set_hexpand(true);
    row.button->set_child(gui::MakeRow(12, {row.picture, text}));
    row.button->add_css_class("step");
    row.button->signal_clicked().connect([this, choice = entry.choice] { signal_chosen_.emit(choice); });
    entries->append(*row.button);
    rows_[entry.choice] = row;
  }
}

void HomeCard::Show(const presenter::HomePage& page) {
  gui::SetTextOrHide(who_, page.who.empty() ? "" : host::TranslateWith("You are: {1}", {page.who}));
  gui::SetTextOrHide(
      patient_, page.patient.empty() ? "" : host::TranslateWith("Operations are on {1}", {page.patient}));
  gui::SetTextOrHide(problem_, page.problem ? "\u26a0 " + host::ShownText(*page.problem) : "");
  rows_[presenter::HomeChoice::kContinue].button->set_visible(!page.last.empty());
  rows_[presenter::HomeChoice::kContinue].title->set_text(page.last_title);
  rows_[presenter::HomeChoice::kContinue].about->set_text(page.last);
  ShowLead(presenter::HomeChoice::kNextStep, page.next);
  ShowLead(presenter::HomeChoice::kLastResult, page.result);
  rows_[presenter::HomeChoice::kTutorial].title->set_text(
      host::TranslateWith("Tutorial: {1}", {page.tutorial}));
  gui::SetClass(*rows_[presenter::HomeChoice::kTutorial].button, "primary", page.is_tutorial_suggested);
  gui::SetClass(*rows_[presenter::HomeChoice::kContinue].button, "primary", !page.is_tutorial_suggested);
}

void HomeCard::ShowLead(presenter::HomeChoice choice, const std::optional<presenter::HomeLead>& lead) {
  Row& row = rows_[choice];
  row.button->set_visible(lead.has_value());
  if (!lead) return;
  row.title->set_text(lead->title);
  row.about->set_text(lead->about);
  row.picture->set_visible(!lead->picture.empty());
  if (!lead->picture.empty()) row.picture->set_filename(lead->picture.string());
}

void HomeCard::FocusFirst() {
  for (const presenter::HomeEntry& entry : presenter::HomeEntries()) {
    Gtk::Button* button = rows_[entry.choice].button;
    if (!button->get_visible()) continue;
    button->grab_focus();
    return;
  }
}

}  // namespace trocar::app
